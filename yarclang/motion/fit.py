"""Fit a motion profile along a path to the controller's segments.

This module chooses the number of segments, the form of the profile and the segment time. If a given duration
is too short, the result contains a duration that works.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from yarclang.frozen import frozen
from yarclang.motion.curve import FEWEST_SEGMENTS, Curve, knot_values
from yarclang.motion.limits import Bounds, Demand, Grid
from yarclang.motion.path import Path
from yarclang.motion.profile import NoLaw, Profile
from yarclang.motion.trials import MANY_SEGMENTS, Trial, Trials, find_deviations, look_together
from yarclang.robot.model import Tolerance

MORE_SEGMENTS = 4
"""Number of additional segments that are tried for the shortest duration. Blends and ramps take integer
numbers of segments, so the fewest segments aren't always the fastest.
"""

MOST_MORE = 3 * MORE_SEGMENTS
"""Number of additional segments that are tried for a given duration. With this number, the curve is found
even if the given duration is the shortest one.
"""

FEW_SEGMENTS = 100
"""Number of segments up to which solving several trials together takes hardly longer than solving one of
them.
"""

_ROUNDS = 8
"""Largest number of rounds in which the number of segments is chosen anew, each time for the duration that
was required in the round before.
"""

_MUCH = 1.5
"""Factor in the duration above which a curve counts as much slower than its motion profile: `_MUCH` times the
profile's duration, plus `_FEW` [s].
"""

_FEW = 0.02
"""Difference of two durations that a few additional segments explain [s]; see `_MUCH`."""

MOST_SEGMENTS = 100_000
"""Largest number of segments of a motion (83 minutes at 50 ms). A longer motion is refused: near a
singularity, there is no bound for the shortest duration.
"""


@frozen
class TooFast:
    """A motion that breaks a limit in its given duration.

    `share` is the required multiple of the limit (1 is exactly the limit). The excess is at the time `time`
    [s] and the place `s` of the path. `shortest` [s] is a duration that was tried and works, infinite if none
    does. `demand` is None if only the controller's segments are too coarse.
    """

    demand: Demand | None
    share: float
    time: float
    s: float
    shortest: float


@frozen
class NotHeld:
    """A path that can't be followed within the tolerance, with the errors in position [m] and angle [rad]
    that the shortest segments leave.
    """

    position: float
    angle: float
    segment: float


@frozen
class TooLong:
    """A motion that needs more than `MOST_SEGMENTS` segments. It takes at least `duration` [s]."""

    duration: float


def fit(
    path: Path,
    profile: Profile,
    duration: float | None,
    bounds: Bounds,
    grid: Grid,
    tolerance: Tolerance,
    trials: Trials | None = None,
) -> Curve | TooFast | NotHeld | TooLong | NoLaw:
    """Choose the number of segments, the form of the profile and the segment time of a motion along a path.

    Args:
        path: the path.
        profile: the kind of motion profile.
        duration: the given duration [s], or None for the shortest that the limits allow.
        bounds: the limits to keep.
        grid: the segment times that the controller accepts.
        tolerance: largest distance of the executed path from `path`.
        trials: trials made earlier for the same arguments, or None.

    Returns:
        The curve, or the reason why there is none. The curve's duration is the given one, up to the
        controller's step of the segment time.
    """
    if not profile.has_jerk_limit:
        bounds = bounds.without_jerk()
    law = profile.law(path, bounds)
    if isinstance(law, NoLaw):
        return law
    trials = trials or Trials(path, law, bounds, tolerance)
    fitter = _Fitter.of(trials, profile, grid)
    if duration is None:
        return fitter.shortest()
    if grid.fewest(duration) > MOST_SEGMENTS:
        return TooLong(duration)
    fitted = fitter.in_time(duration)
    if not isinstance(fitted, TooFast):
        return fitted
    # The given duration is too short: find the shortest one, which the finding proposes.
    fastest = fitter.shortest()
    if isinstance(fastest, NotHeld):
        return fastest
    if isinstance(fastest, TooLong):
        return fitted
    return TooFast(fitted.demand, fitted.share, fitted.time, fitted.s, fitter.usable(fastest.duration))


def look_ahead(work: Sequence[tuple[Trials, Profile]], grid: Grid) -> None:
    """Make the trials for the shortest durations of several motions together. Later calls of `fit` use these
    trials.

    Args:
        work: for each motion, its trials and its profile; all paths are of one arm and one moving frame.
        grid: the segment times that the controller accepts.
    """
    fitters = [_Fitter.of(trials, profile, grid) for trials, profile in work]
    segments = [MANY_SEGMENTS] * len(fitters)
    needed = [fitter.needed_at_least() for fitter in fitters]
    for _ in range(_ROUNDS):
        # Continue with motions whose estimated number of segments still changes.
        going = [
            place for place, least in enumerate(needed) if least != segments[place] and least <= MOST_SEGMENTS
        ]
        if not going:
            break
        for place in going:
            segments[place] = needed[place]
        look_together(
            [
                (fitters[place].trials, number)
                for place in going
                for number in (
                    fitters[place].compared(segments[place])
                    if segments[place] <= FEW_SEGMENTS
                    else (segments[place],)
                )
            ]
        )
        for place in going:
            needed[place] = fitters[place].needed(fitters[place].trials.fastest(segments[place]))
    few = [place for place, number in enumerate(segments) if number <= FEW_SEGMENTS]
    look_together(
        [
            (fitters[place].trials, number)
            for place in few
            for number in fitters[place].compared(segments[place])
        ]
    )
    find_deviations([(fitters[place].trials, fitters[place].best_of(segments[place])) for place in few])


@dataclass(slots=True)
class _Fitter:
    """Search for the curve of one motion.

    `grid` has the segment times that the controller accepts. `quick` has only those that are used in
    the search for the motion's shortest duration (`Profile.longest_segment`).
    """

    trials: Trials
    profile: Profile
    grid: Grid
    quick: Grid
    _shortest: tuple[Curve, Trial] | NotHeld | TooLong | None = None

    @classmethod
    def of(cls, trials: Trials, profile: Profile, grid: Grid) -> _Fitter:
        """Return the search for the curve of a motion with the segment times of a grid."""
        quick = replace(grid, largest=max(grid.smallest, min(grid.largest, profile.longest_segment)))
        return cls(trials, profile, grid, quick)

    def needed_at_least(self) -> int:
        """Return the number of segments at which the search for the shortest duration begins."""
        return self.quick.fewest(max(self.trials.foreseen_shortest(), self.quick.smallest))

    def in_time(self, duration: float) -> Curve | TooFast | NotHeld:
        """Return a curve of the given duration, or the reason why there is none.

        If the reason is `TooFast`, its `shortest` isn't known yet.
        """
        fewest = self.grid.fewest(duration)
        refusal: TooFast | None = None
        segments = fewest
        while segments <= fewest + MOST_MORE:
            segment = self.grid.nearest(duration / segments)
            if segment < self.grid.smallest:
                break
            trial = self.stretched(segments, segment) if self.profile.is_stretched else None
            trial = trial or self.trials.within(segments, segment)
            demand = trial.demand
            if demand.segment <= segment:
                better = self.trials.segments_for_tolerance(trial)
                if better is None:
                    return curve_of(trial, segment)
                if duration / better < self.grid.smallest:
                    return NotHeld(*self.trials.deviation(trial), segment)
                fewest = segments = better
                continue
            refusal = refusal or refusal_of(trial, demand, segment)
            # The limit is exceeded by far: a few more segments won't help.
            if demand.segment > (1.25 if segments > 2 * MOST_MORE else 1.6) * segment:
                break
            segments += 1
        return refusal or TooFast(None, math.inf, 0.0, 0.0, math.inf)

    def stretched(self, segments: int, segment: float) -> Trial | None:
        """Stretch the motion profile of the shortest duration to `segments` segments, and return its trial.
        The result is None if the trial breaks a limit.
        """
        found = self.shortest_trial()
        if isinstance(found, NotHeld | TooLong):
            return None
        fastest = found[1]
        form = self.trials.law.scaled(fastest.segments, fastest.form, segments)
        trial = self.trials.trial(segments, form)
        return trial if trial.demand.segment <= segment else None

    def shortest(self) -> Curve | NotHeld | TooLong:
        """Return the curve of the shortest duration."""
        found = self.shortest_trial()
        return found if isinstance(found, NotHeld | TooLong) else found[0]

    def shortest_trial(self) -> tuple[Curve, Trial] | NotHeld | TooLong:
        """Return the curve of the shortest duration, and its trial. The result of the search is stored."""
        if self._shortest is None:
            self._shortest = self._coarser(self._search())
        return self._shortest

    def _coarser(
        self, found: tuple[Curve, Trial] | NotHeld | TooLong
    ) -> tuple[Curve, Trial] | NotHeld | TooLong:
        """Return a curve with longer segments if this makes the motion much faster than `found`, else
        `found`.

        This is tried only if `found` is much slower than the motion profile allows. Near a singularity, short
        segments follow peaks of joint speed. Longer segments cut off these peaks within the tolerance.
        """
        least = self.trials.law.shortest
        if least is None or (isinstance(found, tuple) and found[0].duration <= _MUCH * least + _FEW):
            return found
        segments = self.quick.fewest(least)
        while segments > FEWEST_SEGMENTS:
            # Try half the number of segments, each twice as long, then a quarter, and so on.
            segments = max(FEWEST_SEGMENTS, segments // 2)
            trial = self.best_of(segments)
            segment = self.quick.not_below(trial.demand.segment)
            if segment > self.grid.largest or self.trials.segments_for_tolerance(trial) is not None:
                continue
            if not isinstance(found, tuple) or _MUCH * trial.segments * segment < found[0].duration:
                found = curve_of(trial, segment), trial
        return found

    def _search(self) -> tuple[Curve, Trial] | NotHeld | TooLong:
        segments = MANY_SEGMENTS
        needed = self.needed_at_least()
        for _ in range(_ROUNDS):
            if needed == segments or needed > MOST_SEGMENTS:
                break
            segments = needed
            if segments <= FEW_SEGMENTS and not self.trials.path.is_straight_in_joints:
                # Compute several numbers of segments together: this takes hardly longer than the first one
                # alone.
                self.trials.fastest_of(self.compared(segments))
            needed = self.needed(self.trials.fastest(segments))
        while segments <= MOST_SEGMENTS:
            best = self.best_of(segments)
            if self.quick.not_below(best.demand.segment) > self.grid.largest:
                # Near a singularity, shorter segments follow a higher peak of speed: take as many segments as
                # the peak needs.
                segments = max(segments + MORE_SEGMENTS + 1, self.needed(best))
                continue
            better = self.trials.segments_for_tolerance(best)
            if better is None:
                return curve_of(best, self.quick.not_below(best.demand.segment)), best
            shortest = best.segments * max(best.demand.segment, self.quick.smallest)
            # Following the path would need segments shorter than the controller's smallest, or a motion that
            # takes much longer.
            if better * self.quick.smallest > 2.0 * shortest:
                return NotHeld(*self.trials.deviation(best), self.quick.smallest)
            segments = better
        return TooLong(segments * self.quick.largest)

    def needed(self, trial: Trial) -> int:
        """Return the fewest segments for the duration in which a trial keeps the limits."""
        return self.quick.fewest(trial.segments * max(trial.demand.segment, self.quick.smallest))

    def best_of(self, segments: int) -> Trial:
        """Return the fastest trial among several numbers of segments, from `segments` on.

        Trials whose segments aren't too long for the controller are preferred.
        """
        numbers = self.compared(segments)
        if self.profile.is_stretched and self.trials.path.is_straight_in_joints:
            # Segment times can be estimated for many numbers of segments without control points: compare more
            # numbers.
            numbers = self._likeliest(range(segments, segments + max(MORE_SEGMENTS, segments // 4) + 1))
        trials = self.trials.fastest_of(numbers)

        def duration(trial: Trial) -> tuple[bool, float]:
            segment = self.quick.not_below(trial.demand.segment)
            return segment > self.grid.largest, trial.segments * segment

        return min(trials, key=duration)

    def compared(self, segments: int) -> range:
        """Return the numbers of segments to compare, from `segments` on.

        For a profile without blends and ramps this is one number, since no part of it is rounded to whole
        segments.
        """
        more = MORE_SEGMENTS if self.trials.law.forms(segments).shape[1] else 0
        return range(segments, segments + more + 1)

    def _likeliest(self, numbers: range) -> range:
        """Return the number of segments that gives a straight line in joint space the shortest duration. The
        result is a range of length 1.
        """
        least = self.trials.foreseen_least(self.trials.fastest(numbers[0]), numbers)
        durations = [
            number * self.quick.not_below(segment) for number, segment in zip(numbers, least, strict=True)
        ]
        best = numbers[int(np.argmin(durations))]
        return range(best, best + 1)

    def usable(self, duration: float) -> float:
        """Return a duration with few digits that is at least `duration` [s], in which the motion can be
        planned.
        """
        # Round to milliseconds, or to three significant digits if this is finer.
        digits = max(3, 2 - math.floor(math.log10(max(duration, 1e-9))))
        step = 10.0**-digits
        for _ in range(60):
            duration = math.ceil(duration / step - 1e-9) * step
            if isinstance(self.in_time(round(duration, digits)), Curve):
                break
            duration += max(step, 2e-3 * duration)
        return round(duration, digits)


def curve_of(trial: Trial, segment: float) -> Curve:
    """Return the curve of a trial with segments of `segment` [s]."""
    trial.points.setflags(write=False)
    return Curve(trial.points, segment, trial.control)


def refusal_of(trial: Trial, demand: Demand, segment: float) -> TooFast:
    """Return the limit that a trial breaks at a segment time [s], with the place and the amount. `shortest`
    isn't known yet.
    """
    order = {"velocity": 1, "motor speed": 1, "zone speed": 1, "acceleration": 2, "jerk": 3}[demand.kind]
    # A difference of order r from control point i on belongs to knot i + r/2 - 1, since control points are
    # one knot ahead.
    knot = min(max(demand.at + order / 2.0 - 1.0, 0.0), float(trial.segments))
    s = float(np.interp(knot, np.arange(trial.segments + 1), knot_values(trial.control)))
    # A derivative of order r scales with 1 / h^r, so the required multiple of the limit is (needed h / given
    # h)^r.
    return TooFast(demand, (demand.segment / segment) ** order, knot * segment, s, math.inf)
