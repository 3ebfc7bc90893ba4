"""Fitting a law of motion and a path to the controller's segments.

The control points don't depend on the segment time: once they are known, the shortest time in
which they keep all limits is a closed form. The number of segments, the ramps and the segment time
are chosen here, and a time that is too short is answered with one that is not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from yarclang.hir import Array
from yarclang.motion.curve import Curve, knot_values, middle_values, through_knots
from yarclang.motion.limits import Bounds, Demand, Grid
from yarclang.motion.path import Path
from yarclang.motion.profile import Profile
from yarclang.robot.model import Tolerance

MORE_SEGMENTS = 4
"""How many numbers of segments beyond the fewest are tried for the shortest time: blends and ramps are whole segments."""

MOST_MORE = 3 * MORE_SEGMENTS
"""How many are tried in a given time: so many that each shortest time is found again."""

MOST_SEGMENTS = 100_000
"""A motion of more segments (83 minutes at 50 ms) is refused: near a singularity the shortest time has no bound."""

_SHARE_OF_TOLERANCE = 0.7
"""The deviation is looked at in the middle of each segment; the proof of it comes later."""


@dataclass(frozen=True, slots=True)
class TooFast:
    """A limit is broken in the given time.

    `share` is how much of the limit is used (1 is all of it), `time` [s] and `s` say where, `shortest` [s] is a
    duration that was tried and works (infinite where none does). `demand` is None where only the controller's
    segments are too coarse.
    """

    demand: Demand | None
    share: float
    time: float
    s: float
    shortest: float


@dataclass(frozen=True, slots=True)
class NotHeld:
    """The path can't be held: what it misses by [m], [rad], at the shortest segments."""

    position: float
    angle: float
    segment: float


@dataclass(frozen=True, slots=True)
class TooLong:
    """The motion would need more segments than are ever planned: at least `duration` [s]."""

    duration: float


@dataclass(frozen=True, slots=True, eq=False)
class _Trial:
    """Control points for a number of segments and a ramp, and what the limits ask of them."""

    segments: int
    ramp: int
    control: Array
    points: Array
    demands: tuple[Demand, ...]

    @property
    def demand(self) -> Demand:
        """The limit that asks most."""
        return max(self.demands, key=_segment)


def fit(
    path: Path, profile: Profile, duration: float | None, bounds: Bounds, grid: Grid, tolerance: Tolerance
) -> Curve | TooFast | NotHeld | TooLong:
    """Choose segments, ramp and segment time of a motion along a path.

    Args:
        path: the way.
        profile: the law of motion.
        duration: [s], or None for the shortest that the limits allow.
        bounds: the limits to keep.
        grid: the segment times that the controller takes.
        tolerance: how far the executed path may be from `path`.

    Returns:
        The curve; its duration is the given one but for the controller's step of the segment time.
    """
    fitter = _Fitter(path, profile, bounds, grid, tolerance)
    if duration is None:
        return fitter.shortest()
    if grid.fewest(duration) > MOST_SEGMENTS:
        return TooLong(duration)
    fitted = fitter.in_time(duration)
    if not isinstance(fitted, TooFast):
        return fitted
    fastest = fitter.shortest()
    if isinstance(fastest, NotHeld):
        return fastest
    if isinstance(fastest, TooLong):
        return fitted
    return TooFast(fitted.demand, fitted.share, fitted.time, fitted.s, fitter.usable(fastest.duration))


@dataclass(slots=True)
class _Fitter:
    path: Path
    profile: Profile
    bounds: Bounds
    grid: Grid
    tolerance: Tolerance
    trials: dict[tuple[int, int], _Trial] = field(default_factory=dict)

    def in_time(self, duration: float) -> Curve | TooFast | NotHeld:
        """A curve of the given duration; a TooFast of this has no `shortest` yet."""
        fewest = self.grid.fewest(duration)
        refusal: TooFast | None = None
        segments = fewest
        while segments <= fewest + MOST_MORE:
            segment = self.grid.nearest(duration / segments)
            if segment < self.grid.smallest:
                break
            trial = self.within(segments, segment)
            demand = trial.demand
            if demand.segment <= segment:
                better = self.segments_for_tolerance(trial)
                if better is None:
                    return Curve(_constant(trial.points), segment, trial.control)
                if duration / better < self.grid.smallest:
                    return NotHeld(*self.deviation(trial), segment)
                fewest = segments = better
                continue
            refusal = refusal or _refusal(trial, demand, segment)
            if demand.segment > (1.25 if segments > 2 * MOST_MORE else 1.6) * segment:
                break
            segments += 1
        return refusal or TooFast(None, math.inf, 0.0, 0.0, math.inf)

    def shortest(self) -> Curve | NotHeld | TooLong:
        """The curve of the shortest duration."""
        segments = 24
        for _ in range(8):
            needed = self.needed(self.fastest(segments))
            if needed == segments or needed > MOST_SEGMENTS:
                break
            segments = needed
        while segments <= MOST_SEGMENTS:
            best = self.best_of(segments)
            if self.grid.not_below(best.demand.segment) > self.grid.largest:
                # beside a singularity more segments find a higher peak: take as many as that needs
                segments = max(segments + MORE_SEGMENTS + 1, self.needed(best))
                continue
            better = self.segments_for_tolerance(best)
            if better is None:
                return Curve(_constant(best.points), self.grid.not_below(best.demand.segment), best.control)
            shortest = best.segments * max(best.demand.segment, self.grid.smallest)
            if better * self.grid.smallest > 2.0 * shortest:
                return NotHeld(*self.deviation(best), self.grid.smallest)
            segments = better
        return TooLong(segments * self.grid.largest)

    def needed(self, trial: _Trial) -> int:
        """The fewest segments of the duration that a trial needs."""
        return self.grid.fewest(trial.segments * max(trial.demand.segment, self.grid.smallest))

    def best_of(self, segments: int) -> _Trial:
        """The fastest of a few numbers of segments from `segments` on, if possible one with segments that
        aren't too long.
        """
        trials = [self.fastest(number) for number in range(segments, segments + MORE_SEGMENTS + 1)]

        def duration(trial: _Trial) -> tuple[bool, float]:
            segment = self.grid.not_below(trial.demand.segment)
            return segment > self.grid.largest, trial.segments * segment

        return min(trials, key=duration)

    def usable(self, duration: float) -> float:
        """A duration of few digits, not below `duration` [s], that works when it is given."""
        digits = max(3, 2 - math.floor(math.log10(max(duration, 1e-9))))
        step = 10.0**-digits
        for _ in range(60):
            duration = math.ceil(duration / step - 1e-9) * step
            if isinstance(self.in_time(round(duration, digits)), Curve):
                break
            duration += max(step, 2e-3 * duration)
        return round(duration, digits)

    def within(self, segments: int, segment: float) -> _Trial:
        """The trial with the shortest ramp that keeps the limits at a segment time, or the fastest one."""
        longest = self.profile.longest_ramp(segments)
        ramp = self.likely_ramp(segments, segment)
        trial = self.trial(segments, ramp)
        if trial.demand.segment <= segment:
            while ramp > 1 and self.foreseen(trial, ramp - 1) <= segment:
                shorter = self.trial(segments, ramp - 1)
                if shorter.demand.segment > segment:
                    break
                trial, ramp = shorter, ramp - 1
            return trial
        for ramp in range(1, longest + 1):
            if self.foreseen(trial, ramp) <= segment:
                trial = self.trial(segments, ramp)
                if trial.demand.segment <= segment:
                    return trial
        return self.fastest(segments)

    def likely_ramp(self, segments: int, segment: float) -> int:
        """About the shortest ramp that keeps the limits, from the steepest slope of the path alone."""
        slope, bounds = self.path.slope, self.bounds
        velocity = (slope / bounds.velocity).max()
        acceleration, jerk = (slope / bounds.acceleration).max(), (slope / bounds.jerk).max()
        for ramp in range(1, self.profile.longest_ramp(segments) + 1):
            strain = self.profile.strain(segments, ramp)
            need = max(
                strain[0] * velocity, (strain[1] * acceleration) ** (1 / 2), (strain[2] * jerk) ** (1 / 3)
            )
            if need <= segment:
                return ramp
        return 1

    def fastest(self, segments: int) -> _Trial:
        """The trial with the ramp that needs the shortest segments."""
        trial = self.trial(segments, 1)
        longest = self.profile.longest_ramp(segments)
        if longest == 1:
            return trial
        ramp = min(range(1, longest + 1), key=lambda ramp: self.foreseen(trial, ramp))
        return min((trial, self.trial(segments, ramp)), key=lambda trial: trial.demand.segment)

    def foreseen(self, trial: _Trial, ramp: int) -> float:
        """About the segment time that another ramp would need: exact for straight lines in joint space."""
        had = self.profile.strain(trial.segments, trial.ramp)
        gets = self.profile.strain(trial.segments, ramp)
        velocity, motors, acceleration, jerk = (demand.segment for demand in trial.demands)
        needed: float = max(
            max(velocity, motors) * gets[0] / had[0],
            acceleration * (gets[1] / had[1]) ** (1 / 2),
            jerk * (gets[2] / had[2]) ** (1 / 3),
        )
        return needed

    def trial(self, segments: int, ramp: int) -> _Trial:
        """The control points for a number of segments and a ramp."""
        known = self.trials.get((segments, ramp))
        if known is not None:
            return known
        control = self.profile.control(segments, ramp)
        start, end = self.path.start, self.path.end
        if self.path.is_straight_in_joints:
            points = start + control[:, None] * (end - start)
            points[-3:] = end
        else:
            points = through_knots(self.path.joints(knot_values(control)[2:-2]), start, end)
        made = _Trial(segments, ramp, control, points, self.bounds.demands(points))
        self.trials[segments, ramp] = made
        return made

    def deviation(self, trial: _Trial) -> tuple[float, float]:
        """How far the curve is from the path, in the middle of the segments and at the knots [m], [rad]."""
        # the knots 2 to n - 2 were solved
        q = np.concatenate((knot_values(trial.points)[[1, -2]], middle_values(trial.points)))
        s = np.concatenate((knot_values(trial.control)[[1, -2]], middle_values(trial.control)))
        return self.path.deviation(q, s)

    def segments_for_tolerance(self, trial: _Trial) -> int | None:
        """How many segments are needed to hold the path; None where the trial holds it."""
        if self.path.is_straight_in_joints:
            return None
        position, angle = self.deviation(trial)
        excess = max(position / self.tolerance.position, angle / self.tolerance.angle) / _SHARE_OF_TOLERANCE
        if excess <= 1.0:
            return None
        # the error falls with the fourth power of the number of segments
        return max(trial.segments + 1, math.ceil(trial.segments * math.pow(min(excess, 256.0), 0.25)))


def _segment(demand: Demand) -> float:
    return demand.segment


def _refusal(trial: _Trial, demand: Demand, segment: float) -> TooFast:
    order = {"velocity": 1, "motor speed": 1, "acceleration": 2, "jerk": 3}[demand.kind]
    # a difference of order r from control point i on belongs to knots i + r/2 - 1 (points stand one knot ahead)
    knot = min(max(demand.at + order / 2.0 - 1.0, 0.0), float(trial.segments))
    s = float(np.interp(knot, np.arange(trial.segments + 1), knot_values(trial.control)))
    return TooFast(demand, (demand.segment / segment) ** order, knot * segment, s, math.inf)


def _constant(points: Array) -> Array:
    points.setflags(write=False)
    return points
