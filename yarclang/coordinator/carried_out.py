"""The steps of a program that were carried out, derived from the outcome of its run. No I/O."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from yarclang.coordinator.resting import resting_place
from yarclang.hir import (
    Assign,
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Finish,
    Hold,
    Loop,
    Motion,
    NextPass,
    Say,
    SetOutput,
    Step,
    Stop,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.motion.plan import MotionPlan
from yarclang.runtime.job import Job
from yarclang.runtime.outcome import Ended
from yarclang.runtime.scripts import scripts_of
from yarclang.ways import Turn

_LOST = "Y1606"
"""Code of the finding for a lost connection."""

_AT_END = 2.0
"""Tolerance in time for finding the motion in which the robot rests [segment times].

If the robot rests within this time after a motion's beginning, the motion may not have begun. If it rests
within this time before a motion's end, the steps after the motion may have begun already.
"""


@dataclass(frozen=True, slots=True)
class CarriedOut:
    """Numbers of the steps of a program that a run has carried out.

    `surely` has the steps that were certainly carried out. `perhaps` has the SETs after them that may have
    been carried out. The controller executes them in order, but it isn't known how many it has executed:
    none, some or all.
    """

    surely: tuple[int, ...]
    perhaps: tuple[int, ...] = ()


def taken(steps: Sequence[Step], begin: int, end: int, ways: Sequence[bool]) -> list[int]:
    """Return the numbers of the steps that were passed on the executed branches, up to the first WHEN whose
    executed branch isn't known.

    A WHEN is included if it was passed. An ELSE is included if the branch before it was executed to its end.
    The end of a WHEN or of a loop is included if the robot reached it. Only the last pass of a loop counts.

    Args:
        steps: all steps of the program.
        begin: number of the first step of the run.
        end: number after the last step of the run.
        ways: for each WHEN that was passed, in order: True if its first branch was executed.
    """
    left, found = list(ways), list[int]()
    passing, depth = True, 0
    opens: type[Step]
    closes: type[Step]
    opens, closes = _WAY
    for number in range(begin, end):
        step = steps[number]
        if not passing:
            if isinstance(step, opens):
                depth += 1
            elif isinstance(step, closes) and depth:
                depth -= 1
            elif isinstance(step, closes) or (isinstance(step, Else) and closes is EndWhen and not depth):
                passing = True
            continue
        if isinstance(step, When) and not left:
            return found
        found.append(number)
        if isinstance(step, Stop | Finish | NextPass):
            return found
        passing = left.pop(0) if isinstance(step, When) else not isinstance(step, Else | Exit)
        opens, closes = _PASSES if isinstance(step, Exit) else _WAY
    return found


_WAY, _PASSES = (When, EndWhen), (Loop, EndLoop)
"""Pairs of the steps that begin and end a block: `_WAY` for WHEN, `_PASSES` for loops.

`taken` skips steps that weren't executed, up to the end of their block. To find the right end, it counts the
blocks of the same kind that begin and end among the skipped steps.
"""


def carried_out(plan: MotionPlan, begin: int, end: int, program: Job, ended: Ended) -> CarriedOut:
    """Return the steps of a program that a run has carried out.

    Args:
        plan: plan of the program.
        begin: number of the first step of the run.
        end: number after the last step of the run.
        program: job of the whole program.
        ended: outcome of the run.
    """
    steps = plan.program.steps
    done = taken(steps, begin, end, ended.ways)
    if ended.well:
        return CarriedOut(tuple(done))
    stops = [at for at, number in enumerate(done) if _is_barrier(steps[number])]
    first = stops[ended.barriers - 1] + 1 if 0 < ended.barriers <= len(stops) else 0
    last = stops[ended.barriers] if ended.barriers < len(stops) else len(done)
    before, leg = done[:first], done[first:last]
    if ended.at_barrier:
        return CarriedOut((*before, *leg))
    motions = [number for number in leg if isinstance(steps[number], Motion)]
    if not ended.command:
        # The robot hasn't moved, so at most the steps before the first motion were carried out.
        return CarriedOut(tuple(before), _sets(steps, leg, -1, motions[0] if motions else len(steps)))
    now, began, rests = _motion_at(plan, program, ended)
    latest = _latest(plan, program, ended)
    if now not in motions:
        return CarriedOut(tuple(before), _sets(steps, leg, -1, latest))
    place = motions.index(now)
    behind = motions[place + 1] if place + 1 < len(motions) else len(steps)
    if began:
        surely = [*before, *(number for number in leg if number < now)]
    else:
        # The robot rests at the very beginning of this motion. Perhaps not all steps between the previous
        # motion and this one were carried out.
        since = motions[place - 1] if place else -1
        surely = [*before, *(number for number in leg if number <= since)]
        return CarriedOut(tuple(surely), _sets(steps, leg, since, now))
    if rests == "within":
        return CarriedOut(tuple(surely))
    return CarriedOut(tuple(surely), _sets(steps, leg, now, behind if rests == "end" else latest))


def _is_barrier(step: Step) -> bool:
    return isinstance(step, WaitInput | WaitUntil | Hold | Say | Assign | Turn)


def _sets(steps: Sequence[Step], leg: Sequence[int], after: int, before: int) -> tuple[int, ...]:
    return tuple(number for number in leg if after < number < before and isinstance(steps[number], SetOutput))


def _latest(plan: MotionPlan, program: Job, ended: Ended) -> int:
    """Return the number of the first motion step that certainly hasn't begun; `len(plan.program.steps)` if
    there is none.

    The robot may have moved on since its last report. After a lost connection, it may have executed all lines
    that were in the controller's buffer.
    """
    command = program.command_at(ended.done)
    if ended.joints is None or command is None or len(program.commands) != len(plan.motions):
        return len(plan.program.steps)
    number = program.commands.index(command)
    segment = max(motion.curve.segment for motion in plan.motions)
    late = program.capacity * segment + sum(seconds for _, seconds in program.dwells)
    heard = plan.begins[number] + ended.done - command.begins
    last = (
        heard
        + _AT_END * segment
        + (late if ended.code == _LOST else min(late, scripts_of(program.robot.controller.kind).patience))
    )
    later = (one.step for one, begins in zip(plan.motions, plan.begins, strict=True) if begins > last)
    return next(later, len(plan.program.steps))


def _motion_at(plan: MotionPlan, program: Job, ended: Ended) -> tuple[int, bool, str]:
    """Find the motion in which the robot rests.

    Returns:
        The number of the motion's step (-1 if unknown); True if the motion has certainly begun; and the
        place: `within` the motion, at its `end`, or `behind`. `behind` means that the place isn't known, so
        the robot may have moved on beyond the motion.
    """
    place = None if ended.joints is None else resting_place(plan, program, ended.joints, ended.done)
    command = program.command_at(ended.done) if place is None else place.command
    if command is None or len(program.commands) != len(plan.motions):
        return -1, False, "behind"
    number = program.commands.index(command)
    motion = plan.motions[number]
    if place is None:
        return motion.step, True, "behind"
    near = _AT_END * motion.curve.segment
    if place.done - command.begins <= near:
        return motion.step, False, "within"
    return motion.step, True, "end" if command.ends - place.done <= near else "within"
