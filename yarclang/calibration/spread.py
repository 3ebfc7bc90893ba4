"""What the spread of the touches does: how an error of each touch grows into errors of the tip or the frame, and which touch would help.

Each touch is off by an error of its own, the same in all directions and independent of the others, which is larger than `error` in 5 of 100 touches.
Results are told likewise: the true tip lies outside of the ellipsoid that is told in at most 5 of 100 calibrations.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.transforms import constant, turn_about
from yarclang.units import DEG, MM

ERROR = 0.5 * MM
"""Error of one touch that is assumed as long as the touches themselves tell none: by eye, with a pointed tip."""
LEAST_ERROR = 0.1 * MM
"""Error of one touch that is assumed where touches agree better than an eye sees."""
LARGEST_TIP = 1.5 * MM
"""A tip that is known worse than this along some direction needs other touches."""
LARGEST_TURN = 0.3 * DEG
"""A frame that is turned by more than this about some axis needs points farther apart."""
FAR = 500.0 * MM
"""Distance from a frame's origin at which its error is told."""

_ANGLES = (20.0, 30.0, 45.0)
_TELLING = 6
"""Degrees of freedom from which residuals tell the error of a touch: those of four touches of a tip."""
_SHARE = 0.95
_ASSUMED = 2.7955
"""Radius of the sphere that has this share of a normal distribution in space, in standard deviations along an axis: the root of the chi-square quantile for 3."""
_NOTHING = 1e-9
"""Share of the information about other directions below which one isn't known at all."""


@frozen(eq=False)
class TipSpread:
    """How well the spread of the touches tells the tip.

    `axes` (3,) [m] are the half axes of the ellipsoid round the tip along `directions` (3, 3), rows in {FLANGE}, the longest first; infinite where the touches say nothing.
    """

    axes: Array
    directions: Array


@frozen(eq=False)
class Tilt:
    """A touch that would help: the tool tilted about an axis of {FLANGE} (0, 1 or 2) by an angle [rad], and the longest half axis of the tip's ellipsoid with it [m]."""

    axis: int
    angle: float
    longest: float


@frozen(eq=False)
class FrameSpread:
    """How well the spread of the points tells a frame, in the frame's own axes.

    `origin` [m] is the error of its origin, `turns` (3,) [rad] those of its orientation about x, y and z; infinite where the points say nothing. `base` [m] is the distance of the point on x, `width` [m] the largest distance of a point of the plane from the x axis.
    """

    origin: float
    turns: Array
    base: float
    width: float

    def at(self, distance: float) -> float:
        """Return the largest error [m] of a point at a distance [m] from the origin, along the worst direction.

        Errors of the origin and of the turns belong to each other; their sum is an upper bound whatever the points.
        """
        return self.origin + float(np.sqrt(np.sum(self.turns**2))) * distance


def touch_error(squares: float, freedom: int) -> float:
    """Return the error of one touch [m] that residuals tell.

    Few residuals tell it badly: the quantile of Hotelling's T-squared counts for how many there are.

    Args:
        squares: the sum of the squares of the residuals along each axis [m^2].
        freedom: the number of residuals less that of the unknowns.
    """
    if freedom < _TELLING:
        return max(ERROR, _ASSUMED * float(np.sqrt(squares / max(freedom, 1))))
    from scipy.special import fdtri

    quantile = 3.0 * float(fdtri(3.0, float(freedom), _SHARE))
    return max(LEAST_ERROR, float(np.sqrt(quantile * squares / freedom)))


def tip_information(rotations: Array, error: float = ERROR) -> Array:
    """Return the information about the tip that touches bring: the matrix of the ellipsoid round it.

    Each touch says R p + t = c + e. With the point c eliminated, sum (R - mean)^T (R - mean) p = ... remains for the tip p.

    Args:
        rotations: (k, 3, 3) of the flange.
        error: of one touch [m].

    Returns:
        (3, 3), in {FLANGE} [1/m^2].
    """
    apart = rotations - rotations.mean(axis=0)
    found: Array = np.einsum("kji,kjl->il", apart, apart) / error**2
    return found


def tip_spread(rotations: Array, error: float = ERROR) -> TipSpread:
    """Return how well touches tell the tip.

    Args:
        rotations: (k, 3, 3) of the flange, at least one.
        error: of one touch [m].
    """
    values, vectors = np.linalg.eigh(tip_information(rotations, error))
    told = values > _NOTHING / error**2
    axes = np.where(told, 1.0 / np.sqrt(np.where(told, values, 1.0)), np.inf)
    directions = vectors.T
    signs = np.sign(directions[np.arange(3), np.argmax(np.abs(directions), axis=1)])
    return TipSpread(constant(axes), constant(directions * signs[:, None]))


def helpful_tilt(rotations: Array, error: float = ERROR) -> Tilt:
    """Return the smallest tilt of one more touch, from the last one, after which the tip is known well enough; else the one that helps most.

    Args:
        rotations: (k, 3, 3) of the flange, at least one.
        error: of one touch [m].
    """
    tilts = list(_tilts(rotations, error))
    enough = [one for one in tilts if one.longest <= LARGEST_TIP]
    if enough:
        return min(enough, key=lambda one: (abs(one.angle), one.longest))
    finite = [one for one in tilts if np.isfinite(one.longest)]
    if finite:
        return min(finite, key=lambda one: one.longest)
    # nothing is known along some direction even then: tilt about the axis that is nearest to perpendicular to it
    worst = tip_spread(rotations, error).directions[0]
    return Tilt(int(np.argmin(np.abs(worst))), 30.0 * DEG, np.inf)


def _tilts(rotations: Array, error: float) -> Iterator[Tilt]:
    known = len(rotations)
    mean, information = rotations.mean(axis=0), tip_information(rotations, error)
    for axis in range(3):
        for degrees in _ANGLES:
            for sign in (1.0, -1.0):
                angle = sign * degrees * DEG
                apart = rotations[-1] @ turn_about(axis, angle) - mean
                # one more term of the sum, about the mean that moves with it
                with_it = information + apart.T @ apart * (known / (known + 1)) / error**2
                least = float(np.linalg.eigvalsh(with_it)[0])
                told = least > _NOTHING / error**2
                yield Tilt(axis, angle, 1.0 / np.sqrt(least) if told else np.inf)


def frame_spread(points: Array, error: float = ERROR) -> FrameSpread:
    """Return how well points tell a frame.

    To first order the frame turns by w where the points err: heights dh = w_x y - w_y x over all points (least squares), and w_z = dy / x of the
    point on the x axis; all of them count from the origin, whose own error moves them all.

    Args:
        points: (k, 3) [m]: the origin, a point on x, and points of the plane; from one point on.
        error: of one point [m].
    """
    turns = np.full(3, np.inf)
    along = points[1:] - points[0]
    base = float(np.linalg.norm(along[0])) if len(along) else 0.0
    if base < _NOTHING:
        return FrameSpread(error, constant(turns), 0.0, 0.0)
    turns[2] = np.sqrt(2.0) * error / base
    if len(along) < 2:
        turns[1] = turns[2]
        return FrameSpread(error, constant(turns), base, 0.0)
    flat = _in_plane(along)
    width = float(np.abs(flat[1:, 1]).max())
    if width < _NOTHING:
        turns[1] = turns[2]
        return FrameSpread(error, constant(turns), base, width)
    heights = np.column_stack((flat[:, 1], -flat[:, 0]))
    solve = np.linalg.pinv(heights)
    # the heights of the points, and of the origin against all of them
    errors = np.column_stack((solve, -solve.sum(axis=1)))
    turns[:2] = error * np.sqrt(np.sum(errors**2, axis=1))
    return FrameSpread(error, constant(turns), base, width)


def _in_plane(along: Array) -> Array:
    """Return points (k, 2) in the axes of the frame that they tell; the first one is on x."""
    *_, directions = np.linalg.svd(along)
    x = along[0] - (along[0] @ directions[2]) * directions[2]
    x /= np.linalg.norm(x)
    y = np.cross(directions[2], x)
    return np.column_stack((along @ x, along @ y))
