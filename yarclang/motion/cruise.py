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
"""Number of segments from which on a blend is within a few percent of the shortest one that the limits
allow.
"""

_MANY = 100
"""Number of segments above which ramps are determined only to one percent."""

_LITTLE = 0.002
"""Share of the motion up to which ramps are short enough: finer segments would be many and gain nothing."""

_FINEST = 0.002
"""Segment time below which segments aren't made shorter to get shorter blends [s]."""

_LEAST_SHARE = 0.02
"""Least share of a speed that is tried. If a path nearly turns back on the spot, a smaller share would need
too many segments.
"""


@frozen
class CruiseBroken:
    """The reason why a motion can't have a requested speed.

    `broken` is the limit that the speed breaks, or None if the path is too short to reach the speed. `share`
    is the largest share of the speed that was tried and works; 0 if no share from `_LEAST_SHARE` on works, or
    if the path is too short.
    """

    broken: TooFast | None
    share: float


def full_time(path: CartesianPath, speed: Reading) -> float | None:
    """Return the duration of a path at a speed [s]; None if the speed has another unit than the path's
    length.

    The length of a pure turn is an angle.
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
    # A path too short to reach its speed needs another law: no share of the speed helps.
    share = 0.0 if found is None else _share(path, full, bounds, grid, tolerance)
    return CruiseBroken(found, share)


def cruise_law(segments: float) -> Law:
    """Return the motion profile whose cruise would take the whole path in `segments` segments.

    The segments beyond this number are for speeding up and slowing down.
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
    """Return the trial with the shortest ramps that keep the limits, for a motion profile of
    `cruise_law(cruise)`.

    Args:
        trials: the trials of the path with this profile.
        cruise: number of segments that the whole path would take at the speed.
        segment: duration of the segments [s].
        any_ramps: True to try only the gentlest ramps, if the result won't be executed.

    Returns:
        The trial; None if there is no room for such ramps.
    """
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

    Only the two ends of the path are considered, not its form.
    """
    way, bounds = np.abs(trials.path.end - trials.path.start), trials.bounds
    # The fastest law without pauses has jerk up, down, down and up, each for a quarter of the time.
    most = np.minimum(bounds.jerk * (duration**3 / 32.0), bounds.acceleration * (duration**2 / 4.0))
    return bool((way > (1.0 + 1e-6) * most).any())


def fewest(tried: Callable[[int], Trial | None], least: int, most: int) -> Trial | None:
    """Return the trial for the smallest number of segments, from `least` to `most`, for which there is one.

    Large numbers are determined only roughly. From some number on, all numbers must have a trial, so that
    bisection applies.
    """
    # Grow the number until one works, then bisect between it and the last one that doesn't.
    size, before, found = least, least - 1, None
    while size <= most and (found := tried(size)) is None:
        if size == most:
            return None
        before, size = size, min(most, math.ceil((1.3 if size < _MANY else 3.0) * size))
    while found is not None and size - before > max(1.0, size / _MANY):
        middle = (size + before) // 2
        if (better := tried(middle)) is not None:
            found, size = better, middle
        else:
            before = middle
    return found


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
            # If the ramps have enough room, coarse segments aren't the reason.
            has_room = full / segment > 2 * _FINE
            if not can_be_finer or (refused and has_room):
                return _cause(trials, full / segment, segment)
            refused, segment = has_room, finer
            continue
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
        is_short = trial.form[0] >= _FINE or trial.form[0] * segment <= _LITTLE * full
        if is_short or not can_be_finer:
            return curve_of(trial, segment)
        segment = finer
    return None


def _cause(trials: Trials, cruise: float, segment: float) -> TooFast | None:
    """Return the limit that the cruise itself breaks, found with the gentlest ramps; None if only the ramps
    break a limit because they are too short.
    """
    if math.floor(2.0 * cruise) < cruise + FEWEST_IN_BLEND:
        return None
    if trials.is_slow(math.floor(2.0 * cruise), segment):
        return None
    trial = trials.fastest(math.floor(2.0 * cruise))
    speeds = [one for one in trial.demands if one.kind in ("velocity", "motor speed", "zone speed")]
    demand = max(speeds, key=lambda one: one.segment)
    return refusal_of(trial, demand, segment) if demand.segment > segment else None


def _share(path: Path, full: float, bounds: Bounds, grid: Grid, tolerance: Tolerance) -> float:
    """Return the largest share of a requested speed that works, to within half a percent; 0 if none from
    `_LEAST_SHARE` on does.
    """
    low, high = 0.0, 1.0
    for _ in range(16):
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
