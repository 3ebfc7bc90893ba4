"""Bound how far, and with which acceleration, any point of a body moves when the joints move by given
amounts, whatever postures are in between.
"""

from __future__ import annotations

import numpy as np

from yarclang.collision.placing import Placed
from yarclang.shapes import Array


def travel(placed: Placed, change: Array) -> Array:
    """Return upper bounds of the distance that any point of each body moves when joints move.

    Let the joints move one after the other, beginning at the base. Each joint turns the body about its axis
    on a circle with the present radius, since the joints before it have moved axis and body together. The sum
    of these motions is therefore a bound for any postures in between.

    Args:
        placed: the arm at P joint positions.
        change: (P, n) the largest motion of each joint from there [rad or m].

    Returns:
        (n + 1, M, P) [m]: row k relative to a body that only the first k joints move.
    """
    arms = arm_lengths(placed)
    steps = np.zeros((len(arms) + 1, *arms.shape[1:]))
    np.multiply(arms, change.T[:, None, :], out=steps[:-1])
    # Row k is the sum over the joints from k on: joints before k move both bodies alike.
    against: Array = np.cumsum(steps[::-1], axis=0)[::-1]
    return against


def arm_lengths(placed: Placed) -> Array:
    """Return the largest distance of any point of each body from the axis of each joint, (n, M, P) [m].

    The value is 1 for a prismatic joint, and 0 for a joint that doesn't move the body.
    """
    scene, chain = placed.scene, placed.scene.chain
    bodies, count = placed.middle.shape[:2]
    arms = np.zeros((chain.size, bodies, count))
    for joint in range(chain.size):
        linear, angular = chain.screws[joint, :3], chain.screws[joint, 3:]
        (moved,) = np.nonzero(scene.boxes.joint > joint)
        if not angular.any():
            arms[joint, moved] = np.linalg.norm(linear)
            continue
        turn, shift = placed.turn[joint], placed.shift[joint]
        rate = float(np.linalg.norm(angular))
        axis = turn @ (angular / rate)
        point = turn @ (np.cross(angular, linear) / rate**2) + shift
        # Distance of the body's middle from the axis, |arm x axis|, plus the radius of its sphere.
        arm = placed.middle[moved] - point
        away = np.cross(arm, axis)
        radius = np.sqrt(np.einsum("bpi,bpi->bp", away, away)) + scene.boxes.bound[moved, None]
        # A screw with a pitch slides as well.
        slide = abs(float(angular @ linear)) / rate
        arms[joint, moved] = np.hypot(radius * rate, slide)
    return arms


def accelerations(placed: Placed, speed: Array, strength: Array, change: Array) -> Array:
    """Return upper bounds of the acceleration of any point of each body, (n + 1, M, P) [m/s^2], on P pieces
    of a motion's time.

    Row k is relative to a body that only the first k joints move. The second derivative of a point with
    respect to two joints is a double cross product with their axes. Its length is at most the point's
    distance from one of the axes, the one that is nearer to the point in the chain. The sum over the joints k
    is r_k (|q''_k| + |q'_k|² + 2 |q'_k| Σ |q'_j|), over the revolute joints j between. If one of the joints
    is prismatic, the derivative is at most 1; it is zero if both are.

    Args:
        placed: the arm in the middles of the P pieces.
        speed: (P, n) largest |velocity| of each joint on the pieces.
        strength: (P, n) largest |acceleration| of each joint on the pieces.
        change: (P, n) the largest motion of each joint from the middle of its piece.
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
        # Away from the middle, the body may be farther from the axis. For sliding joints nothing changes.
        reach = arms[joint] + rate[joint] * away[joint + 1]
        w, a = speed[:, joint], strength[:, joint]
        first[joint] = reach * (a + w * (turning[joint] + 2.0 * before[joint]))
        second[joint] = reach * 2.0 * w
    first, second = (np.cumsum(one[::-1], axis=0)[::-1] for one in (first, second))
    # Joints that move both bodies have no effect, neither by themselves nor as joints before others.
    before = np.concatenate([before, before[-1:] + turning[-1:]])
    total: Array = first - before[:, None, :] * second
    return total
