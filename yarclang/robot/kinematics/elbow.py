"""Where an arm has its elbow: the place that swings out although neither shoulder nor flange does."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import links_of
from yarclang.robot.model import Array, Chain

LEAST = 0.01
"""An axis that is nearer to the shoulder or to the flange than this [m] is no elbow."""


@frozen(eq=False)
class Elbow:
    """The elbow sits on the axis of joint number `joint`, counted from 0, at `point` (3,) [m] in {B} with all joints at zero.

    That joint turns in it, so it is moved by the joints before.
    """

    joint: int
    point: Array


@lru_cache(maxsize=256)
def elbow_of(chain: Chain) -> Elbow | None:
    """The elbow of an arm; None where it has none.

    The shoulder is where the first two turning axes meet, or come nearest. The elbow's axis is the one that is farthest from both
    shoulder and flange (of the two distances the smaller counts), with all joints at zero: such a joint changes most how far the flange is from the shoulder.
    The elbow is the point of it that is nearest to the shoulder.
    """
    turning = np.flatnonzero(~chain.is_prismatic)
    if len(turning) < 2:
        return None
    frames = links_of(chain).frames
    shoulder = _nearest_on(frames[turning[0]], frames[turning[1]])
    flange = chain.base_from_flange[:3, 3]
    best, found = LEAST, None
    for joint in turning[1:].tolist():
        point = _foot(frames[joint], shoulder)
        away = min(
            float(np.linalg.norm(shoulder - point)),
            float(np.linalg.norm(flange - _foot(frames[joint], flange))),
        )
        # the first of two that are as far by rounding
        if away > best * (1.0 + 1e-9):
            best, found = away, Elbow(joint, point)
    return found


def _foot(frame: Array, point: Array) -> Array:
    """The point of a frame's z axis that is nearest to a point (3,)."""
    axis, origin = frame[:3, 2], frame[:3, 3]
    foot: Array = origin + axis * float(axis @ (point - origin))
    return foot


def _nearest_on(one: Array, other: Array) -> Array:
    """The point of one frame's z axis that is nearest to another's; of parallel ones the foot of the other's origin."""
    across = np.cross(one[:3, 2], other[:3, 2])
    if float(across @ across) < 1e-12:
        return _foot(one, other[:3, 3])
    apart = other[:3, 3] - one[:3, 3]
    along = float(np.cross(apart, other[:3, 2]) @ across) / float(across @ across)
    nearest: Array = one[:3, 3] + along * one[:3, 2]
    return nearest
