"""Plan the OFFSETs of a program at sample values of their registers, before the program runs.

The ranges of an OFFSET's registers form a box. The samples are all combinations of the smallest, middle and
largest value of each register.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product

from yarclang.decisions import shift_in_words
from yarclang.diagnostics import Diagnostic
from yarclang.hir import Offset, Origin, Program, When
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.shifting import shifted_program
from yarclang.pipeline.stages import Request
from yarclang.progress import each

MOST_TRIED = 400
"""Largest number of combinations of register values that are tried for one program."""

_HELP = (
    "at run time such a place is refused before anything moves: the ELSE is executed, or without one the "
    "robot holds; use a smaller range of the registers, or another approach, to make the whole box "
    "feasible"
)


@dataclass(slots=True)
class _Told:
    """Findings about the OFFSETs that one source line creates; a line in a loop creates several OFFSETs."""

    origin: Origin
    tried: int = 0
    faults: list[str] = field(default_factory=list)


def box_findings(plan: MotionPlan, request: Request) -> Iterator[Diagnostic]:
    """Yield a finding for each OFFSET that can't be planned or proved for some of the tried register values.

    Args:
        plan: the program.
        request: tolerance and longest segment time with which the program was planned.
    """
    without_start = Request(request.robot, tm=request.tm, tolerance=request.tolerance)
    steps = plan.program.steps
    boxes: list[tuple[When, Offset, int, list[tuple[int, ...]]]] = []
    for at, step in enumerate(steps):
        if isinstance(step, When) and step.offset is not None:
            first = next((n for n, motion in enumerate(plan.motions) if motion.step > at), None)
            if first is not None:
                boxes.append((step, step.offset, first, places_of(step.offset, plan.program)))
    # first try the corners of all boxes: the combinations of smallest and largest values
    trials = [(place, number) for number, (*_, places) in enumerate(boxes) for place in enumerate(places)]
    trials.sort(key=lambda tried: (not _is_corner(boxes[tried[1]], tried[0][1]), tried[1], tried[0][0]))
    by_place: dict[tuple[object, object], _Told] = {}
    for (_, values), number in each(trials[:MOST_TRIED]):
        when, offset, first, _ = boxes[number]
        origin = when.origin
        tried = by_place.setdefault((origin.source.name, origin.span), _Told(origin))
        tried.tried += 1
        made = shifted_program(plan, first, plan.motions[first].curve.points[0], values, without_start)
        if isinstance(made, str):
            tried.faults.append(
                f"with {{{offset.name}}} shifted by {shift_in_words(values, offset.registers)}: {made}"
            )
    for tried in by_place.values():
        if tried.faults:
            message = (
                f"{len(tried.faults)} of {tried.tried} places in the box of this OFFSET can't be executed; "
                f"{tried.faults[0]}"
            )
            yield Diagnostic(
                "Y0508", message, tried.origin.source, tried.origin.span, _HELP, place=tried.origin.place
            )
    if len(trials) > MOST_TRIED:
        origin = boxes[0][0].origin
        message = (
            f"{len(trials) - MOST_TRIED} of {len(trials)} places in the boxes of the program's OFFSETs "
            "weren't tried"
        )
        help_ = (
            "at run time each place is planned and proved before the robot moves, whether it was tried or not"
        )
        yield Diagnostic("Y0509", message, origin.source, origin.span, help_)


def places_of(offset: Offset, program: Program) -> list[tuple[int, ...]]:
    """Return the register values at which an OFFSET is tried: all combinations of the smallest, middle and
    largest value of each register. Each tuple has one value per axis of `SHIFTS`.
    """
    ranges = {one.name: (one.low, one.high) for one in program.registers}
    axes: list[Sequence[int]] = []
    for name in offset.registers:
        low, high = ranges[name] if name else (0, 0)
        axes.append(sorted({low, (low + high) // 2, high}))
    return list(product(*axes))


def _is_corner(box: tuple[When, Offset, int, list[tuple[int, ...]]], values: tuple[int, ...]) -> bool:
    places = box[3]
    return all(value in (places[0][axis], places[-1][axis]) for axis, value in enumerate(values))
