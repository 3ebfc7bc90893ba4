"""Compute the error of a calibrated tip or frame from the errors of single touches, and propose a further
touch that reduces it.

The errors of touches are assumed to be independent and equally distributed in all directions. 5 of 100
touches have an error larger than the parameter `error`. Likewise, in at most 5 of 100 calibrations the true
tip is outside of the reported ellipsoid.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.transforms import constant, turn_about
from yarclang.units import DEG, MM

ERROR = 0.5 * MM
"""Assumed error of one touch, if the touches give no estimate [m]. This value applies to touching by eye with
a pointed tip.
"""
LEAST_ERROR = 0.1 * MM
"""Least error of one touch [m]. A smaller estimate is raised to it, since an eye can't see smaller
distances.
"""
LARGEST_TIP = 1.5 * MM
"""Error of a tip in its worst direction above which further touches are needed [m]."""
LARGEST_TURN = 0.3 * DEG
"""Error of a frame's orientation about its worst axis above which points farther apart are needed [rad]."""
FAR = 500.0 * MM
"""Distance from the origin of a frame at which its error is reported [m]."""

_ANGLES = (20.0, 30.0, 45.0)
_TELLING = 6
"""Least number of degrees of freedom for which residuals give an estimate of the error of a touch. Four
touches of a point have this number.
"""
_SHARE = 0.95
_ASSUMED = 2.7955
"""Radius of the sphere that contains the fraction `_SHARE` of a normal distribution in space, as a multiple
of the standard deviation.

It is the square root of the chi-square quantile for 3 degrees of freedom.
"""
_NOTHING = 1e-9
"""Information about a direction, relative to 1 / error², below which the tip's position in this direction
counts as unknown.
"""


@frozen(eq=False)
class TipSpread:
    """Uncertainty of a calibrated tool tip, as an ellipsoid around it.

    Attributes:
        axes: (3,) its half axes, the longest first [m]; infinite in directions in which the tip's
            position is unknown.
        directions: (3, 3) directions of the half axes, as rows in {FLANGE}.
    """

    axes: Array
    directions: Array


@frozen(eq=False)
class Tilt:
    """A proposal for a further touch that would reduce the uncertainty of a tool tip.

    Attributes:
        axis: axis of {FLANGE} about which the tool is tilted for this touch: 0, 1 or 2.
        angle: angle of the tilt [rad].
        longest: longest half axis of the tip's uncertainty ellipsoid after this touch [m].
    """

    axis: int
    angle: float
    longest: float


@frozen(eq=False)
class FrameSpread:
    """Uncertainty of a calibrated frame, in its own axes.

    Attributes:
        origin: error of its origin [m].
        turns: (3,) errors of its orientation about x, y and z [rad]; infinite for an axis about which it
            is unknown.
        base: distance of the touched point on the x axis from the origin [m].
        width: largest distance of a touched point of the plane from the x axis [m].
    """

    origin: float
    turns: Array
    base: float
    width: float

    def at(self, distance: float) -> float:
        """Return the largest error [m] of a point at a distance [m] from the frame's origin, in the worst
        direction.

        The errors of the origin and of the orientation are correlated. Their sum is an upper bound for every
        correlation.
        """
        return self.origin + float(np.sqrt(np.sum(self.turns**2))) * distance


def touch_error(squares: float, freedom: int) -> float:
    """Estimate the error of one touch [m] from the residuals of a calibration.

    Few residuals give a poor estimate. The estimate is therefore multiplied by a quantile of Hotelling's
    T-squared distribution, which is larger for fewer residuals.

    Args:
        squares: sum of the squares of the residuals along all axes [m^2].
        freedom: number of residuals minus number of unknowns.
    """
    if freedom < _TELLING:
        return max(ERROR, _ASSUMED * float(np.sqrt(squares / max(freedom, 1))))
    from scipy.special import fdtri

    quantile = 3.0 * float(fdtri(3.0, float(freedom), _SHARE))
    return max(LEAST_ERROR, float(np.sqrt(quantile * squares / freedom)))


def tip_information(rotations: Array, error: float = ERROR) -> Array:
    """Return the information that touches give about the tool tip: the matrix A of the uncertainty ellipsoid
    xᵀ A x = 1.

    Each touch gives R p + t = c + e, with the tip p, the fixed point c and the error e. The mean over all
    touches is subtracted, which eliminates c. The normal equations are then sum (R - mean)^T (R - mean) p =
    ..., and their matrix is the information.

    Args:
        rotations: (k, 3, 3) rotations of the flange at the touches.
        error: error of one touch [m].

    Returns:
        (3, 3), in {FLANGE} [1/m^2].
    """
    apart = rotations - rotations.mean(axis=0)
    found: Array = np.einsum("kji,kjl->il", apart, apart) / error**2
    return found


def tip_spread(rotations: Array, error: float = ERROR) -> TipSpread:
    """Return the uncertainty of the tool tip after touches.

    Args:
        rotations: (k, 3, 3) rotations of the flange at the touches, at least one.
        error: error of one touch [m].
    """
    values, vectors = np.linalg.eigh(tip_information(rotations, error))
    told = values > _NOTHING / error**2
    axes = np.where(told, 1.0 / np.sqrt(np.where(told, values, 1.0)), np.inf)
    directions = vectors.T
    signs = np.sign(directions[np.arange(3), np.argmax(np.abs(directions), axis=1)])
    return TipSpread(constant(axes), constant(directions * signs[:, None]))


def helpful_tilt(rotations: Array, error: float = ERROR) -> Tilt:
    """Return the smallest tilt of the tool, relative to the last touch, such that one more touch makes the
    tip accurate enough.

    If there is no such tilt, return the tilt that reduces the uncertainty most.

    Args:
        rotations: (k, 3, 3) rotations of the flange at the touches, at least one.
        error: error of one touch [m].
    """
    tilts = list(_tilts(rotations, error))
    enough = [one for one in tilts if one.longest <= LARGEST_TIP]
    if enough:
        return min(enough, key=lambda one: (abs(one.angle), one.longest))
    finite = [one for one in tilts if np.isfinite(one.longest)]
    if finite:
        return min(finite, key=lambda one: one.longest)
    # No single tilt determines the tip. Tilt about the axis that is closest to perpendicular to the worst
    # direction.
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
                # The additional touch adds one term to the sum, and also moves the mean. With k touches so
                # far (`known`), this gives the factor k / (k + 1).
                with_it = information + apart.T @ apart * (known / (known + 1)) / error**2
                least = float(np.linalg.eigvalsh(with_it)[0])
                told = least > _NOTHING / error**2
                yield Tilt(axis, angle, 1.0 / np.sqrt(least) if told else np.inf)


def frame_spread(points: Array, error: float = ERROR) -> FrameSpread:
    """Return the uncertainty of a frame after touches.

    To first order, errors of the points rotate the frame by w. The errors dh of the heights of all points
    give w_x and w_y by least squares, dh = w_x y - w_y x. The error dy of the point on the x axis gives w_z =
    dy / x. All points are measured relative to the origin, so the error of the origin is added to each of
    these errors.

    Args:
        points: (k, 3) the touched points [m]: the origin, a point on the x axis, and points of the
            plane. Only the origin is required.
        error: error of one point [m].
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
    # The last column is the error of the origin, to which all heights are relative. The others are the errors
    # of the points' heights.
    errors = np.column_stack((solve, -solve.sum(axis=1)))
    turns[:2] = error * np.sqrt(np.sum(errors**2, axis=1))
    return FrameSpread(error, constant(turns), base, width)


def _in_plane(along: Array) -> Array:
    """Return touched points as (k, 2) in the x-y axes of the frame that they define. The first point is on
    the x axis.
    """
    # directions[2] is the normal of the best plane through the origin (total least squares).
    *_, directions = np.linalg.svd(along)
    x = along[0] - (along[0] @ directions[2]) * directions[2]
    x /= np.linalg.norm(x)
    y = np.cross(directions[2], x)
    return np.column_stack((along @ x, along @ y))
