"""Write the amounts in messages about motions as text."""

from __future__ import annotations

from yarclang.diagnostics import Fix
from yarclang.robot.model import Robot
from yarclang.source import Span
from yarclang.subjects import Subject
from yarclang.units import DEG, MM

Message = tuple[str, str, Span, str, Fix | None]
"""A finding's code, its sentence, its place, the help and the fix."""

MessageAbout = tuple[str, str, Span, str, Fix | None, Subject]
"""A message, and the subject of the finding."""

_ANGLE_NOISE = 1e-3
"""Largest error of orientation [rad] that isn't reported: the search for the least distance leaves such
errors.
"""

_DISTANCE_NOISE = 1e-6
"""Largest error of position [m] that isn't reported: the search leaves such errors."""


def percent_text(share: float) -> str:
    """Return a share as text in percent."""
    return f"{share * 100:.3g} %" if share < 10.0 else f"{share * 100:,.0f} %"


def miss_text(distance: float, angle: float) -> str:
    """Return an error of position [m], of orientation [rad] or of both as text. An error that is only
    numerical noise is left out.
    """
    if angle <= _ANGLE_NOISE:
        return length_text(distance)
    turn = f"{angle / DEG:.3g} deg"
    return turn if distance < _DISTANCE_NOISE else f"{length_text(distance)} and {turn}"


def length_text(metres: float) -> str:
    """Return a length [m] as text in mm."""
    return f"{metres / MM:.3g} mm" if abs(metres) < 1.0 else f"{metres / MM:,.0f} mm"


def amount_text(robot: Robot, joint: int, value: float) -> str:
    """Return an amount of a joint's motion [rad or m] as text in the joint's unit."""
    return f"{value / robot.axis_units[joint]:.4g} {robot.axis_unit_names[joint]}"


def beyond_text(robot: Robot, joint: int, excess: float) -> str:
    """Return as text by how much a joint is beyond its limits. A negative `excess` [rad or m] is below the
    lower limit.
    """
    side = "above its upper" if excess > 0 else "below its lower"
    return f"{robot.joint_names[joint]} {amount_text(robot, joint, abs(excess))} {side} limit"


def range_text(robot: Robot, joint: int) -> str:
    """Return the limits of a joint as text."""
    lower, upper = (
        limit[joint] / robot.axis_units[joint] for limit in (robot.limits.lower, robot.limits.upper)
    )
    return (
        f"the limits of {robot.joint_names[joint]} are {lower:.6g} and {upper:.6g} "
        f"{robot.axis_unit_names[joint]}"
    )
