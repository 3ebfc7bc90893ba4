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
    """Return the finding that the amount of a BLEND lacks a unit that is needed here."""
    message = f"BLEND {what} needs {'an' if kind == 'angle' else 'a'} {kind} unit"
    subject = MissingUnit(kind, f"BLEND {what}")
    return "Y0304", message, origin.span, "for example (mm,deg,s)", None, subject


def nothing_to_flow_into(following: Step | None, origin: Origin) -> Message:
    """Return the finding that no motion follows a BLEND, or that one of the two motions doesn't move
    anything.
    """
    if following is None or isinstance(following, Stop | Finish):
        what = "the program ends after it"
    elif isinstance(following, TimedMove):
        what = f"{following.origin.name} follows, whose timetable begins at rest"
    elif isinstance(following, Motion):
        what = "one of the two motions at the corner has length 0"
    elif isinstance(following, Loop | NextPass | Exit | EndLoop) or (
        isinstance(following, When) and following.origin.name == "UNTIL"
    ):
        what = "a pass of a loop begins or ends here"
    elif isinstance(following, EndWhen | Else | When):
        what = "the branches of a WHEN begin or end here"
    else:
        assert not isinstance(following, Gap)  # gaps are reported elsewhere
        what = f"{following.origin.name} follows, for which the robot stops"
    return (
        "Y1010",
        f"BLEND has no effect: {what}",
        origin.span,
        "remove BLEND: the motion ends with an exact stop",
        None,
    )


def blend_too_large(largest: float, kind: Kind, by_the_next: bool, step: Motion) -> Message:
    """Return the finding that a BLEND needs more than half of a motion."""
    origin = step.origin
    amount = length_text(largest) if kind == "length" else f"{largest / DEG:.4g} deg"
    whose = "the next motion" if by_the_next else "this motion"
    message = f"BLEND is more than half of {whose}"
    return (
        "Y0606",
        message,
        origin.span,
        f"the largest possible blend is {amount}; BLEND <= uses the largest that fits",
        None,
    )


def not_tangent(off: tuple[float, float] | None, of_frame: bool, origin: Origin) -> Message:
    """Return the finding that the two paths at a BLEND 0 aren't tangent.

    Args:
        off: angle between the directions [rad], and difference of the rotations per length [rad/m]; None if
            one path is a joint path and the other one a path of the moving frame.
        of_frame: True if both are paths of one moving frame. Only then does a TOL allow a corner.
        origin: the command.
    """
    if off is None:
        why = "one is a joint path, the other a path of the moving frame"
    elif off[0] > off[1]:
        why = f"their directions differ by {off[0] / DEG:.3g} deg"
    else:
        why = (
            "the frame's rotation per length differs before and after the corner by "
            f"{off[1] / DEG * MM:.3g} deg/mm"
        )
    message = f"BLEND 0 needs tangent paths: {why}"
    return (
        "Y0607",
        message,
        origin.span,
        "give a blend distance, such as BLEND 5" + ", or a path tolerance, such as TOL 0.05" * of_frame,
        None,
    )


def stops_at_corner(origin: Origin) -> Message:
    """Return the finding that the robot stops at a corner, because the limits leave no room for its blend."""
    message = (
        "the robot stops at this corner: in the given times it can't flow through the corner within "
        "its limits"
    )
    return "Y0608", message, origin.span, "allow more time, a larger blend or a gentler corner", None


def time_off_the_grid(duration: float, curve: Curve, origin: Origin) -> Message:
    """Return the finding that a motion in a chain doesn't take exactly its given duration, since this
    duration isn't an integer multiple of the chain's segment time.
    """
    message = (
        f"the motion takes {curve.duration:.6g} s instead of {duration:.6g} s: motions that flow into each "
        f"other share one segment time, here {curve.segment / MS:.6g} ms, and this time isn't a multiple "
        "of it"
    )
    return (
        "Y0609",
        message,
        origin.time_span or origin.span,
        "give times with a common divisor, such as 1.2 and 0.8, to get them exactly",
        None,
    )
