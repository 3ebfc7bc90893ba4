"""Find where the robot is before a command, by planning only the steps before it that are needed. The program
may have errors elsewhere.
"""

from __future__ import annotations

from dataclasses import replace

from yarclang.findings import CATALOGUE
from yarclang.frozen import frozen
from yarclang.hir import (
    Array,
    Finish,
    Gap,
    JointGoal,
    Motion,
    Program,
    Step,
    Stop,
    TimedMove,
)
from yarclang.motion.plan import PlannedMotion
from yarclang.pipeline.stages import Request, plan_program
from yarclang.ways import Turn, line_to


@frozen(eq=False)
class Way:
    """A planned motion and the joint position at its start.

    Attributes:
        start: (n,) start of the motion [rad or m]; None if unknown because of earlier errors.
        motion: the planned motion; None if it can't be planned.
    """

    start: Array | None
    motion: PlannedMotion | None


def steps_to(program: Program, number: int) -> tuple[Step, ...]:
    """Return the steps before a step as a sequence without branches and loops (see `line_to`)."""
    return tuple(line_to(program.steps[:number]))


def way_to(program: Program, number: int, request: Request) -> Way:
    """Plan the motion of step `number`, and the steps before it that are needed to know its start."""
    step = program.steps[number]
    assert isinstance(step, Motion)
    start = stands_before(program, number, request)
    if start is None:
        return Way(None, None)
    planned = plan_program(replace(program, start=start, steps=(alone(step),)), request)
    if planned.value is not None and planned.value.motions:
        return Way(start, planned.value.motions[0])
    if isinstance(step, TimedMove):  # the motion is given by its table: another duration wouldn't help
        return Way(start, None)
    relaxed = replace(alone(step), timing=replace(step.timing, duration=None, speed=None))
    again = plan_program(replace(program, start=start, steps=(relaxed,)), request)
    motion = again.value.motions[0] if again.value is not None and again.value.motions else None
    return Way(start, motion)


def stands_before(program: Program, number: int, request: Request) -> Array | None:
    """Return the joint positions before step `number` (n,) [rad or m]; None if unknown because of errors."""
    line = steps_to(program, number)
    if (found := _behind(program, program.start, line, request)) is not None:
        return found
    for place in range(len(line) - 1, -1, -1):
        one = line[place]
        if isinstance(one, Motion) and isinstance(one.end, JointGoal):
            # the end of this motion is known, wherever it starts
            return _behind(program, one.end.q, line[place + 1 :], request)
    return None


def alone(step: Motion) -> Motion:
    """Return a copy of a motion without its blend, so that it ends at rest."""
    return replace(step, blend=None)


def trouble_behind(program: Program, number: int, stands: Array, request: Request) -> str:
    """Plan the Cartesian motions directly after step `number`, as if this step ended at the joint position
    `stands` (n,) [rad or m], and return what fails.

    Returns:
        The first error in words; empty for none.
    """
    line: list[Motion] = []
    for step in program.steps[number + 1 :]:
        if isinstance(step, Motion) and step.leads_frame:
            line.append(alone(step))
        elif isinstance(step, Motion | Gap | Stop | Turn):
            break
    if not line:
        return ""
    planned = plan_program(replace(program, start=stands, steps=tuple(line)), request)
    first = next(
        (one for one in planned.diagnostics if one.is_error and CATALOGUE[one.code].sort != "time"), None
    )
    if first is None:
        return ""
    origin = next((one.origin for one in line if one.origin.span == first.span), None)
    which = f"{origin.label} {origin.name}".strip() if origin is not None else "a later motion"
    return f"{which} fails from here: {first.message} ({first.code})"


def _behind(program: Program, start: Array, line: tuple[Step, ...], request: Request) -> Array | None:
    """Return the joint position after the steps `line`, if the robot is at `start` before them; None if a
    step can't be planned.
    """
    if any(isinstance(one, Gap | Stop | Finish) for one in line):
        return None
    motions = tuple(alone(one) for one in line if isinstance(one, Motion))
    if not motions:
        return start
    planned = plan_program(replace(program, start=start, steps=motions), request)
    return planned.value.motions[-1].waypoints[-1] if planned.value is not None else None
