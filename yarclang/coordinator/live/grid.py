"""Control points of a uniform cubic B-spline from wanted joint velocities, with bounded velocity,
acceleration and jerk.

With control points c at the grid's times, v[k] = (c[k] - c[k-1]) / h, a[k] = (v[k] - v[k-1]) / h, j[k] =
(a[k] - a[k-1]) / h. The executed velocity lies in the convex hull of these v, its acceleration between these
a, and its jerk is these j. So limits on v, a and j are limits on the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.robot.model import Array

_STILL = 1e-9
"""Velocity that counts as zero [rad/s or m/s]."""

_LONGEST = 2000
"""Maximum number of points of a way to rest."""


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """The largest velocity, acceleration and jerk of each joint (n,) that are used [rad or m, s]."""

    velocity: Array
    acceleration: Array
    jerk: Array


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """The last control point and its differences: `c` (n,) [rad or m], `v` and `a` (n,) per s and per s^2."""

    c: Array
    v: Array
    a: Array

    @staticmethod
    def at_rest(q: Array) -> State:
        """Return the state of standing at joint positions (n,) [rad or m]."""
        nothing = np.zeros(len(q))
        return State(q, nothing, nothing)

    @property
    def rests(self) -> bool:
        """Return True if nothing moves any more."""
        return not (self.v.any() or self.a.any())


def advance(state: State, wanted: Array, rates: Rates, h: float) -> State:
    """Compute the next control point.

    All joints change their velocities together, so that a change keeps the direction of the motion; each
    joint reaches its target velocity without overshoot.

    Args:
        state: last state.
        wanted: (n,) joint velocities [rad/s or m/s]; they are clipped to the limits.
        rates: limits.
        h: segment time [s].
    """
    wanted = np.clip(wanted, -rates.velocity, rates.velocity)
    change = wanted - state.v
    way = np.abs(change)
    if way.max() <= _STILL and np.abs(state.a).max() < _STILL:
        # The remaining difference is rounding.
        return State(state.c + h * wanted, wanted, np.zeros_like(wanted))
    moves = way > _STILL
    ways = np.where(moves, way, 1.0)
    # The slowest joint limits the rate at which all joints change.
    acceleration = np.where(
        moves, ways * np.where(moves, rates.acceleration / ways, np.inf).min(), rates.acceleration
    )
    jerk = np.where(moves, ways * np.where(moves, rates.jerk / ways, np.inf).min(), rates.jerk)
    # In units of one jerk step (jerk h): an acceleration of x that falls by one per step changes the velocity
    # by x n - n (n - 1) / 2 in n steps. `aim` is the x with which n steps make exactly the remaining change.
    gain = way / (jerk * h * h)
    n = np.maximum(np.ceil((np.sqrt(1.0 + 8.0 * gain) - 1.0) / 2.0 - 1e-9), 1.0)
    aim = np.minimum((gain / n + (n - 1.0) / 2.0) * jerk * h, acceleration)
    # The acceleration rises as fast as the slowest joint allows, and falls as fast as possible.
    side = np.where(change < 0.0, -1.0, 1.0)
    before, full, rise = side * state.a, rates.jerk * h, jerk * h
    against = before < 0.0
    # Accelerations in the opposite direction end for all joints at once: otherwise the direction would change
    # meanwhile.
    strong = np.where(against, -before, _STILL)
    unwound = strong * (full / np.maximum(strong, _STILL)).min()
    # Except for a joint that would overshoot its velocity meanwhile.
    steps = np.floor(strong / unwound)
    gained = h * (steps * strong - unwound * steps * (steps + 1.0) / 2.0)
    unwound = np.where(gained - side * state.v > rates.velocity, full, unwound)
    most = np.where(against, np.maximum(np.minimum(before + unwound, rise), before + rise), before + rise)
    a = side * np.clip(np.clip(aim, before - full, most), -rates.acceleration, rates.acceleration)
    v = state.v + h * a
    return State(state.c + h * v, v, a)


def to_rest(state: State, rates: Rates, h: float) -> tuple[State, ...]:
    """Compute the states up to one at rest, as soon as the limits allow.

    Args:
        state: last state.
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
