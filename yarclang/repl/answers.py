"""What the interpreter answers, as text."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.certify.certificate import Clearance, CommandCertificate, Load, bound_text
from yarclang.coordinator.offers import Offer, OfferedMotion
from yarclang.report.pose_text import pose_text
from yarclang.robot.model import Array, Robot
from yarclang.runtime.outcome import Ended
from yarclang.units import DEG, MM

_TIGHT = 0.005
"""Shares of a limit that are nearer to each other are one."""


def offer_text(offer: Offer) -> str:
    """What would be done: a line a motion, and the whole, if there are several."""
    lines = [_motion_text(one) for one in offer.motions]
    if len(lines) != 1:
        lines.append(f"{offer.duration:.2f} s in all" if lines else f"{offer.duration:.2f} s, nothing moves")
    return "\n".join(lines)


def _motion_text(one: OfferedMotion) -> str:
    """`MOVEJ  1.00 s  J5 at 82 % of its velocity  nearest of 8  143 mm clear (FOREARM, FENCE)  path within 0.004 mm`."""
    proved = one.proved
    words = [one.title, f"{one.seconds:.2f} s", _peak_text(proved)]
    if one.branch:
        words.append(f"{one.branch} configurations")
    if proved.clearance is not None:
        words.append(_clearance_text(proved.clearance))
    words += _path_text(proved)
    return "  ".join(word for word in words if word)


def _peak_text(proved: CommandCertificate) -> str:
    """The limit that is used most."""
    loads = {
        "its velocity": proved.velocity,
        "its acceleration": proved.acceleration,
        "its jerk": proved.jerk,
        "its motor's speed": proved.motor_velocity,
    }
    if not proved.jerk_judged:
        del loads["its jerk"]
    # of limits that are used as much as each other, the one that people think of first
    name, load = max(loads.items(), key=lambda item: round(item[1].share / _TIGHT))
    return _load_text(load, name)


def _load_text(load: Load, of: str) -> str:
    return f"{load.name} at {load.share * 100:.0f} % of {of}" if load.name else ""


def _clearance_text(clearance: Clearance) -> str:
    if not clearance.first:
        return f"over {clearance.distance / MM:.0f} mm clear"
    return f"{clearance.distance / MM:.1f} mm clear ({clearance.first}, {clearance.second})"


def _path_text(proved: CommandCertificate) -> Iterator[str]:
    """How near it stays to the programmed path."""
    path = proved.deviation
    if proved.kind != "joint":
        yield f"path within {bound_text(path.position / MM)} mm, {bound_text(path.angle / DEG)} deg"


def ended_text(ended: Ended, robot: Robot) -> str:
    """How something has ended; where the robot stands, if it isn't where it was to go."""
    if ended.well:
        return "done"
    lines = [ended.what or "it didn't come to its end"]
    if ended.remedy:
        lines.append(f"  help: {ended.remedy}")
    if ended.joints is not None:
        where = f"  {robot.name} stands at {joints_text(robot, ended.joints)}"
        lines.append(f"{where}, {ended.done:.2f} s into {ended.command}" if ended.command else where)
    return "\n".join(lines)


def joints_text(robot: Robot, joints: Array) -> str:
    """`J1 10.000 deg, J2 ...` of joint positions (n,) [rad or m]."""
    values = np.round(joints / robot.axis_units, 3) + 0.0
    return ", ".join(
        f"{name} {value:.3f} {unit}"
        for name, value, unit in zip(robot.joint_names, values, robot.axis_unit_names, strict=True)
    )


def where_text(moving: str, pose: Array, base: str) -> str:
    """`{TCP} 0.000 1174.400 1176.000 mm, 0.0000 0.0000 0.0000 deg in {B}` of a pose (4, 4) [m]."""
    return f"{moving} {pose_text(pose)} in {base}"
