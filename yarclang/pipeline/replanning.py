"""Plan and prove the next lines of a program from the robot's position, after an input has ended a search
motion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from yarclang.cell.model import Present
from yarclang.decisions import only_holding
from yarclang.diagnostics import has_errors
from yarclang.handling.allowing import allowances_of, kept
from yarclang.handling.present import presently
from yarclang.hir import (
    Array,
    Dwell,
    EndWhen,
    JointGoal,
    JointMove,
    LineMove,
    Motion,
    Program,
    SetOutput,
    Step,
    When,
)
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.parts import compiled_part, parts_before
from yarclang.pipeline.stages import Request
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.runtime.actions import Replanned
from yarclang.runtime.job import Job

_SAME = 1e-6
"""Largest distance of the new plan's end from the position at which the program continues [rad or m]."""


def replanned(plan: MotionPlan, number: int, position: Array, request: Request) -> Replanned | str:
    """Plan and prove the lines to stream after a search, up to the end of the next motion.

    Args:
        plan: the program.
        number: number of the motion that the search has ended.
        position: (n,) position of the robot [rad or m].
        request: tolerance and longest segment time with which the program was planned.

    Returns:
        The lines as jobs. If they can't be planned and proved, a text with the reason.
    """
    steps = plan.program.steps
    begin = _behind_when(steps, plan.motions[number].step + 1)
    jobs: list[Job] = []
    for part in _parts(steps, begin):
        *still, last = part
        end = None
        if isinstance(last, JointMove | LineMove):
            title = last.origin.label or last.origin.name
            following = next((one for one in plan.motions[number + 1 :] if steps[one.step] is last), None)
            if following is None:
                return f"{title} has no following motion in the program"
            end = following.waypoints[-1]
            last = replace(last, allowed=kept(last, allowances_of(plan.program).get(following.step, ())))
            if isinstance(last, JointMove):  # keep the inverse kinematics solution of the program's plan
                last = replace(last, goal=JointGoal(end))
        job = _job(plan, begin, (*still, last), position, request)
        if isinstance(job, str):
            return job
        if end is not None and float(np.abs(job.end - end).max()) > _SAME:
            return f"from here {title} ends in another configuration"
        jobs.append(job)
    return Replanned(tuple(jobs), _length(plan, number, position))


def _parts(steps: Sequence[Step], begin: int) -> Iterator[list[Step]]:
    """Yield groups of consecutive steps that are streamed, from step `begin` to the end of the next motion.
    Other steps, such as a WAIT, are left out and separate the groups.
    """
    part: list[Step] = []
    for step in steps[begin:]:
        if isinstance(step, SetOutput | Dwell | Motion):
            part.append(step)
        elif part:
            yield part
            part = []
        if isinstance(step, Motion):
            break
    if part:
        yield part


def _behind_when(steps: tuple[Step, ...], first: int) -> int:
    """Return the number of the step after the WHEN that begins at `first`."""
    depth = 0
    for number in range(first, len(steps)):
        depth += isinstance(steps[number], When) - isinstance(steps[number], EndWhen)
        if depth == 0:
            return number + 1
    return len(steps)


def _job(
    plan: MotionPlan, begin: int, steps: tuple[Step, ...], position: Array, request: Request
) -> Job | str:
    whole = plan.program
    cell, parts = whole.cell, parts_before(plan, begin)
    if cell is not None and parts is not None:
        cell = presently(cell, Present(parts))
    program = Program(whole.source, position, steps, whole.outputs, cell, watches=only_holding(whole.watches))
    made = compiled_part(program, request)
    if made.value is None or has_errors(made.diagnostics):
        return next((one.message for one in made.diagnostics if one.is_error), "it can't be planned")
    return job_of_compiled(made.value, whole.source.name)


def _length(plan: MotionPlan, number: int, position: Array) -> float:
    """Return the distance of the moving frame from the start of a linear motion [m], with the robot at
    `position`; 0 for a joint motion.

    Args:
        plan: the program.
        number: number of the motion.
        position: (n,) position of the robot [rad or m].
    """
    motion = plan.motions[number]
    step = plan.program.steps[motion.step]
    if not isinstance(step, LineMove):
        return 0.0
    both = np.stack((motion.curve.points[0], position))
    places = tool_poses(plan.robot.chain, both, step.goal.flange_from_moving)[:, :3, 3]
    return float(np.linalg.norm(places[1] - places[0]))
