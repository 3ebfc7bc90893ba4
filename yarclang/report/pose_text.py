"""Format poses for people: x y z [mm] and roll pitch yaw [deg]."""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM


def pose_values(pose: Array) -> Array:
    """Return position and orientation of a pose (4, 4), as x y z [mm] and roll pitch yaw [deg] (6,): R =
    Rz(yaw) Ry(pitch) Rx(roll).
    """
    return np.concatenate((pose[:3, 3] / MM, roll_pitch_yaw(pose[:3, :3]) / DEG))


def pose_text(pose: Array) -> str:
    """Format a pose: `0.00 1174.40 1176.00 mm, 0.000 0.000 0.000 deg`."""
    values = pose_values(pose)
    # adding 0.0 removes the sign of zero
    place = " ".join(f"{value:.3f}" for value in values[:3].round(3) + 0.0)
    turn = " ".join(f"{value:.4f}" for value in values[3:].round(4) + 0.0)
    return f"{place} mm, {turn} deg"
