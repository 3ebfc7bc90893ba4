"""A motion at a given cruise speed: as fast up to it, and down from it, as the limits allow."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
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
"""A blend of so many segments is as short as the limits allow but for a few percent."""

_FINEST = 0.002
"""Segments aren't made shorter than this [s] for the sake of short blends."""


@frozen
class CruiseBroken:
    """The speed can't be held: which limit it breaks, as in `TooFast`, or that the way is too short to reach it (None).

    `share` is the largest share of the speed that was tried and works (0: none).
    """

    broken: TooFast | None
    share: float


def at_speed(
    path: Path, full: float, bounds: Bounds, grid: Grid, tolerance: Tolerance
) -> Curve | CruiseBroken | NotHeld | TooLong:
    """The curve that goes along the path at one speed, but for its ramps.

    Args:
        path: the way, equally fast everywhere over s.
        full: how long the way takes at the speed that is wanted [s].
        bounds: the limits to keep.
        grid: the segment times that the controller takes.
        tolerance: how far the executed path may be from `path`.
    """
    if full / grid.largest > MOST_SEGMENTS:
        return TooLong(full)
    found = _tried(path, full, bounds, grid, tolerance)
    if isinstance(found, Curve | NotHeld):
        return found
    return CruiseBroken(found, _share(path, full, bounds, grid, tolerance))


def cruise_law(segments: float) -> Law:
    """The law whose cruise would take the whole way in so many segments; more are its ramps."""

    def forms(number: int) -> NDArray[np.int64]:
        blend = int(number - segments + 1e-9)  # rounding isn't a segment less
        ramps = np.arange(max(1, blend // 2), 0, -1)
        return np.stack((np.full_like(ramps, blend), ramps), axis=1)

    def control(number: int, form: Form) -> Array:
        return cruising(number, segments, form[1])

    return Law(lambda u: u, control, forms, trapezoid_strain)


def fewest_at_speed(trials: Trials, cruise: float, segment: float) -> Trial | None:
    """The trial with the shortest ramps that keep the limits at a segment time [s], for a law of `cruise_law(cruise)`; None
    where the way has no room for them.
    """
    least, most = math.ceil(cruise + FEWEST_IN_BLEND), math.floor(2.0 * cruise)

    def tried(blend: int) -> Trial | None:
        trial = trials.within(least - FEWEST_IN_BLEND + blend, segment)
        return trial if trial.demand.segment <= segment else None

    gentlest = most - least + FEWEST_IN_BLEND
    if gentlest < FEWEST_IN_BLEND or tried(gentlest) is None:
        return None
    return fewest(tried, FEWEST_IN_BLEND, gentlest)


def fewest(tried: Callable[[int], Trial | None], least: int, most: int) -> Trial | None:
    """The trial of the smallest number from `least` to `most` that has one; from some number on all have."""
    size, before, found = least, least - 1, None
    while size <= most and (found := tried(size)) is None:
        if size == most:
            return None
        before, size = size, min(most, math.ceil(1.3 * size))
    while found is not None and size - before > 1:
        middle = (size + before) // 2
        if (better := tried(middle)) is not None:
            found, size = better, middle
        else:
            before = middle
    return found


def _tried(
    path: Path, full: float, bounds: Bounds, grid: Grid, tolerance: Tolerance
) -> Curve | NotHeld | TooFast | None:
    """The curve; None where the ramps have no room."""
    segment = grid.nearest(min(grid.largest, full / (FEWEST_IN_BLEND + 1)))
    refused = False
    while segment >= grid.smallest:
        trials = Trials(path, cruise_law(full / segment), bounds, tolerance)
        finer = grid.nearest(segment / 2.0)
        can_be_finer = finer >= max(grid.smallest, _FINEST)
        trial = fewest_at_speed(trials, full / segment, segment)
        if trial is None:
            # where ramps have room enough, it isn't the segments that are too coarse
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
        if trial.form[0] >= _FINE or not can_be_finer:
            return curve_of(trial, segment)
        segment = finer
    return None


def _cause(trials: Trials, cruise: float, segment: float) -> TooFast | None:
    """The limit that the cruise itself breaks, with the gentlest ramps; None where only the ramps are too short."""
    if math.floor(2.0 * cruise) < cruise + FEWEST_IN_BLEND:
        return None
    trial = trials.fastest(math.floor(2.0 * cruise))
    speeds = [one for one in trial.demands if one.kind in ("velocity", "motor speed", "zone speed")]
    demand = max(speeds, key=lambda one: one.segment)
    return refusal_of(trial, demand, segment) if demand.segment > segment else None


def _share(path: Path, full: float, bounds: Bounds, grid: Grid, tolerance: Tolerance) -> float:
    """The share of a speed that works; 0 where none is found."""
    low, high = 0.0, 1.0
    for _ in range(16):
        middle = 0.5 * (low + high) if low else 0.3 * high
        if isinstance(_tried(path, full / middle, bounds, grid, tolerance), Curve):
            low = middle
        else:
            high = middle
        if low and high / low < 1.005:
            break
    return low
