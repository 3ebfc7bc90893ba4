"""Wanted joint velocities to control points of a uniform cubic B-spline, with bounded velocity, acceleration and jerk.

With control points c at the grid's times, v = (c[k] - c[k-1]) / h, a = (v[k] - v[k-1]) / h, j = (a[k] - a[k-1]) / h. The executed velocity lies in the convex hull of
these v, its acceleration between these a, and its jerk is these j: limits that they keep, the motion keeps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.robot.model import Array

_STILL = 1e-9
"""A velocity [rad/s or m/s] that is none."""

_LONGEST = 2000
"""Points of a way to rest at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """The largest velocity, acceleration and jerk of each joint (n,) [rad or m, s] that are used."""

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
        """Standing at joint positions (n,) [rad or m]."""
        nothing = np.zeros(len(q))
        return State(q, nothing, nothing)

    @property
    def rests(self) -> bool:
        """Whether nothing moves any more."""
        return not (self.v.any() or self.a.any())


def advance(state: State, wanted: Array, rates: Rates, h: float) -> State:
    """One more control point.

    All joints change their velocities together, so that a change keeps the direction of a motion; each reaches what is wanted without going past it.

    Args:
        state: the last one.
        wanted: (n,) joint velocities; they are cut to the limits.
        rates: limits.
        h: the segment time [s].
    """
    wanted = np.clip(wanted, -rates.velocity, rates.velocity)
    change = wanted - state.v
    way = np.abs(change)
    if way.max() <= _STILL and np.abs(state.a).max() < _STILL:
        # what is left is rounding
        return State(state.c + h * wanted, wanted, np.zeros_like(wanted))
    moves = way > _STILL
    ways = np.where(moves, way, 1.0)
    # the joint that takes longest says how fast all of them change
    acceleration = np.where(
        moves, ways * np.where(moves, rates.acceleration / ways, np.inf).min(), rates.acceleration
    )
    jerk = np.where(moves, ways * np.where(moves, rates.jerk / ways, np.inf).min(), rates.jerk)
    # from an acceleration of x jerks on, falling by one each step, n steps gain x n - n (n - 1) / 2
    gain = way / (jerk * h * h)
    n = np.maximum(np.ceil((np.sqrt(1.0 + 8.0 * gain) - 1.0) / 2.0 - 1e-9), 1.0)
    aim = np.minimum((gain / n + (n - 1.0) / 2.0) * jerk * h, acceleration)
    # it rises as fast as the slowest joint lets it, and falls as fast as it can
    side = np.where(change < 0.0, -1.0, 1.0)
    before, full, rise = side * state.a, rates.jerk * h, jerk * h
    against = before < 0.0
    # what still leads the other way ends for all joints at once: else the direction would change meanwhile
    strong = np.where(against, -before, _STILL)
    unwound = strong * (full / np.maximum(strong, _STILL)).min()
    # but for one that would go past its velocity meanwhile
    steps = np.floor(strong / unwound)
    gained = h * (steps * strong - unwound * steps * (steps + 1.0) / 2.0)
    unwound = np.where(gained - side * state.v > rates.velocity, full, unwound)
    most = np.where(against, np.maximum(np.minimum(before + unwound, rise), before + rise), before + rise)
    a = side * np.clip(np.clip(aim, before - full, most), -rates.acceleration, rates.acceleration)
    v = state.v + h * a
    return State(state.c + h * v, v, a)


def to_rest(state: State, rates: Rates, h: float) -> tuple[State, ...]:
    """The states up to one that rests, as soon as the limits allow."""
    nothing = np.zeros_like(state.c)
    states: list[State] = []
    while not state.rests:
        if len(states) == _LONGEST:
            raise AssertionError("a motion that doesn't come to rest: a bug")
        state = advance(state, nothing, rates, h)
        states.append(state)
    return tuple(states)
