"""TOPP: the time-optimal motion profile along a path under the limits of velocity, acceleration and motor
speed, by TOPP-RA.

The acceleration jumps from limit to limit; there is no limit on jerk. On the grid, raw samples of the profile
are the control values. Divided differences of samples are averages of derivatives, so that the samples keep
every limit that the profile keeps, at the cost of only two segments (Pham and Pham, A New Approach to
Time-Optimal Path Parameterization based on Reachability Analysis, IEEE T-RO 34, 2018).

The solver of TOPP-RA has absolute tolerances (1e-10) and bounds (1e8). It therefore gets a path with numbers
near 1, however short or bent the path is. Joint positions are in units of the acceleration limit times the
square of `time`, which is about the duration. Places on the path are measured by the motion of the joints:
near a singularity, where a joint turns half round in a billionth of the path, that turn is then half of the
path.
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
"""Least number of places of the path at which limits are checked; they are denser where the path bends
more.
"""

_MOST_PLACES = 1000
_AROUND = 12
"""Number of places for each of the path's own places, which show its bends; up to `_MOST_PLACES` in total.

Near a singularity, and on splines, a path has more places of its own.
"""

_FINE = 400
"""Number of equal parts of the path in which bends are searched for."""

_APART = 1e-9
"""Least distance of two places, with 1 for the whole path; nearer ones count as one."""

_NO_TIME = 1e-3
"""Shortest duration for which a motion profile is searched for [s]: in a shorter time, every profile needs
the fewest segments and uses far less than the limits.
"""

_NO_BOUND = 1e5
"""Value that means no bound, for the squared speed and the acceleration; the solver's rounding errors grow
with it.
"""

_SAME = 1e-9
"""Factors that differ by less than this count as equal."""

_NO_FACTOR = 1e-12
"""Factor of a joint below which the joint is at rest."""

_SHARE = 0.9998
"""Share of the limits that the motion profile uses: between the places it may use slightly more."""


@frozen(eq=False)
class _Scaled:
    """A path scaled to numbers near 1, in the form for TOPP-RA.

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
    """A time-optimal motion profile, as values at places.

    At `times` (N,) [s] the motion passes the scaled places `gone` (N,), at the shares `s` (N,) of the path,
    with `speed` (N,) [1/s]. Between two places the acceleration of `gone` is constant.
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
    # The interpolation is monotone, so that the law never turns back, and a place in a sharp turn stays in
    # it.
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
        # The samples are the control values themselves: the law is stretched over n - 2 segments, and three
        # equal values at each end make the spline rest.
        samples = pure(np.arange(segments - 1) / (segments - 2))
        samples[0], samples[-1] = 0.0, 1.0
        return np.concatenate((np.zeros(2), samples, np.ones(2)))

    rate = speed * share_at(gone, 1)
    top = float(rate.max()) * duration
    sharpest = float(np.abs(np.diff(rate) / np.diff(times)).max()) * duration**2

    def strain(segments: int, forms: NDArray[np.int64]) -> Array:
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
    velocity = bounds.velocity * scaled.time / scaled.units
    counts, motor_velocity = bounds.counts * scaled.units, bounds.motor_velocity * scaled.time

    class Limits(constraint.LinearConstraint):  # type: ignore[misc]
        """Limits of acceleration and velocity for TOPP-RA.

        Limits of acceleration are rows a u + b x + c <= 0, where u is the acceleration along the path and x
        the squared speed; limits of velocity are bounds of x.
        """

        def __init__(self) -> None:
            super().__init__()
            self.identical = True  # one matrix F for all places

        def get_dof(self) -> int:
            return len(velocity)

        def compute_constraint_params(self, curve: Any, gridpoints: Array) -> tuple[Array | None, ...]:
            slope, bend = curve(gridpoints, 1), curve(gridpoints, 2)
            shares = np.maximum(
                (np.abs(slope) / velocity).max(axis=1),
                (np.abs(slope @ counts.T) / motor_velocity).max(axis=1),
            )
            most = np.minimum((_SHARE / np.maximum(shares, 1e-12)) ** 2, _NO_BOUND)
            # Collocation: impose the limits at each place, and also at the next one, where the squared speed
            # is x + 2 u times their distance.
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
        # The controllable sets are computed backwards from the end.
        lost = np.flatnonzero(np.isnan(controllable).any(axis=1))
        return NoLaw(float(scaled.s[lost.max(initial=0)]))
    reached = np.isfinite(speed[1:]) & (speed[1:] + speed[:-1] > 0.0)
    if not reached.all():
        return NoLaw(float(scaled.s[int(np.argmin(reached))]))
    # Constant acceleration between places: the mean speed is that of both ends.
    steps = 2.0 * np.diff(scaled.gone) / (speed[1:] + speed[:-1])
    times = np.concatenate(([0.0], np.cumsum(steps))) * scaled.time
    return _Passed(times, speed / scaled.time, scaled.gone, scaled.s)


def _leave_one(a: Array, b: Array, c: Array) -> None:
    """Drop all but one of the limits at a place (N, k) that are equal up to rounding or sign.

    The solver mistakes equal limits for contradictory ones. If the wrist is straight, joints 4 and 6 turn
    against each other, and their limits are equal.
    """
    for one, other in combinations(range(a.shape[1]), 2):
        for sign in (1.0, -1.0):
            apart = np.abs(a[:, one] - sign * a[:, other]) + np.abs(b[:, one] - sign * b[:, other])
            same = apart < _SAME
            c[same, one] = np.maximum(c[same, one], c[same, other])
            a[same, other] = b[same, other] = 0.0
            c[same, other] = -1.0


def _scaled(path: Path, bounds: Bounds) -> _Scaled | None:
    """Scale a path to numbers near 1; None if the path is so short that its motion profile doesn't matter."""
    s = np.unique(np.concatenate((np.linspace(0.0, 1.0, _FINE + 1), path.places)))
    q = path.joints(s)
    way = np.abs(np.diff(q, axis=0)).sum(axis=0)
    # Lower bounds of the order of the duration, from the joints' travel at their limits.
    time = max(float(np.sqrt((way / bounds.acceleration).max())), float((way / bounds.velocity).max()))
    if time < _NO_TIME:
        return None
    units = bounds.acceleration * time**2
    if not path.is_straight_in_joints:
        s = _places(s, q / units, max(_PLACES, min(_MOST_PLACES, _AROUND * len(path.places))))
        q = path.joints(s)
    gone = _gone(s, q / units)
    apart = _apart(gone)
    s, q, gone = s[apart], q[apart], gone[apart]
    return _Scaled(gone, s, (q - q[0]) / units, units, time)


def _places(s: Array, y: Array, count: int) -> Array:
    """Return `count` + 1 shares of the path, denser where the path bends more or the joints move farther.

    Args:
        s: shares of the path (M,) at which the joint positions are known.
        y: the joint positions there (M, n), in the units of `_Scaled`.
        count: number of intervals between the shares.
    """
    gone = _gone(s, y)
    apart = _apart(gone)
    s, y, gone = s[apart], y[apart], gone[apart]
    slope = np.diff(y, axis=0) / np.diff(gone)[:, None]
    bend = np.abs(np.diff(slope, axis=0)) / ((gone[2:] - gone[:-2]) / 2.0)[:, None]
    # The measure is the time that a bend takes: its speed is bounded by the square root of acceleration over
    # bend.
    sharpness = np.sqrt(bend.max(axis=1))
    density = np.concatenate((sharpness[:1], sharpness, sharpness[-1:]))
    density += density.mean() + 1e-9
    total = np.concatenate(([0.0], np.cumsum((density[1:] + density[:-1]) * np.diff(gone))))
    places = np.interp(np.linspace(0.0, total[-1], count + 1), total, s)
    places[0], places[-1] = 0.0, 1.0
    return places


def _gone(s: Array, y: Array) -> Array:
    """Return the scaled places, from 0 to 1, at shares `s` (N,) of the path.

    A scaled place is half the distance moved by the joints and half the share itself, since all joints are at
    rest where a spline turns back.
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
