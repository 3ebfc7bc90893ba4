"""A motion at a given cruise speed: as fast up to it, and down from it, as the limits allow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from yarclang.motion.curve import Curve
from yarclang.motion.fit import MOST_SEGMENTS, NotHeld, TooFast, TooLong, curve_of, refusal_of
from yarclang.motion.limits import Bounds, Grid
from yarclang.motion.path import Path
from yarclang.motion.profile import Form, Law
from yarclang.motion.trapezoid import FEWEST_IN_BLEND, trapezoid, trapezoid_strain
from yarclang.motion.trials import Trial, Trials
from yarclang.robot.model import Tolerance

_FINE = 12
"""A blend of so many segments is as short as the limits allow but for a few percent."""

_FINER = 0.002
"""Segments aren't made shorter than this [s] for the sake of short blends."""


@dataclass(frozen=True, slots=True)
class CruiseBroken:
    """The speed can't be held: which limit it breaks, as in `TooFast`, or that the way is too short to reach it (None).

    `share` is the largest share of the speed that was tried and works (0: none).
    """

    broken: TooFast | None
    share: float


def at_speed(
    path: Path, way: float, speed: float, bounds: Bounds, grid: Grid, tolerance: Tolerance
) -> Curve | CruiseBroken | NotHeld | TooLong:
    """The curve that goes along the path at one speed, but for its ramps.

    Args:
        path: the way, equally fast everywhere over s.
        way: how far the moving frame goes [m or rad].
        speed: [m/s or rad/s].
        bounds: the limits to keep.
        grid: the segment times that the controller takes.
        tolerance: how far the executed path may be from `path`.
    """
    if way / speed / grid.largest > MOST_SEGMENTS:
        return TooLong(way / speed)
    found = _tried(path, way / speed, bounds, grid, tolerance)
    if not isinstance(found, TooFast) and found is not None:
        return found
    return CruiseBroken(found, _share(path, way / speed, bounds, grid, tolerance))


def _tried(
    path: Path, cruise: float, bounds: Bounds, grid: Grid, tolerance: Tolerance
) -> Curve | NotHeld | TooFast | None:
    """The curve whose way takes `cruise` [s] at full speed; None where the ramps have no room."""
    number = max(FEWEST_IN_BLEND, math.ceil(cruise / grid.largest - 1e-9))
    while True:
        segment = grid.nearest(cruise / number)
        if segment < grid.smallest:
            return None
        trials = Trials(path, _law(number), bounds, tolerance)
        refusal: TooFast | None = None
        for blend in _blends(number):
            trial = trials.within(number + blend, segment)
            if trial.demand.segment <= segment:
                break
            refusal = refusal_of(trial, trial.demand, segment)
        else:
            if refusal is not None and number * 2 * grid.smallest > cruise:
                return _cause(trials, number, segment) or refusal
            if cruise / (2 * number) < max(grid.smallest, _FINER):
                return _cause(trials, number, segment)
            number *= 2
            continue
        blend = trial.segments - number
        trial = _shortest_blend(trials, number, blend, segment)
        more = trials.segments_for_tolerance(trial)
        if more is not None:
            wanted = math.ceil(number * more / trial.segments)
            if cruise / wanted < grid.smallest:
                return NotHeld(*trials.deviation(trial), segment)
            number = wanted
            continue
        if trial.segments - number >= _FINE or cruise / (2 * number) < max(grid.smallest, _FINER):
            return curve_of(trial, segment)
        number *= 2


def _cause(trials: Trials, number: int, segment: float) -> TooFast | None:
    """The limit that the cruise itself breaks, with the gentlest ramps; None where only the ramps are too short."""
    trial = trials.fastest(2 * number)
    demand = max(
        (one for one in trial.demands if one.kind in ("velocity", "motor speed")), key=lambda one: one.segment
    )
    if demand.segment <= segment:
        return None
    return refusal_of(trial, demand, segment)


def _blends(number: int) -> list[int]:
    """Lengths of a blend to try, each somewhat longer than the one before, up to one that leaves no cruise."""
    lengths = np.unique(np.round(np.geomspace(FEWEST_IN_BLEND, number, 24)).astype(int))
    return [int(length) for length in lengths]


def _shortest_blend(trials: Trials, number: int, blend: int, segment: float) -> Trial:
    """The trial with the shortest blend that keeps the limits, not longer than one that does."""
    longest = blend
    shortest = max(FEWEST_IN_BLEND, int(blend / 1.5) - 1)
    best = trials.within(number + longest, segment)
    while shortest < longest:
        middle = (shortest + longest) // 2
        trial = trials.within(number + middle, segment)
        if trial.demand.segment <= segment:
            best, longest = trial, middle
        else:
            shortest = middle + 1
    return best


def _law(number: int) -> Law:
    """Cruise at the speed that takes `number` segments for the whole way; n segments leave the rest for one blend."""

    def forms(segments: int) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
        blend = segments - number
        ramps = np.arange(max(1, blend // 2), 0, -1)
        return np.stack((np.full_like(ramps, blend), ramps), axis=1)

    def control(segments: int, form: Form) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        return trapezoid(segments, *form)

    return Law(lambda u: u, control, forms, trapezoid_strain)


def _share(path: Path, cruise: float, bounds: Bounds, grid: Grid, tolerance: Tolerance) -> float:
    """The share of a speed, whose way takes `cruise` [s], that works; 0 where none is found."""
    low, high = 0.0, 1.0
    for _ in range(16):
        middle = 0.5 * (low + high) if low else 0.3 * high
        if isinstance(_tried(path, cruise / middle, bounds, grid, tolerance), Curve):
            low = middle
        else:
            high = middle
        if low and high / low < 1.005:
            break
    return low
