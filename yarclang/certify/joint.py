"""How far joint motions are from what they ask for: straight lines in joint space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.bounds import segment_max
from yarclang.robot.model import Array, Robot, Tolerance


def joint_weights(robot: Robot, tolerance: Tolerance) -> Array:
    """One over the tolerance of each joint (n,) [1/rad or 1/m]."""
    return 1.0 / np.where(robot.chain.is_prismatic, tolerance.position, tolerance.angle)


def by_kind(deviations: Array, robot: Robot) -> tuple[float, float]:
    """The largest entry of the prismatic joints [m] and of the revolute joints [rad] of `deviations` (n,)."""
    prismatic = robot.chain.is_prismatic
    return float(deviations[prismatic].max(initial=0.0)), float(deviations[~prismatic].max(initial=0.0))


def straight_deviations(
    control: Array, first: NDArray[np.int64], goals: Array, robot: Robot, tolerance: Tolerance
) -> Array:
    """Proved bounds of the deviation from straight lines in joint space.

    Every point of the motion is a convex combination of control points S + s_i D + r_i. At any instant it
    is the point S + s D of the line, with s the same combination of the s_i, plus the same combination
    of the residuals r_i: at most max |r_i|. The s_i are kept in [0, 1], never go back (a
    spline with growing control points grows) and end with 1, so the bound holds in order of time and
    for all of the line.

    Args:
        control: (G, n) control points of C commands, one command behind the other, [rad or m].
        first: (C,) the first control point of each: where the robot stands.
        goals: (C, n) the ends of the lines.
        robot: the arm.
        tolerance: by which the joints are weighed in the projection.

    Returns:
        (C, n) the largest deviation of each joint [rad or m].
    """
    owner = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(control))))
    weights = joint_weights(robot, tolerance)
    start = control[first]
    way = (goals - start) * weights
    norm = np.einsum("ni,ni->n", way, way)
    norm[norm == 0.0] = np.inf
    s = np.einsum("ni,ni->n", (control - start[owner]) * weights, way[owner]) / norm[owner]
    lift = 2.0 * owner
    s = np.clip(s, 0.0, 1.0)
    s[np.append(first[1:], len(s)) - 1] = 1.0
    s = np.maximum.accumulate(s + lift) - lift
    residual = np.abs(control - start[owner] - s[:, None] * (goals - start)[owner])
    return segment_max(residual, first)
