"""Measure the angle between an axis on the flange and a fixed direction, and bound the rate at which the axis
turns.
"""

from __future__ import annotations

import numpy as np

from yarclang.cell.keeping import Tilt
from yarclang.collision.course import Course
from yarclang.collision.scene import Scene
from yarclang.collision.zones.moved import Arm
from yarclang.robot.model import Chain
from yarclang.shapes import Array


def angles(tilt: Tilt, chain: Chain, turn: Array) -> Array:
    """Return the angles (P,) [rad] between an axis on the flange and the direction that it should have.

    Args:
        tilt: the axis on the flange, and the direction.
        chain: the arm.
        turn: (3, 3, P) rotations of the flange from its pose with all joints at zero.
    """
    axis = chain.base_from_flange[:3, :3] @ np.array(tilt.own)
    now, up = np.matmul(axis, turn), np.array(tilt.up)
    across = np.cross(now.T, up).T
    # The arc tangent is exact for small angles too, at which the cosine hardly changes.
    found: Array = np.arctan2(np.sqrt((across**2).sum(axis=0)), up @ now)
    return found


def angles_at(tilt: Tilt, scene: Scene, q: Array) -> Array:
    """Return the angles (P,) [rad] between an axis on the flange and the direction that it should have, at
    joint positions (P, n).
    """
    return angles(tilt, scene.chain, Arm.at(scene, q).turn[-1])


def turning(chain: Chain, course: Course) -> tuple[Array, Array]:
    """Return bounds of the first and of the second derivative of a unit vector on the flange, on each segment
    of a motion, (N,) each [1/s, 1/s^2].

    The partial derivatives of a turned unit vector with respect to the joints are nested cross products with
    the joints' axes. Their length is at most 1 for axes of length 1.
    """
    axes = np.linalg.norm(chain.screws[:, 3:], axis=1)
    speed, strength = course.speed @ axes, course.strength @ axes
    return speed, strength + speed**2
