"""The judge's conversion between motor counts and joint positions.

counts = K J q + a0, with the gear ratios K, the coupling J of the joints to the motors, the joint positions q
[deg or mm], and the motors' offsets a0.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.robot.model import Array, Robot

_DEGREE = np.pi / 180.0
_MILLIMETRE = 1e-3


@lru_cache(maxsize=64)
def counts_per_joint(robot: Robot) -> Array:
    """Return the counts that each motor (row) moves per rad or m of each joint (column), (n, n).

    The array is read-only.
    """
    actuation, size = robot.actuation, robot.size
    counts = np.empty((size, size))
    for motor in range(size):
        for joint in range(size):
            unit = _MILLIMETRE if not robot.chain.screws[joint, 3:].any() else _DEGREE
            counts[motor, joint] = actuation.gear[motor] * actuation.coupling[motor, joint] / unit
    counts.setflags(write=False)
    return counts


@lru_cache(maxsize=64)
def joints_per_count(robot: Robot) -> Array:
    """Return the rad or m that each joint (row) moves per count of each motor (column), (n, n), read-only."""
    size = robot.size
    found = np.asarray(np.linalg.solve(counts_per_joint(robot), np.eye(size)), dtype=np.float64)
    found.setflags(write=False)
    return found


def from_counts(robot: Robot, counts: Array) -> Array:
    """Return the joint positions (..., n) [rad or m] for motor positions (..., n) [counts]."""
    found: Array = (counts - robot.actuation.offset) @ joints_per_count(robot).T
    return found
