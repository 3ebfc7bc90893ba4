"""Describe the corners around a command: blends between motions, and outputs that are set during a blend."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from yarclang.frozen import frozen
from yarclang.hir import Motion, Origin, SetOutput
from yarclang.motion.plan import MotionPlan


@frozen
class Flowing:
    """A corner between two commands that the robot passes without a stop.

    Attributes:
        first: command before the corner.
        second: command after the corner.
        begins: time at which both commands begin to overlap [s of the program].
        middle: time at which the first command ends and the second begins in the plan [s of the program].
        ends: end of the overlap [s of the program].
    """

    first: Origin
    second: Origin
    begins: float
    middle: float
    ends: float


@frozen
class Flows:
    """The corners at the start and the end of a command. Each is None if the robot stops there.

    Attributes:
        before: corner at the start of a motion.
        behind: corner at the end of a motion.
        inside: corner during which an output is set.
    """

    before: Flowing | None = None
    behind: Flowing | None = None
    inside: Flowing | None = None


NO_FLOWS = Flows()


def flows_of(plan: MotionPlan, number: int) -> Flows:
    """Return the corners of step `number` in a planned program."""
    step = plan.program.steps[number]
    places = [motion.step for motion in plan.motions]
    if isinstance(step, Motion) and number in places:
        at = places.index(number)
        return Flows(_corner(plan, at - 1), _corner(plan, at))
    if isinstance(step, SetOutput):
        at = sum(place < number for place in places) - 1
        return Flows(inside=_corner(plan, at))
    return Flows()


def flow_lines(flows: Flows) -> Iterator[str]:
    """Yield lines of text about the corners of a motion that are passed without a stop."""
    if flows.before is not None:
        yield f"continues from {_called(flows.before.first)} without a stop: {_together(flows.before)}"
    if flows.behind is not None:
        yield f"continues into {_called(flows.behind.second)} without a stop: {_together(flows.behind)}"


def _together(corner: Flowing) -> str:
    if corner.begins == corner.ends:
        return f"at {corner.middle:.3f} s"
    return f"both together from {corner.begins:.3f} to {corner.ends:.3f} s, half way at {corner.middle:.3f} s"


def when_set(flows: Flows) -> str:
    """Return words for the time at which an output is set."""
    if flows.inside is None:
        return "at rest,"
    return f"in motion, half way from {_called(flows.inside.first)} to {_called(flows.inside.second)},"


def flows_json(flows: Flows) -> dict[str, Any]:
    """Return the corners of a command as plain data, with units in the names."""
    return {
        name: corner
        and {
            "from": corner.first.label,
            "into": corner.second.label,
            "begins_s": corner.begins,
            "middle_s": corner.middle,
            "ends_s": corner.ends,
        }
        for name, corner in (
            ("before", flows.before),
            ("behind", flows.behind),
            ("inside", flows.inside),
        )
    }


def _corner(plan: MotionPlan, motion: int) -> Flowing | None:
    """Return the corner at the end of a motion; None if the robot stops there."""
    if motion < 0 or not plan.motions[motion].flows:
        return None
    made = plan.motions[motion]
    half = made.half
    middle = float(plan.ends[motion])
    return Flowing(plan.origin_of(motion), plan.origin_of(motion + 1), middle - half, middle, middle + half)


def _called(origin: Origin) -> str:
    return f"{origin.label} {origin.name}".strip()
