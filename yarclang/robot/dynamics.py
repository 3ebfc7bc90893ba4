"""Torques of a moving arm, at many instants at once (recursive Newton-Euler; Featherstone, Rigid Body Dynamics Algorithms, ch. 5).

Rigid bodies alone: no friction, no motors' rotors, no springs. Everything is expressed at the origin of {B}, with the instants as the last index, so that a
step is a few operations on whole rows.
"""

from __future__ import annotations

import numpy as np

from yarclang.robot.kinematics.fk import skew
from yarclang.robot.model import Array, Chain, Dynamics

BLOCK = 2048
"""Instants in one block: the arrays of a step stay in the processor's cache."""


def torques(chain: Chain, dynamics: Dynamics, q: Array, v: Array, a: Array) -> Array:
    """What the motors have to give.

    Args:
        chain: the arm.
        dynamics: its masses.
        q: (P, n) joint positions [rad or m]; `v` their velocities and `a` their accelerations.
        v: (P, n).
        a: (P, n).

    Returns:
        (P, n) torques of turning joints [N m], forces of sliding ones [N].
    """
    found = np.empty(q.shape)
    for start in range(0, len(q), BLOCK):
        rows = slice(start, start + BLOCK)
        found[rows] = _torques(chain, dynamics, *(np.ascontiguousarray(one[rows].T) for one in (q, v, a))).T
    return found


def holding_torques(chain: Chain, dynamics: Dynamics, q: Array) -> Array:
    """What the motors have to give (P, n) where the arm stands still: against gravity alone."""
    still = np.zeros_like(q)
    return torques(chain, dynamics, q, still, still)


def _torques(chain: Chain, dynamics: Dynamics, q: Array, v: Array, a: Array) -> Array:
    """The same with the instants last, (n, P)."""
    size, count = q.shape
    turn = np.broadcast_to(np.eye(3)[:, :, None], (3, 3, count))
    shift = np.zeros((3, count))
    # how fast the arm turns, how fast its point in the origin of {B} goes, and how both change
    spin, slide, spin_rate, slide_rate = (np.zeros((3, count)) for _ in range(4))
    slide_rate -= dynamics.gravity[:, None]
    axes, sides = np.empty((size, 3, count)), np.empty((size, 3, count))
    forces, moments = np.empty((size, 3, count)), np.empty((size, 3, count))
    for joint in range(size):
        linear, angular = chain.screws[joint, :3], chain.screws[joint, 3:]
        axis = np.tensordot(angular, turn, (0, 1))
        side = np.tensordot(linear, turn, (0, 1)) + _cross(shift, axis)
        axes[joint], sides[joint] = axis, side
        rate = v[joint]
        spin_rate = spin_rate + a[joint] * axis + rate * _cross(spin, axis)
        slide_rate = slide_rate + a[joint] * side + rate * (_cross(spin, side) + _cross(slide, axis))
        spin, slide = spin + rate * axis, slide + rate * side
        turn, shift = _moved(turn, shift, chain.screws[joint], q[joint])
        center = np.tensordot(dynamics.center[joint], turn, (0, 1)) + shift
        way = slide + _cross(spin, center)
        force = dynamics.mass[joint] * (slide_rate + _cross(spin_rate, center) + _cross(spin, way))
        momentum, change = (
            np.einsum("ijp,jp->ip", turn, dynamics.inertia[joint] @ np.einsum("jip,jp->ip", turn, one))
            for one in (spin, spin_rate)
        )
        forces[joint] = force
        moments[joint] = change + _cross(spin, momentum) + _cross(center, force)
    # each joint moves all that is behind it
    force, moment = (np.cumsum(one[::-1], axis=0)[::-1] for one in (forces, moments))
    found: Array = (axes * moment).sum(axis=1) + (sides * force).sum(axis=1)
    return found


def _moved(turn: Array, shift: Array, screw: Array, q: Array) -> tuple[Array, Array]:
    """Where the bodies behind a joint are: exp(screw q) behind what the joints before do."""
    linear, angular = screw[:3], screw[3:]
    w = skew(angular)
    sin, versine = np.sin(q), 1.0 - np.cos(q)
    parts = np.stack([linear, w @ linear, w @ w @ linear])
    way = np.tensordot(parts, turn, (1, 1))  # (3, 3, P): a part, along an axis
    shift = shift + way[0] * q + way[1] * versine + way[2] * (q - sin)
    first, second = (np.einsum("ijp,jk->ikp", turn, one) for one in (w, w @ w))
    return turn + first * sin + second * versine, shift


def _cross(one: Array, other: Array) -> Array:
    """The cross products of (3, P) and (3, P)."""
    return np.stack(
        [
            one[1] * other[2] - one[2] * other[1],
            one[2] * other[0] - one[0] * other[2],
            one[0] * other[1] - one[1] * other[0],
        ]
    )
