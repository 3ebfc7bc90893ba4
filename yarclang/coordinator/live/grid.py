"""Computation of control points of a uniform cubic B-spline from wanted joint velocities, with limited
velocity, acceleration and jerk.

With control points c at intervals of h, the differences are v[k] = (c[k] - c[k-1]) / h, a[k] = (v[k] -
v[k-1]) / h and j[k] = (a[k] - a[k-1]) / h. By the convex hull property of B-splines and their derivatives,
the velocity of the motion is in the convex hull of these v, its acceleration is between these a, and its jerk
is these j. So limits on v, a and j are limits on the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.robot.model import Array

_STILL = 1e-9
"""Largest velocity that counts as zero [rad/s or m/s]."""

_LONGEST = 2000
"""Largest number of control points of a motion to rest."""


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """Largest velocity, acceleration and jerk that a live motion may use, each (n,) per joint [rad or m, per
    s, s^2 and s^3].
    """

    velocity: Array
    acceleration: Array
    jerk: Array


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """The last control point `c` (n,) [rad or m], and its first and second differences: the velocity `v` (n,)
    [per s] and the acceleration `a` (n,) [per s^2].
    """

    c: Array
    v: Array
    a: Array

    @staticmethod
    def at_rest(q: Array) -> State:
        """Return the state of a robot that stands at joint positions (n,) [rad or m]."""
        nothing = np.zeros(len(q))
        return State(q, nothing, nothing)

    @property
    def rests(self) -> bool:
        """Return True if velocity and acceleration are zero."""
        return not (self.v.any() or self.a.any())


def advance(state: State, requested: Array, rates: Rates, h: float) -> State:
    """Compute the next control point and its differences.

    All joints finish their changes of velocity at the same time, so that the change keeps its direction in
    joint space. No joint overshoots its requested velocity.

    Args:
        state: last control point and its differences.
        requested: (n,) joint velocities [rad/s or m/s]; they are clipped to the limits.
        rates: limits.
        h: segment time [s].
    """
    requested = np.clip(requested, -rates.velocity, rates.velocity)
    change = requested - state.v
    way = np.abs(change)
    if way.max() <= _STILL and np.abs(state.a).max() < _STILL:
        # Only a rounding error is left, so set the requested velocity exactly.
        return State(state.c + h * requested, requested, np.zeros_like(requested))
    moves = way > _STILL
    ways = np.where(moves, way, 1.0)
    # Scale the limits of all joints to the slowest one, so that all joints need the same time for their
    # changes.
    acceleration = np.where(
        moves, ways * np.where(moves, rates.acceleration / ways, np.inf).min(), rates.acceleration
    )
    jerk = np.where(moves, ways * np.where(moves, rates.jerk / ways, np.inf).min(), rates.jerk)
    # In one step, the acceleration changes by at most jerk h. Take jerk h as the unit of acceleration, and
    # jerk h^2 as that of velocity. If the acceleration begins at x and falls by one per step, the velocity
    # changes by x n - n (n - 1) / 2 in n steps. `aim` is the acceleration from which n such steps make
    # exactly the remaining change.
    gain = way / (jerk * h * h)
    n = np.maximum(np.ceil((np.sqrt(1.0 + 8.0 * gain) - 1.0) / 2.0 - 1e-9), 1.0)
    aim = np.minimum((gain / n + (n - 1.0) / 2.0) * jerk * h, acceleration)
    # The acceleration rises at the common jerk of all joints, which the slowest joint determines. It falls at
    # the joint's own largest jerk.
    side = np.where(change < 0.0, -1.0, 1.0)
    before, full, rise = side * state.a, rates.jerk * h, jerk * h
    against = before < 0.0
    # Accelerations away from the requested velocities are reduced first. They reach zero at the same time in
    # all joints; otherwise the direction of motion would change.
    strong = np.where(against, -before, _STILL)
    unwound = strong * (full / np.maximum(strong, _STILL)).min()
    # Exception: if a joint would exceed its velocity limit before its acceleration is zero, this joint uses
    # its own largest jerk.
    steps = np.floor(strong / unwound)
    gained = h * (steps * strong - unwound * steps * (steps + 1.0) / 2.0)
    unwound = np.where(gained - side * state.v > rates.velocity, full, unwound)
    most = np.where(against, np.maximum(np.minimum(before + unwound, rise), before + rise), before + rise)
    a = side * np.clip(np.clip(aim, before - full, most), -rates.acceleration, rates.acceleration)
    v = state.v + h * a
    return State(state.c + h * v, v, a)


def to_rest(state: State, rates: Rates, h: float) -> tuple[State, ...]:
    """Compute the control points of a motion to rest, as fast as the limits allow. The last one is at rest.

    Args:
        state: last control point before the motion, and its differences.
        rates: limits.
        h: segment time [s].
    """
    nothing = np.zeros_like(state.c)
    states: list[State] = []
    while not state.rests:
        if len(states) == _LONGEST:
            raise AssertionError("a motion that doesn't come to rest: a bug")
        state = advance(state, nothing, rates, h)
        states.append(state)
    return tuple(states)
