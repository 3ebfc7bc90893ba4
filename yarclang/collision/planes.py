"""How near two bodies come on a piece of a motion, by a plane between them: sharper than distances where they pass along each other.

A plane that stands still against the first body, with the normal n, has the bodies apart by h(t) = min n.b(t) - max n.a over their points. Each n.b(t)
has a second derivative of at most K, so between two times it isn't below the straight line between its values by more than K d^2 / 8, and
neither is the least of them. What a motion does along the plane costs nothing, so that grazing bodies need few pieces: their number grows
with the root of how near they come, not with its inverse. Any normal gives a bound; a good one a good bound.
"""

from __future__ import annotations

import numpy as np

from yarclang.collision.placing import Placed, Relative, arm_lengths, relative
from yarclang.collision.scene import Rows, Scene
from yarclang.shapes import Array


def support(scene: Scene, body: Rows, direction: Array) -> Array:
    """How far bodies (R,) reach from the middles of their boxes in unit directions (R, 3), in the bodies' own axes [m]."""
    reach: Array = np.einsum("ri,ri->r", np.abs(direction), scene.core[body])
    reach = reach + scene.radius[body] + scene.disc[body] * np.hypot(direction[:, 0], direction[:, 1])
    for one in scene.cornered:
        (rows,) = np.nonzero(body == one)
        corners = scene.bodies[one].geometry.corners
        assert corners is not None  # as it is among the cornered
        if len(rows):
            reach[rows] = (corners @ direction[rows].T).max(axis=0)
    return reach


def plane_gap(scene: Scene, pair: Rows, seen: Relative, normal: Array) -> Array:
    """How far planes with unit normals (R, 3), seen from the first bodies, hold the pairs apart [m]; below zero where they cut."""
    along = np.einsum("ri,ri->r", seen.middle, normal)
    turned = -(normal[:, None, :] @ seen.turn)[:, 0]
    first, second = scene.first[pair], scene.second[pair]
    gap: Array = along - support(scene, first, normal) - support(scene, second, turned)
    return gap


def accelerations(placed: Placed, speed: Array, strength: Array, change: Array) -> Array:
    """A bound of the acceleration of each point of a body, against what only the first joints move, (n + 1, M, P) [m/s^2].

    The second derivative of a point by two joints is a double cross product with their axes, no longer than its distance from the axis that is
    nearer to it: sum over the joints k of r_k (|q''_k| + |q'_k|^2 + 2 |q'_k| sum of |q'_j|), over the turning joints j between. By a joint that slides it is
    at most 1, and zero by it twice.

    Args:
        placed: the arm in the middles of P pieces.
        speed: (P, n) largest |velocity| of each joint on them; `strength` likewise of the acceleration.
        strength: (P, n).
        change: (P, n) how far each joint moves from the middle at most.
    """
    chain = placed.scene.chain
    arms = arm_lengths(placed)
    steps = np.zeros((chain.size + 1, *arms.shape[1:]))
    np.multiply(arms, change.T[:, None, :], out=steps[:-1])
    away = np.cumsum(steps[::-1], axis=0)[::-1]
    rate = np.linalg.norm(chain.screws[:, 3:], axis=1)
    turning = (speed * rate).T
    before = np.cumsum(turning, axis=0) - turning
    first, second = np.zeros_like(steps), np.zeros_like(steps)
    for joint in range(chain.size):
        # away from the middle the body may be farther from the axis; what slides stays as it is
        reach = arms[joint] + rate[joint] * away[joint + 1]
        w, a = speed[:, joint], strength[:, joint]
        first[joint] = reach * (a + w * (turning[joint] + 2.0 * before[joint]))
        second[joint] = reach * 2.0 * w
    first, second = (np.cumsum(one[::-1], axis=0)[::-1] for one in (first, second))
    # joints that move both bodies count neither by themselves nor before others
    before = np.concatenate([before, before[-1:] + turning[-1:]])
    total: Array = first - before[:, None, :] * second
    return total


def least_gap(
    scene: Scene, arms: tuple[Placed, Placed, Placed], at: Rows, pair: Rows, normal: Array, slack: Array
) -> Array:
    """A lower bound (R,) of the distances of pairs on pieces [m].

    Args:
        scene: bodies and pairs.
        arms: at the begins, in the middles and at the ends of P pieces.
        at: (R,) the piece of each pair.
        pair: (R,) which pair.
        normal: (R, 3) of its plane, seen from the first body.
        slack: (R,) what the gap is below the straight lines between these times at most.
    """
    gaps = [plane_gap(scene, pair, relative(placed, at, pair), normal) for placed in arms]
    least: Array = np.minimum.reduce(gaps) - slack
    return least
