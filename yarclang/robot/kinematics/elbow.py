"""Find an arm's elbow: a point of the arm that can swing out while shoulder and flange stay in place."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import links_of
from yarclang.robot.model import Array, Chain

LEAST = 0.01
"""Least distance of an elbow's axis from the shoulder and from the flange [m]."""


@frozen(eq=False)
class Elbow:
    """An arm's elbow: `point` (3,) [m] in {B} with all joints at zero, on the axis of joint number `joint`
    (from 0).

    Since the point is on that axis, only the joints before that joint move the elbow.
    """

    joint: int
    point: Array


@lru_cache(maxsize=256)
def elbow_of(chain: Chain) -> Elbow | None:
    """Return the elbow of an arm, or None if it has none.

    The shoulder is the point at which the first two turning axes meet, or come nearest to each other. Each
    turning axis has two distances, from the shoulder and from the flange, with all joints at zero. The
    elbow's axis is the one whose smaller distance is largest. A joint on this axis changes the distance from
    shoulder to flange most. The elbow is the point of the axis that is nearest to the shoulder.
    """
    turning = np.flatnonzero(~chain.is_prismatic)
    if len(turning) < 2:
        return None
    frames = links_of(chain).frames
    shoulder = _nearest_on(frames[turning[0]], frames[turning[1]])
    flange = chain.base_from_flange[:3, 3]
    best, elbow = LEAST, None
    for joint in turning[1:].tolist():
        point = _foot(frames[joint], shoulder)
        away = min(
            float(np.linalg.norm(shoulder - point)),
            float(np.linalg.norm(flange - _foot(frames[joint], flange))),
        )
        # if several axes have equal distances up to rounding, keep the first axis
        if away > best * (1.0 + 1e-9):
            best, elbow = away, Elbow(joint, point)
    return elbow


def _foot(frame: Array, point: Array) -> Array:
    """Return the point on a frame's z axis that is nearest to a point (3,)."""
    axis, origin = frame[:3, 2], frame[:3, 3]
    foot: Array = origin + axis * float(axis @ (point - origin))
    return foot


def _nearest_on(axis: Array, other: Array) -> Array:
    """Return the point on the z axis of the frame `axis` that is nearest to the z axis of the frame `other`.

    For parallel axes, this is the foot of the perpendicular from the origin of `other`.
    """
    across = np.cross(axis[:3, 2], other[:3, 2])
    if float(across @ across) < 1e-12:
        return _foot(axis, other[:3, 3])
    apart = other[:3, 3] - axis[:3, 3]
    # the foot of the common perpendicular of two skew lines
    along = float(np.cross(apart, other[:3, 2]) @ across) / float(across @ across)
    nearest: Array = axis[:3, 3] + along * axis[:3, 2]
    return nearest
