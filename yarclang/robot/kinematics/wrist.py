"""Compute both solutions for the three angles of a wrist whose axes meet, for many poses at once. An angle
that a singularity leaves free takes a given value.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.kinematics.geometry import Form, WristAngles
from yarclang.robot.model import Array

HOLD = 1e-10
"""Scale of the transition to a held angle: the sine of the wrist's angle, or the wrist centre's distance from
axis 1 [m].

Below this scale, the angle that the pose no longer determines changes smoothly to the held one. The change
moves the pose by at most half of the scale, times the difference of the angles [rad].
"""

REACH_TOLERANCE = 1e-10
"""Distance beyond the boundary of the workspace up to which a pose counts as reachable [m, or as a sine]."""

TURN = 2.0 * math.pi


def wrist_angles(
    arm: Form | WristAngles, rest: Array, hold: Array
) -> tuple[Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Solve the wrist's three angles for the rotation that the wrist must make.

    rest = Rz(q4) Rx(alpha) Rz(t5) Rx(beta) Rz(q6), with t5 = q5 + bend. The last column of `rest` is axis 6.
    The angle between axes 4 and 6 gives t5 (subproblem 4); then the direction of axis 6 gives q4 (subproblem
    1). q6 is computed from q4, so that an uncertain q4 at a straight wrist doesn't falsify the pose.

    Args:
        arm: has the angles between the wrist's axes.
        rest: the rotation (3, 3, arm 4, N).
        hold: the value of q4 if the wrist is straight [rad].

    Returns:
        The angles (3, wrist 2, arm 4, N) [rad]; a mask (arm 4, N) of the rotations that the wrist can make;
        and a mask (arm 4, N) of the rotations for which it is straight.
    """
    alpha, beta = arm.alpha, arm.beta
    sin_a, cos_a, sin_b, cos_b = math.sin(alpha), math.cos(alpha), math.sin(beta), math.cos(beta)
    x, y, z = rest[:, 2]
    lean_sine = np.hypot(x, y)
    lean = np.arctan2(lean_sine, z)
    # spherical triangle with sides alpha, beta and lean: sine and cosine of half the angle at axis 5, times a
    # common factor
    half, middle, difference = 0.5 * lean, 0.5 * (alpha + beta), 0.5 * (alpha - beta)
    sine = np.sin(middle + half) * np.sin(middle - half)
    cosine = np.sin(half + difference) * np.sin(half - difference)
    bendable = np.minimum(sine, cosine) >= -REACH_TOLERANCE * sin_a * sin_b
    t5 = 2.0 * np.arctan2(np.sqrt(np.maximum(sine, 0.0)), np.sqrt(np.maximum(cosine, 0.0)))
    sin5, cos5 = np.sin(t5), np.cos(t5)
    # the angle about axis 4 of the direction of axis 6, before joint 4 turns
    before = np.arctan2(-cos_a * sin_b * cos5 - sin_a * cos_b, sin_b * sin5)
    seen = np.arctan2(y, x)
    angles = np.empty((3, 2, *t5.shape))
    angles[0, 0], angles[0, 1] = seen - before, seen + before - math.pi
    straight = lean_sine < 10.0 * HOLD
    if straight.any():
        angles[0] = held(angles[0], hold, lean_sine)
    angles[1, 0], angles[1, 1] = t5 - arm.bend, -t5 - arm.bend
    sin4, cos4 = np.sin(angles[0]), np.cos(angles[0])
    # the common normal of axes 5 and 6, in frame 4
    side = np.stack((cos_a * sin5, -cos_a * sin5))
    across_x, across_y = cos4 * cos5 - sin4 * side, sin4 * cos5 + cos4 * side
    across_z = np.stack((sin_a * sin5, -sin_a * sin5))
    along = [
        across_x * rest[0, axis] + across_y * rest[1, axis] + across_z * rest[2, axis] for axis in (0, 1)
    ]
    np.arctan2(-along[1], along[0], out=angles[2])
    return angles, bendable, straight


def held(angle: Array, hold: Array, weight: Array) -> Array:
    """Return `angle`, changed smoothly to the given value `hold` where `weight` (the distance from a
    singularity) is far below HOLD.
    """
    square = weight * weight
    away = angle - hold
    away -= TURN * np.round(away * (1.0 / TURN))
    held: Array = hold + away * (square / (square + HOLD * HOLD))
    return held
