"""How the robot comes to a command: what is planned of the steps before it, also where others have errors."""

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
    """Where the robot stands when a motion begins, `start` (n,) [rad or m], and the motion as it is planned.

    `start` is None where errors before it hide that, `motion` where it can't be planned.
    """

    start: Array | None
    motion: PlannedMotion | None


def steps_to(program: Program, number: int) -> tuple[Step, ...]:
    """The steps that lead to a step, in one line, as `line_to` has them."""
    return tuple(line_to(program.steps[:number]))


def way_to(program: Program, number: int, request: Request) -> Way:
    """Plan the motion that is step `number`, and of what leads to it as much as is needed to know where it starts."""
    step = program.steps[number]
    assert isinstance(step, Motion)
    start = stands_before(program, number, request)
    if start is None:
        return Way(None, None)
    planned = plan_program(replace(program, start=start, steps=(alone(step),)), request)
    if planned.value is not None and planned.value.motions:
        return Way(start, planned.value.motions[0])
    if isinstance(step, TimedMove):  # its table decides, whatever its time
        return Way(start, None)
    relaxed = replace(alone(step), timing=replace(step.timing, duration=None, speed=None))
    again = plan_program(replace(program, start=start, steps=(relaxed,)), request)
    motion = again.value.motions[0] if again.value is not None and again.value.motions else None
    return Way(start, motion)


def stands_before(program: Program, number: int, request: Request) -> Array | None:
    """Where the robot stands before step `number` (n,) [rad or m]; None where errors hide it."""
    line = steps_to(program, number)
    if (found := _behind(program, program.start, line, request)) is not None:
        return found
    for place in range(len(line) - 1, -1, -1):
        one = line[place]
        if isinstance(one, Motion) and isinstance(one.end, JointGoal):
            # wherever it came from, there it stands
            return _behind(program, one.end.q, line[place + 1 :], request)
    return None


def alone(step: Motion) -> Motion:
    """A motion that ends at rest: it flows into nothing."""
    return replace(step, blend=None)


def trouble_behind(program: Program, number: int, stands: Array, request: Request) -> str:
    """What goes wrong with the Cartesian motions right behind step `number`, if the robot stands at `stands` (n,) [rad or m] then.

    Returns:
        The first error in words, or nothing.
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
    """Where the robot stands behind some steps from a start; None where they can't all be planned."""
    if any(isinstance(one, Gap | Stop | Finish) for one in line):
        return None
    motions = tuple(alone(one) for one in line if isinstance(one, Motion))
    if not motions:
        return start
    planned = plan_program(replace(program, start=start, steps=motions), request)
    return planned.value.motions[-1].waypoints[-1] if planned.value is not None else None
