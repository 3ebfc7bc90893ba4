"""Make findings about motions that flow into each other; see `yarclang.motion.messages`."""

from __future__ import annotations

from yarclang.hir import (
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Finish,
    Gap,
    Loop,
    Motion,
    NextPass,
    Origin,
    Step,
    Stop,
    TimedMove,
    When,
)
from yarclang.motion.curve import Curve
from yarclang.motion.wording import Message, MessageAbout, length_text
from yarclang.subjects import MissingUnit
from yarclang.units import DEG, MM, MS, Kind


def blend_without_unit(kind: Kind, what: str, origin: Origin) -> MessageAbout:
    """Return the finding that the amount of a BLEND has no unit, although it needs one."""
    message = f"BLEND {what} needs {'an' if kind == 'angle' else 'a'} {kind} unit"
    subject = MissingUnit(kind, f"BLEND {what}")
    return "Y0304", message, origin.span, "for example (mm,deg,s)", None, subject


def nothing_to_flow_into(following: Step | None, origin: Origin) -> Message:
    """Return the finding that no motion follows a BLEND, or that a motion beside it doesn't move."""
    if following is None or isinstance(following, Stop | Finish):
        what = "the program ends here"
    elif isinstance(following, TimedMove):
        what = f"{following.origin.name} follows, whose timetable begins at rest"
    elif isinstance(following, Motion):
        what = "there is no way on one side of the corner"
    elif isinstance(following, Loop | NextPass | Exit | EndLoop) or (
        isinstance(following, When) and following.origin.name == "UNTIL"
    ):
        what = "a pass of a loop begins or ends here"
    elif isinstance(following, EndWhen | Else | When):
        what = "the ways of a WHEN part or meet here"
    else:
        assert not isinstance(following, Gap)  # a gap has its own finding
        what = f"{following.origin.name} follows, which the robot stands for"
    return "Y1010", f"no BLEND is done: {what}", origin.span, "the motion ends in an exact stop", None


def blend_too_large(largest: float, kind: Kind, by_the_next: bool, step: Motion) -> Message:
    """Return the finding that a BLEND takes more than half of a motion."""
    origin = step.origin
    amount = length_text(largest) if kind == "length" else f"{largest / DEG:.4g} deg"
    whose = "the next motion" if by_the_next else "this motion"
    message = f"the blend is more than half of {whose}"
    return (
        "Y0606",
        message,
        origin.span,
        f"the largest one here is {amount}; BLEND <= takes what there is room for",
        None,
    )


def not_tangent(off: tuple[float, float] | None, origin: Origin) -> Message:
    """Return the finding that the two paths at a BLEND 0 aren't tangent."""
    if off is None:
        why = "one is a path of joints, the other one of a frame"
    elif off[0] > off[1]:
        why = f"they meet at {off[0] / DEG:.3g} deg"
    else:
        why = f"the frame turns differently before and after the corner, by {off[1] / DEG * MM:.3g} deg/mm"
    message = f"BLEND 0 needs two paths that are tangent: {why}"
    return (
        "Y0607",
        message,
        origin.span,
        (
            "give the distance by which the corner may be cut, as BLEND 5, or by which the path may be left, "
            "as TOL 0.05"
        ),
        None,
    )


def stops_at_corner(origin: Origin) -> Message:
    """Return the finding that the robot stops at a corner, because the limits leave no room for its blend."""
    message = "the robot stops at this corner: in these times the limits leave no room to flow through it"
    return "Y0608", message, origin.span, "more time, a larger blend or a gentler corner make room", None


def time_off_the_grid(duration: float, curve: Curve, origin: Origin) -> Message:
    """Return the finding that a motion in a chain takes another time than given, because its time isn't a
    whole number of the chain's segments.
    """
    message = (
        f"the motion takes {curve.duration:.6g} s instead of {duration:.6g} s: motions without a stop "
        f"between have one segment time, {curve.segment / MS:.6g} ms, and theirs have none in common"
    )
    return (
        "Y0609",
        message,
        origin.time_span or origin.span,
        "times with a common part, as 1.2 and 0.8, are met exactly",
        None,
    )
