"""How far joint motions are from what they ask for: straight lines in joint space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.motion.bounds import reaches, segment_max
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot, Tolerance


def joint_weights(robot: Robot, tolerance: Tolerance) -> Array:
    """One over the tolerance of each joint (n,) [1/rad or 1/m]."""
    return 1.0 / np.where(robot.chain.is_prismatic, tolerance.position, tolerance.angle)


def by_kind(deviations: Array, robot: Robot) -> tuple[float, float]:
    """The largest entry of the prismatic joints [m] and of the revolute joints [rad] of `deviations` (n,)."""
    prismatic = robot.chain.is_prismatic
    return float(deviations[prismatic].max(initial=0.0)), float(deviations[~prismatic].max(initial=0.0))


@frozen(eq=False)
class JointLines:
    """C straight lines in joint space, from `start` to `goal` (C, n) [rad or m].

    `free` (C, 2) says whether the line is joined, and left, elsewhere than at its start and its end.
    """

    start: Array
    goal: Array
    free: NDArray[np.bool_]


def straight_deviations(
    control: Array, first: NDArray[np.int64], lines: JointLines, robot: Robot, tolerance: Tolerance
) -> tuple[Array, Array]:
    """Proved bounds of the deviation from straight lines in joint space.

    Every point of the motion is a convex combination of control points S + s_i D + r_i. At any instant it
    is the point S + s D of the line, with s the same combination of the s_i, plus the same combination
    of the residuals r_i: at most max |r_i|. The s_i are kept in [0, 1], never go back (a
    spline with growing control points grows) and end with 1, so the bound holds in order of time and
    for all of the line; where the motion flows on, for what of the line lies between its first and its last s.

    Args:
        control: (G, n) control points of C commands, one command behind the other, [rad or m].
        first: (C,) the first control point of each.
        lines: the programmed paths.
        robot: the arm.
        tolerance: by which the joints are weighed in the projection.

    Returns:
        (C, n) the largest deviation of each joint [rad or m], and (C, 2) the shares between which the line was followed.
    """
    owner = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(control))))
    last = np.append(first[1:], len(control)) - 1
    weights = joint_weights(robot, tolerance)
    start, free = lines.start, lines.free
    way = (lines.goal - start) * weights
    norm = np.einsum("ni,ni->n", way, way)
    norm[norm == 0.0] = np.inf
    s = np.einsum("ni,ni->n", (control - start[owner]) * weights, way[owner]) / norm[owner]
    s = np.clip(s, 0.0, 1.0)
    s[last[~free[:, 1]]] = 1.0
    for begin, stop in zip(first.tolist(), (last + 1).tolist(), strict=True):
        np.maximum.accumulate(s[begin:stop], out=s[begin:stop])
    residual = np.abs(control - start[owner] - s[:, None] * (lines.goal - start)[owner])
    covered = np.tile([0.0, 1.0], (len(first), 1))
    joined, left = np.flatnonzero(free[:, 0]), np.flatnonzero(free[:, 1])
    covered[joined, 0] = _knot(s, first[joined])
    covered[left, 1] = _knot(s, last[left] - 2)
    return segment_max(residual, first), covered


def _knot(s: Array, at: NDArray[np.int64]) -> Array:
    """The value of the B-spline with the control values `s` at the knots of the points `at` to `at` + 2."""
    value: Array = (s[at] + 4.0 * s[at + 1] + s[at + 2]) / 6.0
    return value


def frame_off(off: Array, flange_from_moving: Array, travel: Array, robot: Robot) -> float:
    """How far a frame on the flange can be from where it should be [m], while the joints are off by up to `off` (n,) [rad or m].

    Each revolute joint moves it by no more than its reach times its angle; `travel` (n,) is the largest |q| of prismatic joints [m].
    """
    reach = reaches(robot.chain, flange_from_moving, travel + off)
    return float(np.where(robot.chain.is_prismatic, 1.0, reach) @ off)
