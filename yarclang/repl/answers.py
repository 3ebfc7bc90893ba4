"""Format the interpreter's answers as text."""

from __future__ import annotations

import numpy as np

from yarclang.certify.outward import down, percent, up
from yarclang.coordinator.describing import joints_of, lasting_of
from yarclang.coordinator.messages.events import Finished
from yarclang.coordinator.messages.replies import ClearanceBound, Ended, MotionOffered, OfferDescribed, Peaks
from yarclang.report.pose_text import pose_text
from yarclang.robot.model import Array, Robot

_TIGHT = 0.005
"""Two shares of a limit count as equal if they differ by less than this."""


_SAME_TIME = 5e-3
"""Two times count as equal in the output if they differ by less than this [s]."""


def offer_text(offer: OfferDescribed) -> str:
    """Return the plan of a typed motion as text: a line for each motion and, unless it is a single motion,
    the total.
    """
    lines = [_motion_text(one) for one in offer.motions]
    # a single motion needs the total too if there is also time at rest or a wait
    if len(lines) != 1 or offer.takes.waits or offer.takes.duration_s > offer.motions[0].seconds + _SAME_TIME:
        time = lasting_of(offer.takes).text(hundredths)
        lines.append(f"{time} in all" if lines else f"{time}, nothing moves")
    lines += offer.parts
    return "\n".join(lines)


def _motion_text(one: MotionOffered) -> str:
    """Return a line about a planned motion, such as `MOVEJ  1.00 s  J5 at 82 % of its velocity  143 mm clear
    (FOREARM, FENCE)`.
    """
    words = [one.title, f"{one.seconds:.2f} s", _peak_text(one.peaks)]
    if one.branch:
        words.append(f"{one.branch} configurations")
    if one.clearance is not None:
        words.append(_clearance_text(one.clearance))
    if one.path is not None:
        words.append(f"path within {up(one.path.position_mm, 4)} mm, {up(one.path.angle_deg, 4)} deg")
    return "  ".join(word for word in words if word)


def hundredths(seconds: float) -> str:
    """Return a time [s] with two decimals, as the prompt shows times."""
    return f"{seconds:.2f} s"


def _peak_text(peaks: Peaks) -> str:
    """Return the limit that the motion uses most, as text."""
    used = {"its velocity": peaks.velocity, "its acceleration": peaks.acceleration}
    if peaks.jerk is not None:
        used["its jerk"] = peaks.jerk
    used["its motor's speed"] = peaks.motor_velocity
    # If several limits are used equally, choose the most familiar one, which comes first.
    name, peak = max(used.items(), key=lambda item: round(item[1].share / _TIGHT))
    return f"{peak.name} at {percent(peak.share)} % of {name}" if peak.name else ""


def _clearance_text(clearance: ClearanceBound) -> str:
    if not clearance.first:
        return f"over {down(clearance.distance_mm, 0)} mm clear"
    return f"{down(clearance.distance_mm, 1)} mm clear ({clearance.first}, {clearance.second})"


def ended_text(ended: Ended | Finished, robot: Robot) -> str:
    """Return a text about how an order has ended. If the robot isn't at its target, add the robot's
    position.
    """
    if ended.well:
        return "done"
    lines = [ended.what or "it didn't reach its end"]
    if ended.help:
        lines.append(f"  help: {ended.help}")
    if ended.joints is not None:
        where = f"  {robot.name} stands at {joints_text(robot, joints_of(robot, ended.joints))}"
        into = f", in {ended.command}, {ended.done_s:.2f} s after the start"
        lines.append(f"{where}{into}" if ended.command else where)
    return "\n".join(lines)


def joints_text(robot: Robot, joints: Array) -> str:
    """Return a text such as `J1 10.000 deg, J2 ...` of joint positions (n,) [rad or m]."""
    values = np.round(joints / robot.axis_units, 3) + 0.0
    return ", ".join(
        f"{name} {value:.3f} {unit}"
        for name, value, unit in zip(robot.joint_names, values, robot.axis_unit_names, strict=True)
    )


def where_text(moving: str, pose: Array, base: str) -> str:
    """Return the pose (4, 4) [m] of a moving frame in a base frame as text, with both names, in mm and
    deg.
    """
    return f"{moving} {pose_text(pose)} in {base}"
