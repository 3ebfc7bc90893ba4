"""Try a motion profile along a path with a number of segments, and compute the segment time that each limit
requires.

The control points don't depend on the segment time. Once they are known, the shortest segment time with which
they keep all limits follows in closed form.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath, deviations, joints_of
from yarclang.motion.curve import knot_values, middle_values, through_knots
from yarclang.motion.limits import Bounds, Demand
from yarclang.motion.path import Path
from yarclang.motion.paths.pose_spline import AtConstantSpeed, PoseSpline
from yarclang.motion.profile import Form, Law
from yarclang.motion.smooth import MANY, Smooth, smooth
from yarclang.progress import go_on
from yarclang.robot.model import Tolerance

_SHARE_OF_TOLERANCE = 0.7
"""Share of the tolerance that the planner uses. The rest is a reserve, since the deviation is only sampled,
in the middle of each segment, and the proof is made later.
"""

_SHARE_OF_SPLINE = 0.55
"""Share of the tolerance that the planner uses for a spline of poses, instead of `_SHARE_OF_TOLERANCE`. Such
a spline may bend sharply between its waypoints, and samples may miss this.
"""


_KEPT = 200_000
"""Largest number of segments in all stored trials of a motion, about 10 MB of control points."""

_FAR = 3.0
"""Factor by which a segment time must exceed the estimated one for the motion to be certainly far from every
speed limit. The estimate uses the steepest slope of the path.
"""

MANY_SEGMENTS = 24
"""Number of segments above which the best form of a motion profile hardly depends on their number."""


@frozen(eq=False)
class Trial:
    """The control points of a motion, for a number of segments and a form of its profile, and the shortest
    segment time with which they keep each limit.
    """

    segments: int
    form: Form
    control: Array
    points: Array
    demands: tuple[Demand, ...]

    @property
    def demand(self) -> Demand:
        """The limit that requires the longest segments, with the segment time that it requires."""
        return max(self.demands, key=lambda demand: demand.segment)


@dataclass(slots=True)
class Trials:
    """All trials of a path with one motion profile. Each trial is made only once."""

    path: Path
    law: Law
    bounds: Bounds
    tolerance: Tolerance
    _made: dict[tuple[int, Form], Trial] = field(default_factory=dict)
    _fastest: dict[int, Trial] = field(default_factory=dict)
    _deviations: dict[tuple[int, Form], tuple[float, float]] = field(default_factory=dict)
    _first: dict[tuple[int, float], int] = field(default_factory=dict)
    _rates: Array | None = None
    """The steepest slope of the path, divided by the limits of velocity, acceleration and jerk, (3,)."""
    _smooth: Smooth | None = None
    _is_smooth_known: bool = False

    def trial(self, segments: int, form: Form) -> Trial:
        """Return the trial with a given number of segments and a given form of the profile."""
        return self.trials([(segments, form)])[0]

    def trials(self, wanted: Sequence[tuple[int, Form]]) -> list[Trial]:
        """Return several trials, each for a number of segments and a form. Inverse kinematics is solved for
        all together.
        """
        return _made([(self, segments, form) for segments, form in wanted])

    def within(self, segments: int, segment: float) -> Trial:
        """Return the trial of the first form that keeps the limits with a segment time [s]. If no form does,
        return the fastest trial.
        """
        forms = self.law.forms(segments)
        first = self._likely(segments, forms, segment)
        trial = self.trial(segments, _form(forms[first]))
        if trial.demand.segment <= segment:
            # The first form is the most similar to the pure profile: go back towards it as long as the limits
            # are kept.
            while first and self._foreseen(trial, forms[first - 1 : first])[0] <= segment:
                nearer = self.trial(segments, _form(forms[first - 1]))
                if nearer.demand.segment > segment:
                    break
                trial, first = nearer, first - 1
            return trial
        for place in np.flatnonzero(self._foreseen(trial, forms) <= segment).tolist():
            trial = self.trial(segments, _form(forms[place]))
            if trial.demand.segment <= segment:
                return trial
        return self.fastest(segments)

    def fastest(self, segments: int) -> Trial:
        """Return the trial of the form that keeps the limits with the shortest segments."""
        return self.fastest_of([segments])[0]

    def fastest_of(self, numbers: Sequence[int]) -> list[Trial]:
        """Return the fastest trial for each number of segments."""
        look_together([(self, number) for number in numbers])
        return [self._fastest[number] for number in numbers]

    def foreseen_least(self, trial: Trial, numbers: range) -> list[float]:
        """From one trial, estimate the shortest segment time [s] for each of several other numbers of
        segments.

        The estimate is exact for straight lines in joint space.
        """
        return [float(self._foreseen(trial, self.law.forms(number), number).min()) for number in numbers]

    def foreseen_shortest(self) -> float:
        """Return the shortest duration [s] that the motion profile gives. If it gives none, estimate the
        duration from the steepest slope of the path.
        """
        if self.law.shortest is not None:
            return self.law.shortest
        return MANY_SEGMENTS * float(self._from_slope(MANY_SEGMENTS, self.law.forms(MANY_SEGMENTS)).min())

    def is_slow(self, segments: int, segment: float) -> bool:
        """Return True if motions with segments of a given time [s] are far from every speed limit, for all
        forms of the profile.

        With slow zones, the result is always False.
        """
        bounds, slope = self.bounds, self.path.slope
        if bounds.zones is not None:
            return False
        # A joint or motor reaches its speed limit at this segment time: the largest speed of the profile
        # [paths per segment] times the path's slope, divided by the limit.
        peak = float(self.law.strain(segments, self.law.forms(segments))[:, 0].max())
        share = max(
            (slope / bounds.velocity).max(),
            (np.abs(bounds.counts) @ slope / bounds.motor_velocity).max(),
        )
        return bool(_FAR * peak * share <= segment)

    def deviation(self, trial: Trial) -> tuple[float, float]:
        """Return the largest distance [m] and angle [rad] between the curve of a trial and the path. Both are
        sampled: in the middle of the segments, and at the knots next to the start and the end.
        """
        known = self._deviations.get((trial.segments, trial.form)) or self._surely(trial)
        return known or self.path.deviation(_looked_at(trial.points), _looked_at(trial.control))

    def segments_for_tolerance(self, trial: Trial) -> int | None:
        """Return the number of segments with which the curve stays within the tolerance; None if the trial's
        number already suffices.
        """
        if self.path.is_straight_in_joints:
            return None
        go_on()
        position, angle = self.deviation(trial)
        is_spline = isinstance(self.path, CartesianPath) and isinstance(
            self.path.frame, PoseSpline | AtConstantSpeed
        )
        excess = max(position / self.tolerance.position, angle / self.tolerance.angle)
        excess /= _SHARE_OF_SPLINE if is_spline else _SHARE_OF_TOLERANCE
        if excess <= 1.0:
            return None
        # The error is proportional to 1 / n^4 for n segments.
        return max(trial.segments + 1, math.ceil(trial.segments * math.pow(min(excess, 256.0), 0.25)))

    def _surely(self, trial: Trial) -> tuple[float, float] | None:
        """Return upper bounds of the distance [m] and the angle [rad] between the curve of a trial with many
        segments and the path.

        The result is None if no such bounds are known, or if they don't prove that the tolerance is kept.
        """
        if self._smooth is None or trial.segments < MANY:
            return None
        position, angle = self._smooth.deviation(_looked_at(trial.points), _looked_at(trial.control))
        excess = max(position / self.tolerance.position, angle / self.tolerance.angle)
        return (position, angle) if excess <= _SHARE_OF_TOLERANCE else None

    def _forget(self) -> None:
        """Drop the oldest trials until all of them together have few enough segments. Otherwise a long motion
        would fill the memory.
        """
        kept = sum(segments for segments, _ in self._made)
        for key in list(self._made)[:-1]:
            if kept <= _KEPT:
                break
            kept -= key[0]
            del self._made[key]

    def _likely(self, segments: int, forms: NDArray[np.int64], segment: float) -> int:
        """Estimate the index of the first form of the profile that keeps the limits with a segment time
        [s].
        """
        first = self._first.get((segments, segment))
        if first is None:
            first = int(np.argmax(self._from_slope(segments, forms) <= segment))
            self._first[segments, segment] = first
        return first

    def _from_slope(self, segments: int, forms: NDArray[np.int64]) -> Array:
        """Estimate the segment times (K,) that K forms of the profile need. The estimate uses only the
        steepest slope of the path.
        """
        strain = self.law.strain(segments, forms)
        if self._rates is None:
            slope, bounds = self.path.slope, self.bounds
            limits = (bounds.velocity, bounds.acceleration, bounds.jerk)
            self._rates = np.array([(slope / limit).max() for limit in limits])
        # A derivative of order k scales with 1 / h^k. For its share of the joint's limit to become 1, the
        # segment time is multiplied by the k-th root of this share.
        needed: Array = ((strain * self._rates) ** (1.0 / np.arange(1, 4))).max(axis=1)
        return needed

    def _foreseen(self, trial: Trial, forms: NDArray[np.int64], segments: int | None = None) -> Array:
        """From a trial, estimate the segment times (K,) that other forms of the profile need, with the same
        or another number of segments.

        The estimate is exact for straight lines in joint space.
        """
        had = self.law.strain(trial.segments, np.array([trial.form], dtype=np.int64))[0]
        gets = self.law.strain(segments or trial.segments, forms)
        velocity, motors, acceleration, jerk, *zones = (demand.segment for demand in trial.demands)
        asked = np.array([max(velocity, motors, *zones), acceleration, jerk])
        # The needed shares of the limits grow with the profile's peaks of velocity, acceleration and jerk.
        # The needed segment times grow with the first, second and third roots of these shares.
        needed: Array = (asked * (gets / had) ** (1.0 / np.arange(1, 4))).max(axis=1)
        return needed


def try_together(all_trials: Sequence[Trials], wanted: Sequence[tuple[int, float]]) -> None:
    """For many paths together, make the first trial that `within` needs, and measure its deviation from the
    path.

    Args:
        all_trials: trials of paths of one arm and one moving frame.
        wanted: for each path, the number of segments and the segment time [s].
    """
    first = list[tuple[Trials, int, Form]]()
    for trials, (segments, segment) in zip(all_trials, wanted, strict=True):
        rows = trials.law.forms(segments)
        first.append((trials, segments, _form(rows[trials._likely(segments, rows, segment)])))
    find_deviations(list(zip(all_trials, _made(first), strict=True)))


def find_deviations(made: Sequence[tuple[Trials, Trial]]) -> None:
    """Measure the deviations of several trials' curves from their paths, all together. The Cartesian paths
    must be of one arm and one moving frame.
    """
    cartesian = [
        (trials, trial, trials.path) for trials, trial in made if isinstance(trials.path, CartesianPath)
    ]
    for trials, trial, _ in cartesian:
        if (surely := trials._surely(trial)) is not None:
            trials._deviations[trial.segments, trial.form] = surely
    cartesian = [one for one in cartesian if (one[1].segments, one[1].form) not in one[0]._deviations]
    if not cartesian:
        return
    go_on()
    found = deviations(
        [path for _, _, path in cartesian],
        [_looked_at(trial.points) for _, trial, _ in cartesian],
        [_looked_at(trial.control) for _, trial, _ in cartesian],
    )
    for (trials, trial, _), missed in zip(cartesian, found, strict=True):
        trials._deviations[trial.segments, trial.form] = missed


def look_together(wanted: Sequence[tuple[Trials, int]]) -> None:
    """For several paths together, find the form of the profile that needs the shortest segments. The paths
    must be of one arm and one moving frame.

    `wanted` has, for each path, its trials and the number of segments.
    """
    wanted = [(trials, number) for trials, number in wanted if number not in trials._fastest]
    forms = [trials.law.forms(number) for trials, number in wanted]
    likely = [
        each[int(np.argmin(trials._from_slope(number, each)))] if len(each) > 1 else each[0]
        for (trials, number), each in zip(wanted, forms, strict=True)
    ]
    best = _made([(*one, _form(row)) for one, row in zip(wanted, likely, strict=True)])
    improving = [place for place, each in enumerate(forms) if len(each) > 1]
    for _ in range(3):
        # Up to three times, improve each estimate by the result of the trial that was just made.
        nearer = [
            forms[place][int(np.argmin(wanted[place][0]._foreseen(best[place], forms[place])))]
            for place in improving
        ]
        better = _made([(*wanted[place], _form(row)) for place, row in zip(improving, nearer, strict=True)])
        quicker = {
            place: one
            for place, one in zip(improving, better, strict=True)
            if one.demand.segment < best[place].demand.segment
        }
        for place, one in quicker.items():
            best[place] = one
        improving = list(quicker)
    for (trials, number), one in zip(wanted, best, strict=True):
        trials._fastest[number] = one


def _made(wanted: Sequence[tuple[Trials, int, Form]]) -> list[Trial]:
    """Return trials of paths of one arm and one moving frame, each for a number of segments and a form.

    Missing trials are made together.
    """
    go_on()
    missing: dict[int, tuple[Trials, dict[tuple[int, Form], Array]]] = {}
    for trials, segments, form in wanted:
        if (segments, form) not in trials._made:
            controls = missing.setdefault(id(trials), (trials, {}))[1]
            if (segments, form) not in controls:
                controls[segments, form] = trials.law.control(segments, form)
    together = [(trials, list(controls.values())) for trials, controls in missing.values()]
    for (trials, controls), points in zip(missing.values(), _points(together), strict=True):
        for (key, control), made in zip(controls.items(), points, strict=True):
            trials._made[key] = Trial(*key, control, made, trials.bounds.demands(made))
    found = [trials._made[segments, form] for trials, segments, form in wanted]
    for trials, _ in missing.values():
        trials._forget()
    return found


def _points(wanted: Sequence[tuple[Trials, list[Array]]]) -> list[list[Array]]:
    """Return the joints' control points for given trials of the law of motion.

    The law is a B-spline that gives the share of the path completed at each time. For each motion there are
    several arrays of the law's control values, one for each trial. The result has as many arrays of control
    points.
    """
    _smoothen([trials for trials, controls in wanted if any(len(one) - 3 >= MANY for one in controls)])
    control_points = list[list[Array]]()
    left = list[tuple[Path, Array]]()
    for trials, controls in wanted:
        path, own = trials.path, list[Array]()
        for control in controls:
            if path.is_straight_in_joints:
                own.append(_straight(path, control))
                continue
            knots = knot_values(control)[2:-2]
            if trials._smooth is not None and len(control) - 3 >= MANY:
                own.append(through_knots(trials._smooth.at(knots), path.start, path.end))
                continue
            own.append(_TO_SOLVE)
            left.append((path, knots))
        control_points.append(own)
    solved = iter(_solved(left))
    for (trials, _), own in zip(wanted, control_points, strict=True):
        path = trials.path
        own[:] = [
            through_knots(next(solved), path.start, path.end) if one is _TO_SOLVE else one for one in own
        ]
    return control_points


_TO_SOLVE = np.empty((0, 0))
"""Placeholder for control points that need inverse kinematics, which is solved for all together."""


def _smoothen(all_trials: Sequence[Trials]) -> None:
    """Approximate the joint positions along paths of one arm and one moving frame by polynomials, if not
    done yet.
    """
    unknown = [
        (trials, trials.path)
        for trials in all_trials
        if not trials._is_smooth_known and isinstance(trials.path, CartesianPath)
    ]
    if unknown:
        for (trials, _), one in zip(unknown, smooth([path for _, path in unknown]), strict=True):
            trials._smooth, trials._is_smooth_known = one, True


def _solved(wanted: Sequence[tuple[Path, Array]]) -> list[Array]:
    """Return for each path the joint positions (N, n) at its places (N,). Inverse kinematics is solved for
    all Cartesian paths together.
    """
    cartesian = [path for path, _ in wanted if isinstance(path, CartesianPath)]
    if len(cartesian) == len(wanted) > 1:
        return joints_of(cartesian, [knots for _, knots in wanted])
    return [path.joints(knots) for path, knots in wanted]


def _straight(path: Path, control: Array) -> Array:
    """Return the control points (N, n) of a line in joint space."""
    points: Array = path.start + control[:, None] * (path.end - path.start)
    points[-3:] = path.end
    return points


def _looked_at(points: Array) -> Array:
    """Return the values (n + 2, ...) of a curve at the places at which its distance from the path is sampled.
    `points` are the control points.

    The knots 2 to n - 2 are left out, since the curve passes through solved joint positions there.
    """
    return np.concatenate((knot_values(points)[[1, -2]], middle_values(points)))


def _form(row: NDArray[np.int64]) -> Form:
    return tuple(row.tolist())
