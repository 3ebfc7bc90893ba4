"""From joint positions to motor counts and back (the paper's eq. 5)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.robot.model import Array, Robot


@lru_cache(maxsize=64)
def counts_per_joint(robot: Robot) -> Array:
    """The matrix K J for joints in SI.

    Returns:
        (n, n): counts of motor row per rad (or m) of joint column; it can't be written to.
    """
    actuation = robot.actuation
    matrix: Array = actuation.gear[:, None] * actuation.coupling / robot.axis_units[None, :]
    matrix.setflags(write=False)
    return matrix


@lru_cache(maxsize=64)
def joints_per_count(robot: Robot) -> Array:
    """The inverse of `counts_per_joint` (n, n), made from the same matrix; it can't be written to."""
    inverse = np.linalg.inv(counts_per_joint(robot)).astype(np.float64)
    inverse.setflags(write=False)
    return inverse


def to_counts(robot: Robot, q: Array) -> Array:
    """Motor positions [counts] of joint positions `q` (..., n) [rad or m]."""
    counts: Array = q @ counts_per_joint(robot).T + robot.actuation.offset
    return counts


def from_counts(robot: Robot, counts: Array) -> Array:
    """Joint positions [rad or m] of motor positions `counts` (..., n)."""
    q: Array = (counts - robot.actuation.offset) @ joints_per_count(robot).T
    return q
