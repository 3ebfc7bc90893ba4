"""TOPP: the time-optimal motion profile along a path under the limits of velocity, acceleration and motor
speed, by TOPP-RA.

The acceleration jumps from limit to limit; there is no limit on jerk. On the grid, raw samples of the profile
are the control values. Divided differences of samples are averages of derivatives. The samples therefore keep
every limit that the profile keeps, at the cost of only two segments (Pham and Pham, "A New Approach to
Time-Optimal Path Parameterization based on Reachability Analysis", IEEE T-RO 34, 2018).

The solver of TOPP-RA has absolute tolerances (1e-10) and bounds (1e8). It therefore gets a path with numbers
near 1, however short or bent the path is. The unit of joint positions is the acceleration limit times the
square of `time`, which is about the duration. Places on the path are measured by the motion of the joints.
Near a singularity a joint may turn by 180 deg in a billionth of the path; in these units, this motion is half
of the path.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.limits import Bounds
from yarclang.motion.path import Path
from yarclang.motion.profile import NO_FORM, Form, Law, NoLaw, Profile

_PLACES = 350
"""Least number of places of the path at which limits are checked. They are closer together where the path
bends.
"""

_MOST_PLACES = 1000
_AROUND = 12
"""Number of places at which limits are checked, for each place in `path.places`. In total there are at most
`_MOST_PLACES`.

`path.places` has more places near a singularity, and on splines.
"""

_FINE = 400
"""Number of equal parts of the path in which bends are searched for."""

_APART = 1e-9
"""Least distance of two places, as a share of the whole path. Nearer places count as one."""

_NO_TIME = 1e-3
"""Estimated duration below which no motion profile is searched for [s]. Such a short motion needs the fewest
segments with every profile, and uses far less than the limits.
"""

_NO_BOUND = 1e5
"""Value of the squared speed and of the acceleration that means "no bound". A larger value would increase the
solver's rounding errors.
"""

_SAME = 1e-9
"""Difference of the factors a and b of two limits below which the limits count as equal."""

_NO_FACTOR = 1e-12
"""Least value by which the factors of a limit are divided. It avoids division by zero for joints at rest."""

_SHARE = 0.9998
"""Share of the limits that the motion profile uses at the checked places. Between these, it may use slightly
more.
"""


@frozen(eq=False)
class _Scaled:
    """A path scaled to numbers near 1, as TOPP-RA needs them.

    `gone` (N,) are scaled places, from 0 to 1, at the shares `s` (N,) of the path. `y` (N, n) are the joint
    positions there, in `units` (n,) [rad or m], relative to the start. `time` [s] is the unit of time, chosen
    so that all limits of acceleration are 1.
    """

    gone: Array
    s: Array
    y: Array
    units: Array
    time: float


@frozen(eq=False)
class _Passed:
    """A time-optimal motion profile, as values at N places.

    At `times` (N,) [s] the motion passes the scaled places `gone` (N,), which are at the shares `s` (N,) of
    the path, with `speed` (N,) [1/s]. Between two places the acceleration of `gone` is constant.
    """

    times: Array
    speed: Array
    gone: Array
    s: Array


def _law(path: Path, bounds: Bounds) -> Law | NoLaw:
    from scipy.interpolate import PchipInterpolator

    passed = _fastest(path, bounds)
    if isinstance(passed, NoLaw):
        return passed
    times, speed, gone = passed.times, passed.speed, passed.gone
    duration = float(times[-1])
    # The interpolation is monotone. Therefore the motion never reverses, and places between two samples stay
    # between them, even at a sharp bend.
    share_at = PchipInterpolator(gone, passed.s)

    def pure(u: Array) -> Array:
        t = np.clip(u, 0.0, 1.0) * duration
        piece = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2)
        along = t - times[piece]
        # Constant acceleration on a piece: v t + a t^2 / 2.
        push = (speed[piece + 1] - speed[piece]) / (times[piece + 1] - times[piece])
        reached = gone[piece] + along * (speed[piece] + 0.5 * push * along)
        s: Array = np.clip(share_at(np.clip(reached, 0.0, 1.0)), 0.0, 1.0)
        return s

    def control(segments: int, form: Form) -> Array:  # noqa: ARG001
        # The samples are the control values themselves. The profile takes n - 2 segments, since three equal
        # values at each end make the spline rest.
        samples = pure(np.arange(segments - 1) / (segments - 2))
        samples[0], samples[-1] = 0.0, 1.0
        return np.concatenate((np.zeros(2), samples, np.ones(2)))

    # Chain rule from scaled places to shares of the path: ds/dt = d share / d gone * d gone/dt.
    rate = speed * share_at(gone, 1)
    top = float(rate.max()) * duration
    sharpest = float(np.abs(np.diff(rate) / np.diff(times)).max()) * duration**2

    def strain(segments: int, forms: NDArray[np.int64]) -> Array:
        # A difference of order r of samples is at most h^r times the largest derivative. The acceleration
        # jumps, so the third difference is only known to be at most twice the largest second one.
        h = 1.0 / (segments - 2)
        return np.tile([top * h, sharpest * h**2, 2.0 * sharpest * h**2], (len(forms), 1))

    return Law(pure, control, lambda segments: NO_FORM, strain, shortest=duration)  # noqa: ARG005


def _fastest(path: Path, bounds: Bounds) -> _Passed | NoLaw:
    """Return the time-optimal motion profile of a path by TOPP-RA, or the place where TOPP-RA gives up."""
    import toppra
    from toppra import constraint

    scaled = _scaled(path, bounds)
    if scaled is None:
        ends = np.array([0.0, 0.5, 1.0])
        return _Passed(ends * _NO_TIME, np.array([0.0, 2.0, 0.0]) / _NO_TIME, ends, ends)
    # Limits in the scaled units of length and time.
    velocity = bounds.velocity * scaled.time / scaled.units
    counts, motor_velocity = bounds.counts * scaled.units, bounds.motor_velocity * scaled.time

    class Limits(constraint.LinearConstraint):  # type: ignore[misc]
        """Limits of acceleration and velocity for TOPP-RA.

        Limits of acceleration are rows a u + b x + c <= 0, where u is the acceleration along the path and x
        the squared speed; limits of velocity are bounds of x.
        """

        def __init__(self) -> None:
            super().__init__()
            self.identical = True  # one matrix F serves for all places

        def get_dof(self) -> int:
            return len(velocity)

        def compute_constraint_params(self, curve: Any, gridpoints: Array) -> tuple[Array | None, ...]:
            # Chain rule: a joint's acceleration is slope u + bend x, and its velocity slope sqrt(x).
            slope, bend = curve(gridpoints, 1), curve(gridpoints, 2)
            shares = np.maximum(
                (np.abs(slope) / velocity).max(axis=1),
                (np.abs(slope @ counts.T) / motor_velocity).max(axis=1),
            )
            most = np.minimum((_SHARE / np.maximum(shares, 1e-12)) ** 2, _NO_BOUND)
            # Impose the limits at each place, and also at the next place (collocation). At the next place,
            # the squared speed is x + 2 u times the distance of the two places.
            a, b = np.tile(slope, 2), np.tile(bend, 2)
            joints = len(velocity)
            b[:-1, joints:] = bend[1:]
            a[:-1, joints:] = slope[1:] + 2.0 * np.diff(gridpoints)[:, None] * bend[1:]
            # The solver mistakes rows with small factors for parallel ones.
            size = np.maximum(np.maximum(np.abs(a), np.abs(b)), _NO_FACTOR)
            a, b, c = a / size, b / size, -np.minimum(_SHARE / size, _NO_BOUND)
            _leave_one(a, b, c)
            rows = np.eye(4 * joints)
            a, b, c = np.hstack((a, -a)), np.hstack((b, -b)), np.hstack((c, c))
            of_u = np.tile([-_NO_BOUND, _NO_BOUND], (len(most), 1))
            of_x = np.stack((np.zeros_like(most), most), axis=1)
            return a, b, c, rows, np.zeros(len(rows)), of_u, of_x

    instance = toppra.algorithm.TOPPRA(
        [Limits()],
        toppra.SplineInterpolator(scaled.gone, scaled.y),
        gridpoints=scaled.gone,
        parametrizer="ParametrizeConstAccel",
    )
    _, speed, _, controllable = instance.compute_parameterization(0.0, 0.0, return_data=True)
    if speed is None:
        # The solver works backwards from the end: the last place with NaN is where it failed.
        lost = np.flatnonzero(np.isnan(controllable).any(axis=1))
        return NoLaw(float(scaled.s[lost.max(initial=0)]))
    reached = np.isfinite(speed[1:]) & (speed[1:] + speed[:-1] > 0.0)
    if not reached.all():
        return NoLaw(float(scaled.s[int(np.argmin(reached))]))
    # The acceleration is constant between places: the mean speed is the mean of the speeds at both places.
    steps = 2.0 * np.diff(scaled.gone) / (speed[1:] + speed[:-1])
    times = np.concatenate(([0.0], np.cumsum(steps))) * scaled.time
    return _Passed(times, speed / scaled.time, scaled.gone, scaled.s)


def _leave_one(a: Array, b: Array, c: Array) -> None:
    """Among the limits at each place (N, k) that are equal up to rounding or sign, keep only one.

    The solver mistakes equal limits for contradictory ones. Limits are equal, for example, if the wrist is
    straight: joints 4 and 6 then turn in opposite directions by equal angles.
    """
    for first, second in combinations(range(a.shape[1]), 2):
        for sign in (1.0, -1.0):
            apart = np.abs(a[:, first] - sign * a[:, second]) + np.abs(b[:, first] - sign * b[:, second])
            same = apart < _SAME
            # Both limits have the form |...| <= -c: keep the stricter one, which has the larger c.
            c[same, first] = np.maximum(c[same, first], c[same, second])
            a[same, second] = b[same, second] = 0.0
            c[same, second] = -1.0


def _scaled(path: Path, bounds: Bounds) -> _Scaled | None:
    """Scale a path to numbers near 1; None if the path is so short that its motion profile doesn't matter."""
    s = np.unique(np.concatenate((np.linspace(0.0, 1.0, _FINE + 1), path.places)))
    q = path.joints(s)
    way = np.abs(np.diff(q, axis=0)).sum(axis=0)
    # Estimate the order of magnitude of the duration from the joints' travel and limits.
    time = max(float(np.sqrt((way / bounds.acceleration).max())), float((way / bounds.velocity).max()))
    if time < _NO_TIME:
        return None
    # In these units, every limit of acceleration is 1.
    units = bounds.acceleration * time**2
    if not path.is_straight_in_joints:
        s = _places(s, q / units, max(_PLACES, min(_MOST_PLACES, _AROUND * len(path.places))))
        q = path.joints(s)
    gone = _gone(s, q / units)
    apart = _apart(gone)
    s, q, gone = s[apart], q[apart], gone[apart]
    return _Scaled(gone, s, (q - q[0]) / units, units, time)


def _places(s: Array, y: Array, count: int) -> Array:
    """Return `count` + 1 shares of the path, closer together where the path bends more or the joints move
    farther.

    Args:
        s: shares of the path (M,) at which the joint positions are known.
        y: the joint positions at these shares (M, n), in the units of `_Scaled`.
        count: number of intervals between the shares.
    """
    gone = _gone(s, y)
    apart = _apart(gone)
    s, y, gone = s[apart], y[apart], gone[apart]
    slope = np.diff(y, axis=0) / np.diff(gone)[:, None]
    bend = np.abs(np.diff(slope, axis=0)) / ((gone[2:] - gone[:-2]) / 2.0)[:, None]
    # Measure a bend by the time that it takes: the speed on it is at most the square root of acceleration
    # over bend.
    sharpness = np.sqrt(bend.max(axis=1))
    density = np.concatenate((sharpness[:1], sharpness, sharpness[-1:]))
    density += density.mean() + 1e-9
    total = np.concatenate(([0.0], np.cumsum((density[1:] + density[:-1]) * np.diff(gone))))
    places = np.interp(np.linspace(0.0, total[-1], count + 1), total, s)
    places[0], places[-1] = 0.0, 1.0
    return places


def _gone(s: Array, y: Array) -> Array:
    """Return the scaled places, from 0 to 1, at shares `s` (N,) of the path.

    A scaled place is the mean of two shares: of the distance that the joints have moved, and of the path. The
    first share alone doesn't suffice, since all joints are at rest where a spline reverses.
    """
    steps = np.linalg.norm(np.diff(y, axis=0), axis=1)
    gone = np.concatenate(([0.0], np.cumsum(0.5 * steps / steps.sum() + 0.5 * np.diff(s))))
    gone /= gone[-1]
    return gone


def _apart(gone: Array) -> NDArray[np.intp]:
    """Return the indices of places (N,) that are far enough apart, including the first and the last."""
    numbers = np.floor(gone / _APART)
    kept = np.flatnonzero(np.diff(numbers, prepend=-1.0))
    kept[-1] = len(gone) - 1
    return kept


PROFILE = Profile(
    name="TOPP",
    summary="time-optimal along the path under velocity, acceleration and motor limits; no jerk limit",
    law=_law,
    is_stretched=True,
    has_jerk_limit=False,
    needs_search=True,
    longest_segment=0.005,
)
