"""Trials: a path and a law on a number of segments, and what the limits ask of the segment time then.

The control points don't depend on the segment time: once they are known, the shortest time in
which they keep all limits is a closed form.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.curve import knot_values, middle_values, through_knots
from yarclang.motion.limits import Bounds, Demand
from yarclang.motion.path import Path
from yarclang.motion.profile import Form, Law
from yarclang.progress import go_on
from yarclang.robot.model import Tolerance

_SHARE_OF_TOLERANCE = 0.7
"""The deviation is looked at in the middle of each segment; the proof of it comes later."""


MANY_SEGMENTS = 24
"""So many that the form of a law hardly depends on their number any more."""


@frozen(eq=False)
class Trial:
    """Control points for a number of segments and a form of the law, and what the limits ask of them."""

    segments: int
    form: Form
    control: Array
    points: Array
    demands: tuple[Demand, ...]

    @property
    def demand(self) -> Demand:
        """The limit that asks most."""
        return max(self.demands, key=lambda demand: demand.segment)


@dataclass(slots=True)
class Trials:
    """All trials of a path under one law; each is made once."""

    path: Path
    law: Law
    bounds: Bounds
    tolerance: Tolerance
    _made: dict[tuple[int, Form], Trial] = field(default_factory=dict)
    _fastest: dict[int, Trial] = field(default_factory=dict)

    def trial(self, segments: int, form: Form) -> Trial:
        """The control points for a number of segments and a form."""
        return self.trials([(segments, form)])[0]

    def trials(self, wanted: Sequence[tuple[int, Form]]) -> list[Trial]:
        """The same for many at once: their joint positions are solved together."""
        go_on()
        missing = [one for one in dict.fromkeys(wanted) if one not in self._made]
        controls = [self.law.control(segments, form) for segments, form in missing]
        for (segments, form), control, points in zip(missing, controls, self._points(controls), strict=True):
            self._made[segments, form] = Trial(segments, form, control, points, self.bounds.demands(points))
        return [self._made[one] for one in wanted]

    def _points(self, controls: list[Array]) -> list[Array]:
        """The control points of the joints for control values of the share of the way."""
        start, end = self.path.start, self.path.end
        if not controls:
            return []
        if self.path.is_straight_in_joints:
            straight = [start + control[:, None] * (end - start) for control in controls]
            for points in straight:
                points[-3:] = end
            return straight
        knots = [knot_values(control)[2:-2] for control in controls]
        q = self.path.joints(np.concatenate(knots))
        stops = np.cumsum([len(one) for one in knots])[:-1]
        return [through_knots(part, start, end) for part in np.split(q, stops)]

    def within(self, segments: int, segment: float) -> Trial:
        """The trial with the first form that keeps the limits at a segment time, or the fastest one."""
        forms = self.law.forms(segments)
        first = self._likely(segments, forms, segment)
        trial = self.trial(segments, _form(forms[first]))
        if trial.demand.segment <= segment:
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
        """The trial with the form that needs the shortest segments."""
        return self.fastest_of([segments])[0]

    def fastest_of(self, numbers: Sequence[int]) -> list[Trial]:
        """The same for each number of segments."""
        missing = [number for number in numbers if number not in self._fastest]
        self._fastest.update(zip(missing, self._looked_for(missing), strict=True))
        return [self._fastest[number] for number in numbers]

    def _looked_for(self, numbers: list[int]) -> list[Trial]:
        forms = [self.law.forms(number) for number in numbers]
        likely = [
            each[int(np.argmin(self._from_slope(number, each)))] if len(each) > 1 else each[0]
            for number, each in zip(numbers, forms, strict=True)
        ]
        best = self.trials([(number, _form(row)) for number, row in zip(numbers, likely, strict=True)])
        improving = [place for place, each in enumerate(forms) if len(each) > 1]
        for _ in range(3):
            nearer = [
                forms[place][int(np.argmin(self._foreseen(best[place], forms[place])))] for place in improving
            ]
            better = self.trials(
                [(numbers[place], _form(row)) for place, row in zip(improving, nearer, strict=True)]
            )
            quicker = {
                place: one
                for place, one in zip(improving, better, strict=True)
                if one.demand.segment < best[place].demand.segment
            }
            for place, one in quicker.items():
                best[place] = one
            improving = list(quicker)
        return best

    def foreseen_least(self, trial: Trial, numbers: range) -> list[float]:
        """About the shortest segment times [s] of other numbers of segments: exact for straight lines in joint space."""
        return [float(self._foreseen(trial, self.law.forms(number), number).min()) for number in numbers]

    def foreseen_shortest(self) -> float:
        """About the shortest duration [s], from the steepest slope of the path alone, unless the law knows it."""
        if self.law.shortest is not None:
            return self.law.shortest
        return MANY_SEGMENTS * float(self._from_slope(MANY_SEGMENTS, self.law.forms(MANY_SEGMENTS)).min())

    def deviation(self, trial: Trial) -> tuple[float, float]:
        """How far the curve is from the path, in the middle of the segments and at the knots [m], [rad]."""
        # the knots 2 to n - 2 were solved
        q = np.concatenate((knot_values(trial.points)[[1, -2]], middle_values(trial.points)))
        s = np.concatenate((knot_values(trial.control)[[1, -2]], middle_values(trial.control)))
        return self.path.deviation(q, s)

    def segments_for_tolerance(self, trial: Trial) -> int | None:
        """How many segments are needed to hold the path; None where the trial holds it."""
        if self.path.is_straight_in_joints:
            return None
        go_on()
        position, angle = self.deviation(trial)
        excess = max(position / self.tolerance.position, angle / self.tolerance.angle) / _SHARE_OF_TOLERANCE
        if excess <= 1.0:
            return None
        # the error falls with the fourth power of the number of segments
        return max(trial.segments + 1, math.ceil(trial.segments * math.pow(min(excess, 256.0), 0.25)))

    def _likely(self, segments: int, forms: NDArray[np.int64], segment: float) -> int:
        """About the first form that keeps the limits."""
        keeping = self._from_slope(segments, forms) <= segment
        return int(np.argmax(keeping))

    def _from_slope(self, segments: int, forms: NDArray[np.int64]) -> Array:
        """About the segment times (K,) that forms need, from the steepest slope of the path alone."""
        slope, bounds = self.path.slope, self.bounds
        strain = self.law.strain(segments, forms)
        rates = np.array(
            [(slope / limit).max() for limit in (bounds.velocity, bounds.acceleration, bounds.jerk)]
        )
        needed: Array = ((strain * rates) ** (1.0 / np.arange(1, 4))).max(axis=1)
        return needed

    def _foreseen(self, trial: Trial, forms: NDArray[np.int64], segments: int | None = None) -> Array:
        """About the segment times (K,) that other forms, of as many segments or others, would need: exact for straight
        lines in joint space.
        """
        had = self.law.strain(trial.segments, np.array([trial.form], dtype=np.int64))[0]
        gets = self.law.strain(segments or trial.segments, forms)
        velocity, motors, acceleration, jerk, *zones = (demand.segment for demand in trial.demands)
        asked = np.array([max(velocity, motors, *zones), acceleration, jerk])
        needed: Array = (asked * (gets / had) ** (1.0 / np.arange(1, 4))).max(axis=1)
        return needed


def _form(row: NDArray[np.int64]) -> Form:
    return tuple(row.tolist())
