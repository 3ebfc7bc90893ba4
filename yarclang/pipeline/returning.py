"""Plan motions back or forward along the path on which a robot was stopped.

Beside a part that is taken or put down, only this path is known to be free.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.cell.model import Cell, Parts, Present
from yarclang.decisions import only_holding
from yarclang.diagnostics import has_errors
from yarclang.handling.present import is_same, presently
from yarclang.handling.surroundings import surroundings
from yarclang.handling.walk import flange_pose, handling_of
from yarclang.hir import (
    Array,
    JointGoal,
    JointMove,
    LineMove,
    Origin,
    PoseGoal,
    Program,
    Timing,
)
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.parts import approach, compiled_part, followed_plan, parts_before
from yarclang.pipeline.stages import Compiled, Request
from yarclang.semantics.names.commands import DEFAULT_PROFILE
from yarclang.source import SourceFile, Span

_ON_PATH = 2e-3
"""Largest distance of the robot from a path along which it may return [rad or m]. The motion is proved from
the robot's real position.
"""

_STEP = 1e-3
"""Time between the points of a path that are compared with the robot's position [s]."""


def along_the_path(
    plan: MotionPlan, number: int, position: Array, now: Parts | None = None
) -> Compiled | None:
    """Plan and certify a motion along the program's own path to the start of motion `number`, for a robot
    that was stopped while it moved to or from a part.

    The motion goes back along the path of motion `number`, or forward to the end of the previous motion. For
    the proof, the parts are where the program has them during the motion whose path is followed, and the same
    bodies may touch as during that motion.

    Args:
        plan: the program that was stopped.
        number: number of the motion to begin with.
        position: position of the robot (n,) [rad or m].
        now: current places of the parts; None: where the program has them.

    Returns:
        None if the robot isn't on such a path, or if the motion can't be proved.
    """
    goal = plan.motions[number].curve.points[0]
    for at in (number, number - 1):
        step = plan.program.steps[plan.motions[at].step] if at >= 0 else None
        if not isinstance(step, LineMove | JointMove) or not _is_on_path(plan, at, position):
            continue
        for cell in _cells(plan, at, now):
            made = compiled_part(_program(plan, at, position, goal, cell), Request(plan.robot))
            if made.value is not None and not has_errors(made.diagnostics):
                return made.value
    return None


def can_go_on(plan: MotionPlan, number: int, position: Array) -> bool:
    """Return True if the robot can be proved to reach the start of a motion without hitting parts. If the
    cell has no parts, return True without a proof.

    Args:
        plan: the program. The parts are assumed to be where it has them at the motion.
        number: number of the motion.
        position: (n,) position of the robot [rad or m].
    """
    if not plan.motions:
        return True
    cell, parts = plan.program.cell, parts_before(plan, plan.motions[number].step)
    goal = plan.motions[number].curve.points[0]
    if cell is None or parts is None or bool((np.abs(goal - position) <= _ON_PATH).all()):
        return True
    if along_the_path(plan, number, position) is not None:
        return True
    return approach(plan.robot, position, goal, presently(cell, Present(parts))).value is not None


def _is_on_path(plan: MotionPlan, number: int, position: Array) -> bool:
    begin = plan.begins[number]
    end = begin + plan.motions[number].curve.duration
    times = np.linspace(begin, end, max(2, int((end - begin) / _STEP)))
    return bool(np.abs(plan.sample(times)[0] - position).max(axis=1).min() <= _ON_PATH)


def _cells(plan: MotionPlan, number: int, now: Parts | None) -> Iterator[Cell]:
    """Yield the cell as it is during motion `number`.

    Yield nothing if this motion doesn't lead to or from a part that is taken or put down. Also yield nothing
    if the parts that may be touched are at other places in `now` than in the program. None for `now` means
    the places in the program.
    """
    whole, cell, step = followed_plan(plan), plan.program.cell, plan.motions[number].step
    runs = handling_of(plan.robot, cell, plan.program.steps).runs
    around = None if whole is None else whole.cells[step]
    if whole is None or cell is None or around is None or not (step in runs.away or step in runs.towards):
        return
    expected = whole.before[step]
    if now is None:
        yield around
        return
    known = {one.name: one for one in now.items}
    touched = {touch.part for touch in around.touches}
    if all(
        one.name in known and is_same(known[one.name], one) for one in expected.items if one.name in touched
    ):
        present = surroundings(cell, now, around.touches)
        if present is not None:
            yield present


def _program(plan: MotionPlan, number: int, position: Array, there: Array, cell: Cell) -> Program:
    robot = plan.robot
    step = plan.program.steps[plan.motions[number].step]
    timing = Timing(None, share=robot.controller.rapid_share)
    name = f"{'MOVEL' if isinstance(step, LineMove) else 'MOVEJ'}_{DEFAULT_PROFILE}"
    values = " ".join(f"{value:.6g}" for value in there / robot.axis_units)
    text = f"P0001 {name} {values} [{100.0 * robot.controller.rapid_share:g}%]"
    source = SourceFile("<approach>", text)
    origin = Origin("P0001", name, source, Span.on_line(1, 1, len(text) + 1))
    if not isinstance(step, LineMove):
        return Program(
            source,
            position,
            (JointMove(origin, JointGoal(there), DEFAULT_PROFILE, timing),),
            cell=cell,
            watches=only_holding(plan.program.watches),
        )
    flange_from_moving = step.goal.flange_from_moving
    goal = PoseGoal(flange_pose(robot, there) @ flange_from_moving, flange_from_moving)
    line = LineMove(origin, goal, DEFAULT_PROFILE, timing)
    return Program(source, position, (line,), cell=cell, watches=only_holding(plan.program.watches))
