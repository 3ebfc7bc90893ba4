"""Upper bounds of the travel and of the acceleration of any point of a body, if the joints move by given
amounts. The bounds hold for all joint positions on the way.
"""

from __future__ import annotations

import numpy as np

from yarclang.collision.placing import Placed
from yarclang.shapes import Array


def travel(placed: Placed, change: Array) -> Array:
    """Return upper bounds of the distance that any point of each body moves when joints move.

    Let the joints move one after the other, beginning at the base. Each joint turns the body about the
    joint's axis. The body's distance from this axis is still that of the posture `placed`, since the joints
    that have moved before have moved axis and body together. So the sum of these motions is a bound, whatever
    postures the arm passes through.

    Args:
        placed: the arm at P joint positions.
        change: (P, n) the largest motion of each joint from there [rad or m].

    Returns:
        (n + 1, M, P) [m]: row k has the motion relative to a body that only the first k joints move.
    """
    arms = arm_lengths(placed)
    steps = np.zeros((len(arms) + 1, *arms.shape[1:]))
    np.multiply(arms, change.T[:, None, :], out=steps[:-1])
    # Row k is the sum over the joints from k on: joints before k move both bodies alike.
    against: Array = np.cumsum(steps[::-1], axis=0)[::-1]
    return against


def arm_lengths(placed: Placed) -> Array:
    """Return the largest distance of any point of each body from the axis of each joint, (n, M, P) [m]: the
    distance that the point moves per unit of the joint's motion.

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
        # Move the point of the screw's axis that is nearest to the origin, w x v / |w|^2, with the arm. Here
        # v is the linear part of the screw, and w the angular one.
        point = turn @ (np.cross(angular, linear) / rate**2) + shift
        # The lever arm is the distance of the body's middle from the axis, |arm x axis|, plus the radius of
        # its sphere.
        arm = placed.middle[moved] - point
        away = np.cross(arm, axis)
        radius = np.sqrt(np.einsum("bpi,bpi->bp", away, away)) + scene.boxes.bound[moved, None]
        # A helical joint also translates the body.
        slide = abs(float(angular @ linear)) / rate
        arms[joint, moved] = np.hypot(radius * rate, slide)
    return arms


def accelerations(placed: Placed, speed: Array, strength: Array, change: Array) -> Array:
    """Return upper bounds of the acceleration of any point of each body during P time intervals of a motion.

    The joints are numbered from 0. Joint i has the position q_i, and no point of the body is farther from its
    axis than r_i. For joints j ≤ i, the second derivative of a point's position with respect to q_j and q_i
    is a double cross product with the axes of both joints, and its length is at most r_i. If joint i is
    prismatic, r_i stands for 1; if joint j < i is prismatic, or i = j is, the second derivative is 0.

    Row k has the acceleration relative to a body that only the first k joints move. It is at most the sum,
    over the joints i ≥ k, of r_i (|q''_i| + |q'_i|² + 2 |q'_i| Σ |q'_j|). Here Σ goes over the revolute
    joints j with k ≤ j < i, and |q'_i|² is left out if joint i is prismatic.

    Args:
        placed: the arm in the middle of each interval.
        speed: (P, n) largest |q'| of each joint in each interval.
        strength: (P, n) largest |q''| of each joint in each interval.
        change: (P, n) the largest motion of each joint from the middle of each interval.

    Returns:
        (n + 1, M, P) [m/s²], for the n + 1 rows k, the M bodies and the P intervals.
    """
    chain = placed.scene.chain
    arms = arm_lengths(placed)
    steps = np.zeros((chain.size + 1, *arms.shape[1:]))
    np.multiply(arms, change.T[:, None, :], out=steps[:-1])
    away = np.cumsum(steps[::-1], axis=0)[::-1]
    rate = np.linalg.norm(chain.screws[:, 3:], axis=1)
    turning = (speed * rate).T
    # Sum of |q'_j| over the turning joints before each joint.
    before = np.cumsum(turning, axis=0) - turning
    first, second = np.zeros_like(steps), np.zeros_like(steps)
    for joint in range(chain.size):
        # Away from the middle of the interval, the body may be farther from a revolute joint's axis. The
        # bound of a prismatic joint stays the same.
        reach = arms[joint] + rate[joint] * away[joint + 1]
        # `first` has the terms r (|q''| + |q'|^2 + 2 |q'| sum |q'_j|), with the sum over all joints before
        # this one. `second` has the factor 2 r |q'| of this sum: below, the share of the joints before k is
        # subtracted with it.
        w, a = speed[:, joint], strength[:, joint]
        first[joint] = reach * (a + w * (turning[joint] + 2.0 * before[joint]))
        second[joint] = reach * 2.0 * w
    first, second = (np.cumsum(one[::-1], axis=0)[::-1] for one in (first, second))
    # Joints before k move both bodies and don't change their relative acceleration: remove their share.
    before = np.concatenate([before, before[-1:] + turning[-1:]])
    total: Array = first - before[:, None, :] * second
    return total
