"""Words in findings for the time of an event in a motion, and for the robot's position at that time."""

from __future__ import annotations

import numpy as np

from yarclang import hir
from yarclang.certify.kinematics.arm import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.units import MM


def span_text(begin: float, end: float, duration: float) -> str:
    """Return in words when a time span of a motion begins and ends, in s and in percent of the duration."""
    shares = (f"{100.0 * time / duration:.0f} %" for time in (begin, end))
    return f"from {begin:.3f} s to {end:.3f} s after its start ({' to '.join(shares)})"


def pose_text(robot: Robot, origin: hir.Origin, q: Array) -> str:
    """Return in words the joint positions (n,) [rad or m] and the position of the tool."""
    joints = " ".join(f"{value:.2f}" for value in (q / robot.axis_units).round(2) + 0.0)
    units = ",".join(dict.fromkeys(robot.axis_unit_names))
    name = origin.moving.name if origin.moving else "TCP"
    frame = robot.flange_from_frame.get(name)
    if frame is None:
        name, frame = "FLANGE", np.eye(4)
    point = tool_poses(robot.chain, q[None], frame)[0, :3, 3] / MM
    tool = " ".join(f"{value:.1f}" for value in point.round(1) + 0.0)
    return f"with the joints at {joints} {units} and {{{name}}} at {tool} mm in {{B}}"
