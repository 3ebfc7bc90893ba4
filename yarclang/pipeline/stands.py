"""Find the places at which the way out of an ON may begin: where the robot is at rest before a motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from yarclang.decisions import only_holding
from yarclang.diagnostics import Diagnostic
from yarclang.hir import Array, Program, WayOut, searches_of
from yarclang.motion.plan import MotionPlan


def stand_before(plan: MotionPlan, number: int) -> int:
    """Return the number of the last motion that begins at rest: motion `number` itself, or one before it."""
    while number and plan.motions[number - 1].flows:
        number -= 1
    return number


def start_of(plan: MotionPlan, number: int) -> Array:
    """Return the position at which a motion begins (n,) [rad or m]."""
    begin: Array = plan.motions[number].curve.points[0]
    return begin


def title_of(plan: MotionPlan, number: int) -> str:
    """Return the label and name of a motion, for people."""
    origin = plan.origin_of(number)
    return f"{origin.label} {origin.name}" if origin.label else origin.name


def way_out_from(plan: MotionPlan, way: WayOut, position: Array) -> Program:
    """Return the way out of an ON as a separate program that begins at the robot's position (n,) [rad or m].

    During a way out, the watched inputs only hold the motion; they start no other way out.
    """
    whole = plan.program
    return Program(
        whole.source, position, way.steps, whole.outputs, whole.cell, watches=only_holding(whole.watches)
    )


def unreachable_ways_out(plan: MotionPlan, refused: Callable[[Program], str]) -> Iterator[Diagnostic]:
    """Plan and prove each way out from each place at which it may begin. Yield one finding for each way out
    that fails from at least one place.

    Args:
        plan: the program.
        refused: function that plans and proves a program, and returns the first error, or an empty text.
    """
    if not plan.program.ways_out:
        return
    stands = list(_stands(plan))
    for way in plan.program.ways_out:
        tried = ((number, refused(way_out_from(plan, way, start_of(plan, number)))) for number in stands)
        failed = [(number, reason) for number, reason in tried if reason]
        if not failed:
            continue
        number, reason = failed[0]
        more = f", and from {len(failed) - 1} more of {len(stands)} places" if len(failed) > 1 else ""
        message = f"{way.name} can't be executed from the start of {title_of(plan, number)}{more}: {reason}"
        help_ = "begin it with a motion that is free from each of these places, such as MOVEJ_AVOID"
        yield Diagnostic("Y0479", message, way.origin.source, way.origin.span, help=help_)


def _stands(plan: MotionPlan) -> Iterator[int]:
    """Yield, for each joint position at which a motion begins from rest, the number of the first such motion.
    Motions after a search are left out.

    After a search, the position at which the next motion begins isn't known, and watched inputs only hold the
    motion.
    """
    searched = {one.step for one in searches_of(plan.program)}
    places_so_far: set[bytes] = set()
    for number in range(len(plan.motions)):
        before = plan.motions[number - 1] if number else None
        if before is not None and (before.flows or before.step in searched):
            continue
        place = (start_of(plan, number).round(9) + 0.0).tobytes()
        if place not in places_so_far:
            places_so_far.add(place)
            yield number
