"""How far, and how quickly, a change of the joints can move the bodies: bounds for all their points and all postures on the way."""

from __future__ import annotations

import numpy as np

from yarclang.collision.placing import Placed
from yarclang.shapes import Array


def travel(placed: Placed, change: Array) -> Array:
    """How far a point of a body moves at most when joints change.

    Moving the joints one after the other, that of the base first, each turns the body by a circle around its axis whose radius is
    what it is now: the joints before it have moved axis and body together. So no posture between counts.

    Args:
        placed: the arm at P joint positions.
        change: (P, n) how far each joint moves from there at most [rad or m].

    Returns:
        (n + 1, M, P) [m]: against what only the first joints move.
    """
    arms = arm_lengths(placed)
    steps = np.zeros((len(arms) + 1, *arms.shape[1:]))
    np.multiply(arms, change.T[:, None, :], out=steps[:-1])
    against: Array = np.cumsum(steps[::-1], axis=0)[::-1]
    return against


def arm_lengths(placed: Placed) -> Array:
    """How far a point of a body is from the axis of a joint at most, (n, M, P) [m]; 1 of a joint that slides, 0 of one that doesn't move the body."""
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
        arm = placed.middle[moved] - point
        away = np.cross(arm, axis)
        radius = np.sqrt(np.einsum("bpi,bpi->bp", away, away)) + scene.boxes.bound[moved, None]
        # a screw of some pitch slides as well
        slide = abs(float(angular @ linear)) / rate
        arms[joint, moved] = np.hypot(radius * rate, slide)
    return arms


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
