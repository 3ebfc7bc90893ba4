"""Convert joint positions to motor counts and back (the paper's eq. 5)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.robot.model import Array, Robot


@lru_cache(maxsize=64)
def counts_per_joint(robot: Robot) -> Array:
    """Return the matrix that converts joint positions [rad or m] to motor counts: the product of the gear
    ratios and the coupling matrix of the robot's `Actuation`, in SI instead of axis units.

    Returns:
        (n, n), read-only: entry (i, j) is the change of motor i [counts] per rad (or m) of joint j.
    """
    actuation = robot.actuation
    matrix: Array = actuation.gear[:, None] * actuation.coupling / robot.axis_units[None, :]
    matrix.setflags(write=False)
    return matrix


@lru_cache(maxsize=64)
def joints_per_count(robot: Robot) -> Array:
    """Return the inverse of the matrix `counts_per_joint`, as (n, n) [rad or m per count], read-only."""
    inverse = np.linalg.inv(counts_per_joint(robot)).astype(np.float64)
    inverse.setflags(write=False)
    return inverse


def to_counts(robot: Robot, q: Array) -> Array:
    """Return the motor positions (..., n) [counts] of joint positions `q` (..., n) [rad or m]."""
    counts: Array = q @ counts_per_joint(robot).T + robot.actuation.offset
    return counts


def from_counts(robot: Robot, counts: Array) -> Array:
    """Return the joint positions (..., n) [rad or m] of motor positions `counts` (..., n)."""
    q: Array = (counts - robot.actuation.offset) @ joints_per_count(robot).T
    return q
