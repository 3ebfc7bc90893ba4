"""Plan and prove the lines of an OFFSET at run time, when registers have shifted its frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from yarclang.cell.model import Parts, Present
from yarclang.diagnostics import Diagnostic, has_errors
from yarclang.handling.parts import shift
from yarclang.handling.present import are_same, presently
from yarclang.handling.runs import BEFORE
from yarclang.hir import (
    Array,
    AvoidMove,
    Else,
    FrameLink,
    Goal,
    JointGoal,
    JointMove,
    LineMove,
    Motion,
    Offset,
    PoseDelta,
    PoseGoal,
    PoseSplineMove,
    Program,
    SetOutput,
    SplineMove,
    Step,
    When,
)
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.parts import compiled_part, followed_plan, leaving_before, parts_before
from yarclang.pipeline.stages import Compiled, Request
from yarclang.runtime.actions import Replanned
from yarclang.transforms import constant, pose_matrix
from yarclang.units import DEG, MM

_VISIBLE = 0.001
"""Least distance that a message states [mm]."""

STEP_MM, STEP_DEG = 0.01, 0.01
"""Units of the registers of an OFFSET [mm, deg]."""

_SAME = 1e-6
"""Largest distance of the new plan's end from the position at which the program continues [rad or m]."""


def shifted(
    plan: MotionPlan, number: int, position: Array, values: Sequence[int], request: Request
) -> Replanned | str:
    """Plan and prove the lines of an OFFSET with shifted goals, and return them for streaming.

    Args:
        plan: the program.
        number: number of the OFFSET's first motion.
        position: (n,) position of the robot [rad or m].
        values: value of the register for each axis of `SHIFTS`; 0 for an axis without a register.
        request: tolerance and longest segment time with which the program was planned.

    Returns:
        The lines as jobs. If they can't be planned and proved, a text with the reason.
    """
    made = shifted_program(plan, number, position, values, request)
    if isinstance(made, str):
        return made
    job = job_of_compiled(made, plan.program.source.name)
    jobs = tuple(leg.job for leg in job.legs if leg.job is not None) if job.legs else (job,)
    return Replanned(jobs, 0.0)


def shifted_program(
    plan: MotionPlan, number: int, position: Array, values: Sequence[int], request: Request
) -> Compiled | str:
    """Plan and prove the lines of an OFFSET with shifted goals, and return the compiled program. Arguments
    and error texts are those of `shifted`.
    """
    whole = plan.program
    begin, end = around(whole.steps, plan.motions[number].step)
    when = whole.steps[begin]
    assert isinstance(when, When)
    assert when.offset is not None
    offset, cell = when.offset, whole.cell
    moved = pose_matrix(numbers_of(values).tolist())
    own_motions = [motion for motion in plan.motions if begin < motion.step < end]
    last, leads = own_motions[-1], own_motions[-1].waypoints[-1]
    steps = tuple(
        _ending(step, leads) if at == last.step else step
        for at, step in enumerate(carried(whole.steps[begin + 1 : end], offset, values), begin + 1)
    )
    parts = parts_before(plan, begin)
    if cell is not None and parts is not None:
        leaving = leaving_before(plan, own_motions[0].step, parts)
        cell = presently(cell, Present(_lying(parts, offset, moved), leaving))
    program = Program(
        whole.source, position, steps, whole.outputs, cell, registers=whole.registers, watches=whole.watches
    )
    compiled = compiled_part(program, request)
    if compiled.value is None or has_errors(compiled.diagnostics):
        return next(
            (_message(one, steps) for one in compiled.diagnostics if one.is_error), "it can't be planned"
        )
    stands = compiled.value.plan.motions[-1].waypoints[-1]
    if float(np.abs(stands - leads).max()) > _SAME:
        origin = whole.steps[last.step].origin  # type: ignore[union-attr]  # a motion has one
        return f"{origin.label or origin.name} ends in another configuration than without the shift"
    return _left_elsewhere(plan, compiled.value, end) or compiled.value


def around(steps: Sequence[Step], inside: int) -> tuple[int, int]:
    """Return the numbers of the When and the Else of the OFFSET around a step."""
    begin = next(at for at in range(inside, -1, -1) if isinstance(one := steps[at], When) and one.offset)
    return begin, next(at for at in range(begin, len(steps)) if isinstance(steps[at], Else))


def numbers_of(values: Sequence[int]) -> Array:
    """Convert the values of an OFFSET's registers to a shift (6,): x y z [m] and roll pitch yaw [rad]."""
    x, y, z, turn = values
    return constant(np.array([*(one * STEP_MM * MM for one in (x, y, z)), 0.0, 0.0, turn * STEP_DEG * DEG]))


def carried(steps: Sequence[Step], offset: Offset, values: Sequence[int]) -> tuple[Step, ...]:
    """Return the steps of an OFFSET with shifted goals.

    The shift is inserted as one more frame between the OFFSET's frame and the goals, so that the judge
    computes each goal independently.
    """
    if not any(values):
        return tuple(steps)
    carrying = _Carrying(offset, numbers_of(values))
    return tuple(carrying.step(one) if isinstance(one, Motion) else one for one in steps)


class _Carrying:
    """Converter that shifts the goals of motions as an OFFSET shifts its frame."""

    def __init__(self, offset: Offset, numbers: Array) -> None:
        self._offset, self._numbers = offset, numbers
        self._own = constant(pose_matrix(numbers.tolist()))
        placed = offset.base_from_frame
        self._base = placed @ self._own @ np.linalg.inv(placed)
        self._links: dict[int, tuple[FrameLink, FrameLink]] = {}

    def step(self, step: Motion) -> Motion:
        match step:
            case SplineMove() | PoseSplineMove():
                goals = tuple(map(self._goal, step.waypoints))
                return replace(step, waypoints=goals)  # type: ignore[arg-type]  # each goal keeps its kind
            case JointMove() | AvoidMove() | LineMove():
                return replace(step, goal=self._goal(step.goal))  # type: ignore[arg-type]
        return step

    def _goal(self, goal: Goal) -> Goal:
        if not isinstance(goal, PoseGoal | PoseDelta) or not goal.shifted:
            return goal
        told = goal.told and replace(goal.told, base=self._link(goal.told.base))
        if isinstance(goal, PoseDelta):
            return replace(goal, axes=constant(self._base[:3, :3] @ goal.axes), told=told, shifted=False)
        placed = constant(self._base @ goal.base_from_moving)
        return replace(goal, base_from_moving=placed, told=told, shifted=False)

    def _link(self, link: FrameLink) -> FrameLink:
        """Return the declaration of a frame as it is after the shift: in its chain of parents, a frame with
        the shift as its pose is inserted as the child of the OFFSET's frame.
        """
        known = self._links.get(id(link))
        if known is None:
            known = link, self._moved(link)
            self._links[id(link)] = known
        return known[1]

    def _moved(self, link: FrameLink) -> FrameLink:
        frame = self._offset.link
        if frame is not None and link.is_same(frame):
            return FrameLink(f"{link.name} SHIFTED", self._own, link, told=self._numbers)
        assert link.parent is not None, "give a shifted goal in the frame, or in a frame defined in it"
        return replace(link, parent=self._link(link.parent))


def _ending(step: Step, leads: Array) -> Step:
    """Replace the goal of a joint motion by the joint position at which this motion ends in the program's
    plan, so that the inverse kinematics solution doesn't change. Return other steps unchanged.
    """
    return replace(step, goal=JointGoal(leads)) if isinstance(step, JointMove | AvoidMove) else step


def _lying(parts: Parts, offset: Offset, own: Array) -> Parts:
    """Return the parts of a cell with some of them shifted: those that are placed in the OFFSET's frame and
    are still where the cell's file has them.

    Args:
        parts: the parts where the program has them.
        offset: the OFFSET.
        own: (4, 4) shift of the OFFSET's frame, in the axes of this frame.
    """
    placed = offset.base_from_frame
    expected = tuple(replace(one, taken=BEFORE) for one in parts.expected)
    there = replace(parts, expected=expected)
    return shift(there, offset.parts, placed @ own @ np.linalg.inv(placed), BEFORE)


def _left_elsewhere(plan: MotionPlan, compiled: Compiled, end: int) -> str:
    """Describe a part that ends up elsewhere than in the program without the shift. The text is empty if
    there is no such part.
    """
    after, meant = followed_plan(compiled.plan), parts_before(plan, end)
    if after is None or meant is None or are_same(after.end, meant):
        return ""
    left = {item.name: item for item in after.end.items}
    for item in meant.items:
        other = left.pop(item.name, None)
        if other is None or other.gripper != item.gripper:
            return f"the gripper doesn't take or leave {item.name} as it does without the shift"
        if not np.allclose(other.transform, item.transform, rtol=0.0, atol=1e-5):
            off = np.linalg.norm(item.transform[:3, 3] - other.transform[:3, 3]) / MM
            away = f"{off:.3f} mm away from" if off >= _VISIBLE else "turned against"
            way, place = ("left", "place") if item.gripper is None else ("held", "place in the gripper")
            return (
                f"{item.name} is {way} {away} its {place} without the shift, but the lines after the OFFSET "
                "are proved with that place"
            )
    return "parts are left at other places than without the shift"


def _message(finding: Diagnostic, steps: Sequence[Step]) -> str:
    """Return the message of a finding, with the command that it is about."""
    origins = (step.origin for step in steps if isinstance(step, Motion | SetOutput))
    label = next((at.label for at in origins if at.span == finding.span and at.source is finding.source), "")
    return f"{label}: {finding.message}" if label else finding.message
