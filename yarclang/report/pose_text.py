"""Poses as people write them: x y z [mm] and roll pitch yaw [deg]."""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array
from yarclang.units import DEG, MM

_STRAIGHT = 1e-9
"""With a cosine of the pitch below this, roll and yaw turn about one axis, and yaw stays 0."""


def pose_values(pose: Array) -> Array:
    """X y z [mm] and roll pitch yaw [deg] (6,) of a pose (4, 4): R = Rz(yaw) Ry(pitch) Rx(roll)."""
    rotation = pose[:3, :3]
    cosine = float(np.hypot(rotation[0, 0], rotation[1, 0]))
    pitch = np.arctan2(-rotation[2, 0], cosine)
    if cosine < _STRAIGHT:
        roll, yaw = np.arctan2(-rotation[0, 1] * np.sign(rotation[2, 0]), rotation[1, 1]), 0.0
    else:
        roll = np.arctan2(rotation[2, 1], rotation[2, 2])
        yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
    return np.concatenate((pose[:3, 3] / MM, np.array([roll, pitch, yaw]) / DEG))


def pose_text(pose: Array) -> str:
    """`0.00 1174.40 1176.00 mm, 0.000 0.000 0.000 deg`."""
    values = pose_values(pose)
    # no minus before a zero
    place = " ".join(f"{value:.3f}" for value in values[:3].round(3) + 0.0)
    turn = " ".join(f"{value:.4f}" for value in values[3:].round(4) + 0.0)
    return f"{place} mm, {turn} deg"
