"""Compute the polynomials with which drivers interpolate between waypoints, and bound the values of
polynomials, such as the difference between an interpolation and the executed path.

The joint_trajectory_controller of ros_control joins waypoints by straight lines if they have only positions,
by cubics if they also have velocities, and by quintics if they also have accelerations (ros_controllers and
ros2_controllers, `sampleSplineWithTimeBounds` and `interpolate_between_points`). All these polynomials have
degree 5 or less. Their differences from the executed cubic polynomial therefore also have degree 5 or less.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from yarclang.robot.model import Array

Interpolation = Literal["linear", "cubic", "quintic"]

State = tuple[Array, Array, Array]
"""Positions, velocities and accelerations, (N, n) each."""


def coefficients(kind: Interpolation, first: State, second: State, length: Array) -> Array:
    """Return the coefficients of the polynomials that interpolate between pairs of waypoints.

    Args:
        kind: kind of the interpolation.
        first: waypoints at the starts of the polynomials.
        second: waypoints at their ends.
        length: (N,) time between the waypoints [s].

    Returns:
        (6, N, n) coefficients of the powers of the time since the first waypoint [s].
    """
    t = length[:, None]
    (x0, v0, a0), (x1, v1, a1) = first, second
    none = np.zeros_like(x0)
    slope = (x1 - x0) / t
    if kind == "linear":
        return np.stack((x0, slope, none, none, none, none))
    if kind == "cubic":
        return np.stack(
            (x0, v0, (3.0 * slope - 2.0 * v0 - v1) / t, (v0 + v1 - 2.0 * slope) / t**2, none, none)
        )
    rise = x1 - x0 - t * (v0 + t * a0 / 2.0)
    gain, more = t * (v1 - v0 - t * a0), t**2 * (a1 - a0)
    return np.stack(
        (
            x0,
            v0,
            a0 / 2.0,
            (10.0 * rise - 4.0 * gain + more / 2.0) / t**3,
            (-15.0 * rise + 7.0 * gain - more) / t**4,
            (6.0 * rise - 3.0 * gain + more / 2.0) / t**5,
        )
    )


def values(powers: Array, offset: Array) -> State:
    """Return the values and the first two derivatives of polynomials.

    Args:
        powers: (6, N, n) coefficients.
        offset: (N,) times [s].
    """
    t = offset[:, None]
    c0, c1, c2, c3, c4, c5 = powers
    return (
        c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5)))),
        c1 + t * (2.0 * c2 + t * (3.0 * c3 + t * (4.0 * c4 + t * 5.0 * c5))),
        2.0 * c2 + t * (6.0 * c3 + t * (12.0 * c4 + t * 20.0 * c5)),
    )


def largest(first: State, second: State, length: Array, halvings: int) -> Array:
    """Bound the absolute values of polynomials of degree 5 or less on intervals.

    Such a polynomial is given by its value and two derivatives at both ends, and is within the convex hull of
    its Bernstein coefficients. When an interval is halved, the distance of the hull from the polynomial
    falls to about a quarter.

    Args:
        first: values and derivatives at the starts (N, n).
        second: values and derivatives at the ends (N, n).
        length: (N,) durations of the intervals [s].
        halvings: number of halvings of each interval.

    Returns:
        (N, n) bounds.
    """
    t = length[:, None]
    (e0, d0, dd0), (e1, d1, dd1) = first, second
    pieces: Sequence[Array] = [
        np.stack(
            (
                e0,
                e0 + t * d0 / 5.0,
                e0 + t * (2.0 * d0 / 5.0 + t * dd0 / 20.0),
                e1 + t * (-2.0 * d1 / 5.0 + t * dd1 / 20.0),
                e1 - t * d1 / 5.0,
                e1,
            )
        )
    ]
    for _ in range(halvings):
        pieces = [half for piece in pieces for half in _halves(piece)]
    bound: Array = np.abs(pieces[0]).max(axis=0)
    for piece in pieces[1:]:
        np.maximum(bound, np.abs(piece).max(axis=0), out=bound)
    return bound


def _halves(piece: Array) -> tuple[Array, Array]:
    """Return the Bernstein coefficients (6, N, n) of both halves of intervals (de Casteljau's algorithm)."""
    left, right = [piece[0]], [piece[-1]]
    while len(piece) > 1:
        piece = (piece[:-1] + piece[1:]) / 2.0
        left.append(piece[0])
        right.append(piece[-1])
    return np.stack(left), np.stack(right[::-1])
