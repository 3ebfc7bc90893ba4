"""Deviations of motions along straight lines in joint space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.motion.bounds import reaches, segment_max
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot, Tolerance


def joint_weights(robot: Robot, tolerance: Tolerance) -> Array:
    """Return the reciprocal of each joint's tolerance (n,) [1/rad or 1/m]."""
    return 1.0 / np.where(robot.chain.is_prismatic, tolerance.position, tolerance.angle)


def by_kind(deviations: Array, robot: Robot) -> tuple[float, float]:
    """Return the largest deviation among the prismatic joints [m], and the largest among the revolute joints
    [rad], for deviations (n,) of all joints.
    """
    prismatic = robot.chain.is_prismatic
    return float(deviations[prismatic].max(initial=0.0)), float(deviations[~prismatic].max(initial=0.0))


@frozen(eq=False)
class JointLines:
    """C straight lines in joint space.

    Attributes:
        start: (C, n) start points [rad or m].
        goal: (C, n) goals [rad or m].
        free: (C, 2) True in the first column if a blend joins the line after its start, and in the second
            column if a blend leaves it before its end.
    """

    start: Array
    goal: Array
    free: NDArray[np.bool_]


def straight_deviations(
    control: Array, first: NDArray[np.int64], lines: JointLines, robot: Robot, tolerance: Tolerance
) -> tuple[Array, Array]:
    """Bound the deviation of joint motions from straight lines in joint space.

    The control points are S + s_i D + r_i, with the start S, the vector D to the goal, and residuals r_i.
    Every point of the motion is a convex combination of control points. At any instant it is therefore the
    point S + s D of the line, with s a combination of the s_i, plus a combination of the r_i, which is at
    most max |r_i|. The s_i are clipped to [0, 1], begin with 0, never decrease and end with 1, and a spline
    with growing control points grows. The bound is therefore one of the Frechet distance: it compares motion
    and line in order of time, and covers the whole line. If a motion flows into the next one, the bound is
    valid for the part of the line between the first and the last s.

    Args:
        control: (G, n) control points of C commands, one command after the other [rad or m].
        first: (C,) index of each command's first control point.
        lines: the programmed paths.
        robot: the arm.
        tolerance: tolerances of the joints, whose reciprocals are weights in the projection onto the lines.

    Returns:
        The largest deviation of each joint (C, n) [rad or m], and the range of each line's parameter that was
        followed (C, 2).
    """
    owner = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(control))))
    last = np.append(first[1:], len(control)) - 1
    weights = joint_weights(robot, tolerance)
    start, free = lines.start, lines.free
    # Project the control points onto the lines, with each joint measured in units of its tolerance.
    way = (lines.goal - start) * weights
    norm = np.einsum("ni,ni->n", way, way)
    norm[norm == 0.0] = np.inf
    s = np.einsum("ni,ni->n", (control - start[owner]) * weights, way[owner]) / norm[owner]
    s = np.clip(s, 0.0, 1.0)
    s[first[~free[:, 0]]] = 0.0
    s[last[~free[:, 1]]] = 1.0
    # Replace each s_i by the largest so far, so that the motion follows the line in order; the residuals are
    # measured from these points of the line.
    for begin, stop in zip(first.tolist(), (last + 1).tolist(), strict=True):
        np.maximum.accumulate(s[begin:stop], out=s[begin:stop])
    residual = np.abs(control - start[owner] - s[:, None] * (lines.goal - start)[owner])
    covered = np.tile([0.0, 1.0], (len(first), 1))
    # The motion joins and leaves the line at the motion's first and last knot.
    joined, left = np.flatnonzero(free[:, 0]), np.flatnonzero(free[:, 1])
    covered[joined, 0] = _knot(s, first[joined])
    covered[left, 1] = _knot(s, last[left] - 2)
    return segment_max(residual, first), covered


def _knot(s: Array, at: NDArray[np.int64]) -> Array:
    """Return the values at knots of the cubic B-spline with control values `s`.

    The value at a knot depends on the control values `at` to `at` + 2.
    """
    value: Array = (s[at] + 4.0 * s[at + 1] + s[at + 2]) / 6.0
    return value


def frame_off(off: Array, flange_from_moving: Array, travel: Array, robot: Robot) -> float:
    """Bound the distance [m] by which a frame moves if the joints deviate.

    Each revolute joint moves the frame by at most the frame's reach times the joint's deviation.

    Args:
        off: (n,) largest deviations of the joints [rad or m].
        flange_from_moving: (4, 4) frame, relative to the flange.
        travel: (n,) largest distance of each prismatic joint from zero [m].
        robot: the arm.
    """
    reach = reaches(robot.chain, flange_from_moving, travel + off)
    return float(np.where(robot.chain.is_prismatic, 1.0, reach) @ off)
