"""Compute the first trials of many Cartesian motions together. Most of these motions need few further
trials.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Motion
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.cruise import full_time
from yarclang.motion.fit import FEW_SEGMENTS, MOST_SEGMENTS, look_ahead
from yarclang.motion.limits import Bounds, Grid
from yarclang.motion.path import Path
from yarclang.motion.profile import FOR_SHORT, NoLaw, Profile, load_profile
from yarclang.motion.runs import Growing
from yarclang.motion.singular import keep_away
from yarclang.motion.trials import Trials, try_together
from yarclang.robot.model import Tolerance

_MOST_ROWS = 20_000
"""Largest number of segments that are computed together, summed up over all motions."""


@frozen(eq=False)
class Tried:
    """The trials of a motion, with the first one already made.

    `keeps_away` is True if the motion's path is proved to keep away from singularities.
    """

    trials: Trials
    profile: Profile
    keeps_away: bool

    def trials_of(self, profile: Profile) -> Trials | None:
        """Return the trials if they were made for the given profile, otherwise None."""
        return self.trials if profile is self.profile else None


@dataclass(slots=True)
class TriedAhead:
    """Maker of the first trials of motions. It computes many consecutive motions at once.

    `motions` are the motions of a program in order, each with its path; an item is None if the path isn't
    known. `asked` is a function that returns the limits and the tolerance of a motion.
    """

    motions: Sequence[tuple[Motion, Path] | None]
    grid: Grid
    asked: Callable[[Motion], tuple[Bounds, Tolerance]]
    _ready: dict[int, Tried] = field(default_factory=dict)
    _growing: Growing = field(default_factory=Growing)

    def of(self, number: int) -> Tried | None:
        """Return the trials of a motion, or None if none were made."""
        if number not in self._ready:
            self._ready.clear()
            size = self._growing.size(number)
            if size > 1:
                self._work(number, size)
        return self._ready.pop(number, None)

    def _work(self, number: int, size: int) -> None:
        """Make the first trials of up to `size` consecutive motions together, from motion `number` on. Stop
        before a motion of another kind.
        """
        begun = list[_Begun]()
        for here in range(number, min(number + size, len(self.motions))):
            one = self._begun(here)
            if one is None or (begun and not begun[0].is_like(one)):
                break
            if sum(other.segments for other in begun) + one.segments > _MOST_ROWS:
                break
            begun.append(one)
        if len(begun) < 2:
            return
        if begun[0].segment is None:
            look_ahead([(one.trials, one.profile) for one in begun], self.grid)
        else:
            try_together([one.trials for one in begun], [(one.segments, one.segment or 0.0) for one in begun])
        away = keep_away([one.path for one in begun])
        for here, (one, keeps_away) in enumerate(zip(begun, away, strict=True), number):
            self._ready[here] = Tried(one.trials, one.profile, keeps_away)
        self._growing.done(number + len(begun) - 1)

    def _begun(self, number: int) -> _Begun | None:
        """Choose the first trial of a motion. The result is None for motions whose trials aren't made
        together.
        """
        motion = self.motions[number]
        if motion is None:
            return None
        step, path = motion
        if not isinstance(path, CartesianPath):
            return None
        profile, timing = load_profile(step.profile), step.timing
        if timing.ceiling is not None:
            return None  # a motion with a speed limit of its own needs other trials
        full = None if timing.speed is None else full_time(path, timing.speed)
        if timing.speed is not None:
            if full is None or not profile.has_cruise:
                return None
            profile = load_profile(FOR_SHORT)
        if not profile.has_jerk_limit:
            return None
        bounds, tolerance = self.asked(step)
        law = profile.law(path, bounds)
        if isinstance(law, NoLaw):
            return None
        trials = Trials(path, law, bounds, tolerance)
        if full is not None and trials.foreseen_shortest() < 2.0 * full:
            return None  # if the path is long enough to reach the speed, other trials are needed
        duration = None if profile.is_stretched else timing.duration
        if duration is None:
            if law.shortest is not None:
                return None
            return _Begun(path, trials, profile, FEW_SEGMENTS, None)
        segments = self.grid.fewest(duration)
        segment = self.grid.nearest(duration / segments)
        if segments > MOST_SEGMENTS or segment < self.grid.smallest:
            return None
        return _Begun(path, trials, profile, segments, segment)


@frozen(eq=False)
class _Begun:
    """A motion whose first trial is chosen but not yet made.

    The trial has `segments` segments of `segment` [s]. If `segment` is None, the shortest duration is
    searched for.
    """

    path: CartesianPath
    trials: Trials
    profile: Profile
    segments: int
    segment: float | None

    def is_like(self, other: _Begun) -> bool:
        """Return True if the trials of two motions can be made together: they are of one kind, with one arm
        and one moving frame.
        """
        one, two = self.path, other.path
        return (
            (self.segment is None) == (other.segment is None)
            and one.chain is two.chain
            and np.array_equal(one.flange_from_moving, two.flange_from_moving)
        )
