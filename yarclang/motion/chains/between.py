"""Plan one motion of a chain between its corners at a given cruise speed: try candidate motion profiles, and
take the first one that keeps the limits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, islice, repeat

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.chains.blend import Part
from yarclang.motion.chains.links import Link
from yarclang.motion.profile import NO_FORM, Law
from yarclang.motion.trapezoid import FEWEST_IN_BLEND, Ramp, between_ramps, to_rest
from yarclang.motion.trials import Trial, Trials

STEEPNESS = (0.5, 0.35, 0.25, 0.15, 0.08)
"""Steepnesses of a ramp that are tried, the gentlest first: the share of the ramp in which its acceleration
rises, and also that in which it falls again.
"""

_BY_ITS_WAY = 1.08
"""Factor by which the motion may exceed the limits in the middle third of its path. Above it, no other ramps
are tried, since no ramp makes the motion slower there.
"""

_AT_ONCE = 40
"""Number of motion profiles that are computed together if the first few break limits. Computing many together
takes hardly longer than computing a few.
"""


@frozen
class Turn:
    """The speed change at a corner: ramps of `width` segments, within an overlap of `overlap` segments.

    The acceleration of a ramp rises in `rise` segments. `asked` is the factor by which the motions must be
    slower to keep the limits at the corner.
    """

    width: int
    rise: int
    overlap: int
    asked: float


@frozen(eq=False)
class _Timed:
    """A candidate motion profile: control values (segments + 3,) of the completed share of the path.

    `into` and `out` are the lengths of the overlaps at start and end [segments]. `behind` is the phase of the
    last ramp: the time from the last knot before the ramp to the beginning of the ramp [segments].
    """

    control: Array
    into: int
    out: int
    behind: float


@frozen(eq=False)
class Between:
    """One motion to plan between two corners of a chain, with the segment time [s].

    `before` is the corner before the motion, None if the motion starts at rest. `behind` is the corner after
    it, None if it ends at rest. If the motion has a given duration, `middle` is its number of segments from
    the middle of one overlap to the middle of the next.
    """

    link: Link
    before: Turn | None
    behind: Turn | None
    middle: int | None
    segment: float

    def part(self, cruise: float, phase: float) -> tuple[Part | float, float]:
        """Plan the motion.

        Args:
            cruise: number of segments in which the whole path would be traversed at cruise speed.
            phase: time from a knot to the start of the last ramp of the motion before [segments]. The first
                ramp of this motion starts at the same time and is the mirror image of that ramp, so that
                both add up to a constant speed.

        Returns:
            The planned motion, and the phase of its last ramp [segments]. If the motion's own limits don't
            allow it: the factor (at least 1) by which the motion must be slower, as far as known, and 0 in
            place of the phase.
        """
        laws, asked = self._laws(cruise, phase), np.inf
        for count in chain([len(STEEPNESS)], repeat(_AT_ONCE)):
            tried = list(islice(laws, count))
            if not tried:
                break
            trials = self._tried(tried)
            middle_asks = self._asked_by(
                trials[0].points[trials[0].segments // 3 : 2 * trials[0].segments // 3 + 3]
            )
            for law, trial in zip(tried, trials, strict=True):
                more = self._asked(law, trial)
                if more <= 1.0 and self._keeps_zones(law, trial):
                    return Part(self.link.path, trial), law.behind
                asked = min(asked, more)
            if middle_asks > _BY_ITS_WAY:
                return middle_asks, 0.0
        return max(1.0, asked) if np.isfinite(asked) else 1.0, 0.0

    def _laws(self, cruise: float, phase: float) -> Iterator[_Timed]:
        """Yield the motion profiles to try, the most likely first."""
        into = self.before.overlap if self.before else 0
        for blend, share in self._ramps(cruise):
            rise = max(1, min(round(share * blend), blend // 2))
            before = self.before
            first = Ramp(phase, before.width, before.rise) if before else Ramp(0.0, blend, rise)
            if self.behind is None:
                # From the middle of the first ramp to the middle of the last one, the motion covers the whole
                # path in `cruise` segments.
                segments = math.ceil(first.middle + cruise + blend / 2.0 - 1e-9)
                if self.middle is not None:
                    segments = self.middle + into // 2
                if _has_room(segments, first, cruise):
                    yield _Timed(to_rest(segments, first, cruise, rise), into, 0, 0.0)
                continue
            turn = self.behind
            # The last ramp lies in the overlap with the next motion. It begins `last.start - knot` after a
            # knot, and the next motion's first ramp begins at the same time.
            last = Ramp(first.middle + cruise - turn.width / 2.0, turn.width, turn.rise)
            knot = int(last.start + 1e-9)
            if last.start < 0.0 or knot < into:
                continue
            # The motion ends with its overlap with the next motion.
            segments = knot + turn.overlap
            if first.start + first.width + 1 <= segments:
                yield _Timed(between_ramps(segments, first, last), into, turn.overlap, last.start - knot)

    def _ramps(self, cruise: float) -> Iterator[tuple[int, float]]:
        """Yield the length and the steepness of ramps from rest or to rest, the shortest ramps first.

        If the motion neither starts nor ends at rest, it needs no such ramp, and the only item is a
        placeholder.
        """
        if self.before and self.behind:
            yield 0, 0.0
            return
        lengths = [round(2.0 * (self.middle - cruise))] if self.middle is not None else self._lengths(cruise)
        for length in lengths:
            for share in STEEPNESS:
                yield length, share

    def _lengths(self, cruise: float) -> list[int]:
        # The joints reach their cruise speed, slope / (cruise h), within the ramp; h is the segment time.
        # With the acceleration limit a, the ramp takes at least slope / (cruise a h^2) segments.
        rate = (self.link.path.slope / cruise / self.link.own_bounds.acceleration).max() / self.segment**2
        least = max(FEWEST_IN_BLEND, int(rate))
        most = max(least + 2, int(2.0 * cruise))
        return [int(length) for length in np.unique(np.round(np.geomspace(least, most, 24)))]

    def _tried(self, laws: Sequence[_Timed]) -> list[Trial]:
        """Compute the motion for each of several candidate profiles. Inverse kinematics is solved for all
        together.
        """
        controls, link = [law.control for law in laws], self.link
        # Zones are checked later, and only for the profile that is chosen.
        trials = Trials(link.path, law_of(*controls), replace(link.own_bounds, zones=None), link.tolerance)
        return trials.trials([(len(control) - 3, (number,)) for number, control in enumerate(controls)])

    def _asked(self, law: _Timed, trial: Trial) -> float:
        """Return the factor by which a candidate must be slower to keep the limits outside of its overlaps.

        The factor is at most 1 if the candidate keeps the limits.
        """
        return self._asked_by(self._own(law, trial))

    def _asked_by(self, points: Array) -> float:
        if len(points) < 4:
            return 0.0
        demands = replace(self.link.own_bounds, zones=None).demands(points)
        return max((one.segment for one in demands), default=0.0) / (self.segment * (1.0 + 1e-12))

    def _keeps_zones(self, law: _Timed, trial: Trial) -> bool:
        own, bounds = self._own(law, trial), self.link.own_bounds
        return bounds.zones is None or len(own) < 4 or bounds.are_kept(own, self.segment * (1.0 + 1e-12))

    def _own(self, law: _Timed, trial: Trial) -> Array:
        return trial.points[max(law.into - 1, 0) : trial.segments + 3 - max(law.out - 1, 0)]


def _has_room(segments: int, first: Ramp, cruise: float) -> bool:
    """Return True if a motion of `segments` segments that ends at rest has room for its first and its last
    ramp.
    """
    width = 2.0 * (segments - first.middle - cruise)
    return FEWEST_IN_BLEND <= width <= segments and first.start + first.width + 1 <= segments


def law_of(*controls: Array) -> Law:
    """Return a motion profile with one form for each given array of control values. The number of a form is
    the index of its array.
    """

    def strain(segments: int, forms: NDArray[np.int64]) -> Array:
        return np.full((len(forms), 3), 1.0 / segments)

    return Law(
        lambda u: u,
        lambda segments, form: controls[form[0] if form else 0],  # noqa: ARG005
        lambda segments: NO_FORM,  # noqa: ARG005
        strain,
    )
