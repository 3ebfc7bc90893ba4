"""Plan a motion at a given cruise speed, with acceleration ramps as short as the limits allow."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array, Reading
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.curve import Curve
from yarclang.motion.fit import MOST_SEGMENTS, NotHeld, TooFast, TooLong, curve_of, refusal_of
from yarclang.motion.framespeed import finer_for_speed
from yarclang.motion.limits import Bounds, Grid
from yarclang.motion.path import Path
from yarclang.motion.profile import Form, Law
from yarclang.motion.trapezoid import FEWEST_IN_BLEND, cruising, trapezoid_strain
from yarclang.motion.trials import Trial, Trials
from yarclang.robot.model import Tolerance

_FINE = 12
"""If speeding up takes this number of segments, shorter segments aren't tried. Speeding up then takes at most
a few percent longer than necessary.
"""

_MANY = 100
"""Number of segments above which the shortest ramps are searched only to within one percent."""

_LITTLE = 0.002
"""Share of the path's duration at full speed below which a ramp isn't shortened further. A shorter ramp would
need many more segments for almost no gain.
"""

_FINEST = 0.002
"""Shortest segment time to which segments are halved to make the ramps shorter [s]."""

_LEAST_SHARE = 0.02
"""Least share of a speed that is tried. On a path that reverses almost on the spot, a smaller share would
need too many segments.
"""


@frozen
class CruiseBroken:
    """The reason why a motion can't have a requested speed.

    `broken` is the limit that the speed breaks, or None if the path is too short to reach the speed. `share`
    is the largest share of the speed that was tried and works. It is 0 if no share down to `_LEAST_SHARE`
    works, or if the path is too short.
    """

    broken: TooFast | None
    share: float


def full_time(path: CartesianPath, speed: Reading) -> float | None:
    """Return the duration of a path at a given speed [s].

    The result is None if the unit of the speed doesn't fit the path: a pure rotation needs an angle per time,
    any other path a length per time.
    """
    way, turns = path.extent
    wanted = speed.angle if turns else speed.length
    return None if wanted is None else way / wanted


def at_speed(
    path: Path, full: float, bounds: Bounds, grid: Grid, tolerance: Tolerance
) -> Curve | CruiseBroken | NotHeld | TooLong:
    """Plan a motion that follows its path at one speed, except while it speeds up and slows down.

    Args:
        path: the path, traversed at constant speed over s.
        full: duration of the whole path at the wanted speed [s].
        bounds: the limits to keep.
        grid: the segment times that the controller accepts.
        tolerance: largest distance of the executed path from `path`.

    Returns:
        The curve, or the reason why there is none.
    """
    if full / grid.largest > MOST_SEGMENTS:
        return TooLong(full)
    found = _tried(path, full, bounds, grid, tolerance)
    if isinstance(found, Curve | NotHeld):
        return found
    # If the path is too short to reach its speed, the caller takes another kind of profile: don't search for
    # a smaller speed.
    share = 0.0 if found is None else _share(path, full, bounds, grid, tolerance)
    return CruiseBroken(found, share)


def cruise_law(segments: float) -> Law:
    """Return the motion profile that would take `segments` segments for the whole path at its cruise speed.

    The profile has more segments: the additional ones are for speeding up and slowing down.
    """

    def forms(number: int) -> NDArray[np.int64]:
        blend = int(number - segments + 1e-9)  # rounding must not lose a segment
        ramps = np.arange(max(1, blend // 2), 0, -1)
        return np.stack((np.full_like(ramps, blend), ramps), axis=1)

    def control(number: int, form: Form) -> Array:
        return cruising(number, segments, form[1])

    return Law(lambda u: u, control, forms, trapezoid_strain)


def fewest_at_speed(
    trials: Trials, cruise: float, segment: float, *, any_ramps: bool = False
) -> Trial | None:
    """Return the trial with the shortest ramps that keep the limits, for the motion profile
    `cruise_law(cruise)`.

    Args:
        trials: the trials of the path with this profile.
        cruise: number of segments that the whole path would take at cruise speed.
        segment: duration of the segments [s].
        any_ramps: True to try only the gentlest ramps, for a result that won't be executed.

    Returns:
        The trial; None if there is no room for such ramps.
    """
    # Limits of the search: the shortest ramps, and ramps so long that no cruise is left between them.
    least, most = math.ceil(cruise + FEWEST_IN_BLEND), math.floor(2.0 * cruise)

    def tried(blend: int) -> Trial | None:
        segments = least - FEWEST_IN_BLEND + blend
        if _is_too_short(trials, segments * segment):
            return None
        trial = trials.within(segments, segment)
        return trial if trial.demand.segment <= segment else None

    gentlest = most - least + FEWEST_IN_BLEND
    slowest = tried(gentlest) if gentlest >= FEWEST_IN_BLEND else None
    if slowest is None or any_ramps:
        return slowest
    return fewest(tried, FEWEST_IN_BLEND, gentlest)


def _is_too_short(trials: Trials, duration: float) -> bool:
    """Return True if no motion within the limits of acceleration and jerk can go from rest to rest in a
    duration [s].

    Only the ends of the path are considered, not its form.
    """
    way, bounds = np.abs(trials.path.end - trials.path.start), trials.bounds
    # The fastest such motion has positive, negative, negative and positive jerk, each for a quarter of the
    # time.
    most = np.minimum(bounds.jerk * (duration**3 / 32.0), bounds.acceleration * (duration**2 / 4.0))
    return bool((way > (1.0 + 1e-6) * most).any())


def fewest(tried: Callable[[int], Trial | None], least: int, most: int) -> Trial | None:
    """Return the trial with the smallest number of segments, from `least` to `most`, for which `tried`
    returns a trial.

    Large numbers are found only roughly. The search assumes that all larger numbers have a trial if one has.
    """
    # Increase the number until one works. Then bisect between this number and the last one that failed.
    size, before, fastest = least, least - 1, None
    while size <= most and (fastest := tried(size)) is None:
        if size == most:
            return None
        before, size = size, min(most, math.ceil((1.3 if size < _MANY else 3.0) * size))
    while fastest is not None and size - before > max(1.0, size / _MANY):
        middle = (size + before) // 2
        if (better := tried(middle)) is not None:
            fastest, size = better, middle
        else:
            before = middle
    return fastest


def _tried(
    path: Path, full: float, bounds: Bounds, grid: Grid, tolerance: Tolerance, *, any_ramps: bool = False
) -> Curve | NotHeld | TooFast | None:
    """Return the curve at a cruise speed, or None if there is no room for its ramps.

    `any_ramps` is as for `fewest_at_speed`.
    """
    segment = grid.nearest(min(grid.largest, full / (FEWEST_IN_BLEND + 1)))
    refused = False
    while segment >= grid.smallest:
        trials = Trials(path, cruise_law(full / segment), bounds, tolerance)
        finer = grid.nearest(segment / 2.0)
        can_be_finer = finer >= max(grid.smallest, _FINEST)
        trial = fewest_at_speed(trials, full / segment, segment, any_ramps=any_ramps)
        if trial is None:
            # If the ramps have enough segments, finer segments won't help.
            has_room = full / segment > 2 * _FINE
            if not can_be_finer or (refused and has_room):
                return _cause(trials, full / segment, segment)
            refused, segment = has_room, finer
            continue
        # If the curve is too far from the path, take as many segments as the tolerance needs.
        more = trials.segments_for_tolerance(trial)
        if more is not None:
            segment = grid.nearest(segment * trial.segments / more)
            if segment < grid.smallest:
                return NotHeld(*trials.deviation(trial), segment)
            continue
        steadier = finer_for_speed(path, trial, segment) if isinstance(path, CartesianPath) else None
        if steadier is not None and grid.nearest(steadier) >= grid.smallest:
            segment = grid.nearest(steadier)
            continue
        # Ramps are rounded up to whole segments, so finer segments make them shorter.
        is_short = trial.form[0] >= _FINE or trial.form[0] * segment <= _LITTLE * full
        if is_short or not can_be_finer:
            return curve_of(trial, segment)
        segment = finer
    return None


def _cause(trials: Trials, cruise: float, segment: float) -> TooFast | None:
    """Return the limit that the cruise itself breaks. It is found with the gentlest ramps.

    The result is None if only the ramps break a limit because they are too short.
    """
    if math.floor(2.0 * cruise) < cruise + FEWEST_IN_BLEND:
        return None
    if trials.is_slow(math.floor(2.0 * cruise), segment):
        return None
    # With the gentlest ramps, the motion has 2 * `cruise` segments and no cruise between its ramps. If it
    # still exceeds a speed limit, the requested speed is too high.
    trial = trials.fastest(math.floor(2.0 * cruise))
    speeds = [one for one in trial.demands if one.kind in ("velocity", "motor speed", "zone speed")]
    demand = max(speeds, key=lambda one: one.segment)
    return refusal_of(trial, demand, segment) if demand.segment > segment else None


def _share(path: Path, full: float, bounds: Bounds, grid: Grid, tolerance: Tolerance) -> float:
    """Return the largest share of a requested speed that works, to within half a percent; 0 if no share down
    to `_LEAST_SHARE` works.
    """
    low, high = 0.0, 1.0
    for _ in range(16):
        # Go down in large steps until a share works; then bisect.
        middle = 0.5 * (low + high) if low else max(0.3 * high, _LEAST_SHARE)
        if isinstance(_tried(path, full / middle, bounds, grid, tolerance, any_ramps=True), Curve):
            low = middle
        elif middle > _LEAST_SHARE:
            high = middle
        else:
            return 0.0
        if low and high / low < 1.005:
            break
    return low
