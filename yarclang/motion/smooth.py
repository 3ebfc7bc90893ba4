"""Approximate joint positions along a line or an arc by one polynomial. Inverse kinematics is solved only at
a few places; the polynomial gives the joint positions at all others.

Except at singularities, the joint positions of an arm are analytic functions of the place on such a path.
Their Chebyshev interpolation therefore converges geometrically. On a short line, 16 places determine all
others to the last digits (Trefethen, Approximation Theory and Approximation Practice, ch. 8). Forward
kinematics checks the polynomial between these places, and an inaccurate polynomial isn't used.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath, joints_of
from yarclang.motion.paths.arc import Arc
from yarclang.motion.paths.line import Line, poses_along
from yarclang.robot.kinematics.fk import walk
from yarclang.robot.kinematics.inverse import extent
from yarclang.robot.kinematics.numeric import misses, pose_columns

MANY = 64
"""Number of places on a path from which on a polynomial is used. For fewer places, inverse kinematics is
solved at each.
"""

_DEGREES = (15, 39)
"""The degrees of polynomials that are tried, one after the other."""

_EXACT = 1e-12
"""Largest deviation of an accurate polynomial from the path, at places between the solved ones [m or rad]."""

_AT_ONCE = 8_192
"""Number of places at which a polynomial is evaluated together."""


@frozen(eq=False)
class Smooth:
    """The joint positions along a path as a polynomial over s from 0 to 1.

    `coefficients` (d + 1, n) are those of the Chebyshev polynomials of 1 - 2 s [rad or m]. `lever` [m] is an
    upper bound of the distance of the moving frame's origin from any joint's axis. `is_sliding` (n,) is 1 for
    prismatic joints.
    """

    coefficients: Array
    lever: float
    is_sliding: Array

    def at(self, s: Array) -> Array:
        """Return joint positions (N, n) at `s` (N,)."""
        parts = [
            _chebyshev(s[begin : begin + _AT_ONCE], len(self.coefficients)).T @ self.coefficients
            for begin in range(0, len(s), _AT_ONCE)
        ]
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Return upper bounds of the distance of the moving frame from the path at given joint positions.

        Args:
            q: (N, n) joint positions [rad or m].
            s: (N,) the place on the path for each joint position.

        Returns:
            Upper bounds of the distance [m] and of the angle [rad].
        """
        # If a joint is off by an angle, the frame is off by at most the lever times this angle.
        off = np.abs(q - self.at(s))
        turn = off @ (1.0 - self.is_sliding)
        return float((self.lever * turn + off @ self.is_sliding).max()), float(turn.max())


def smooth(paths: Sequence[CartesianPath]) -> list[Smooth | None]:
    """Return the joint positions along paths of one arm and one moving frame as polynomials; None for a path
    without a polynomial.
    """
    polynomials: list[Smooth | None] = [None] * len(paths)
    missing = [place for place, path in enumerate(paths) if isinstance(path.frame, Line | Arc)]
    for degree in _DEGREES:
        if not missing:
            break
        for place, one in zip(missing, _of_degree(degree, [paths[place] for place in missing]), strict=True):
            polynomials[place] = one
        missing = [place for place in missing if polynomials[place] is None]
    return polynomials


def _of_degree(degree: int, paths: Sequence[CartesianPath]) -> list[Smooth | None]:
    """Return the joint positions along each path as a polynomial of the given degree; None if this polynomial
    isn't accurate enough.
    """
    places, between, to_coefficients, to_between = _nodes(degree)
    chain, tool = paths[0].chain, paths[0].flange_from_moving
    values = np.array(joints_of(paths, [places] * len(paths)))
    # Check the polynomial between the nodes, where its error is largest, by forward kinematics.
    looked_at = np.matmul(to_between, values)
    poses = _poses(paths, between)
    columns = walk(chain, np.ascontiguousarray(looked_at.reshape(-1, chain.size).T), tool)[0]
    position, angle = misses(columns, pose_columns(poses))
    worst = np.maximum(position, angle).reshape(len(paths), -1).max(axis=1)
    lever = extent(chain) + float(np.linalg.norm(tool[:3, 3]))
    sliding = chain.is_prismatic.astype(float)
    return [
        Smooth(coefficients, lever, sliding) if miss < _EXACT else None
        for coefficients, miss in zip(np.matmul(to_coefficients, values), worst, strict=True)
    ]


def _poses(paths: Sequence[CartesianPath], s: Array) -> Array:
    """Return the poses base_from_moving (M * N, 4, 4) along each of M paths, at the places `s` (N,)."""
    lines = [path.frame for path in paths if isinstance(path.frame, Line)]
    if len(lines) == len(paths):
        return poses_along(lines, s).reshape(-1, 4, 4)
    return np.concatenate([path.frame.poses(s) for path in paths])


@cache
def _nodes(degree: int) -> tuple[Array, Array, Array, Array]:
    """Return Chebyshev nodes, places between them, and matrices for values at the nodes.

    Returns:
        The nodes, at which inverse kinematics is solved; the places between them, for checks; the matrix from
        values at the nodes to coefficients; and the matrix from values at the nodes to values at the places
        between.
    """
    count = degree + 1
    # The nodes are the roots of the Chebyshev polynomial of degree `count`. The places between them are its
    # extremes.
    places = (1.0 - np.cos(np.pi * (np.arange(count) + 0.5) / count)) / 2.0
    between = (1.0 - np.cos(np.pi * np.arange(count + 1) / count)) / 2.0
    # Chebyshev polynomials are orthogonal at their roots.
    to_coefficients = _chebyshev(places, count) * (2.0 / count)
    to_coefficients[0] /= 2.0
    return places, between, to_coefficients, _chebyshev(between, count).T @ to_coefficients


def _chebyshev(s: Array, count: int) -> Array:
    """Return the values of the first `count` Chebyshev polynomials of 1 - 2 s, (count, N), at the places
    `s` (N,).
    """
    x = 1.0 - 2.0 * s
    polynomials = np.empty((count, len(s)))
    polynomials[0], polynomials[1] = 1.0, x
    # Recurrence T(n + 1) = 2 x T(n) - T(n - 1).
    twice = 2.0 * x
    for number in range(2, count):
        np.multiply(twice, polynomials[number - 1], out=polynomials[number])
        polynomials[number] -= polynomials[number - 2]
    return polynomials
