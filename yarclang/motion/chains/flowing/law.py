"""A speed over a way, and when each place is passed."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array

_STILL = 1e-12


@frozen(eq=False)
class Law:
    """A law: at nodes `s` (N,) [m] the speed is `v` (N,) [m/s], and its square is linear between; `t` (N,) [s] is when they are passed."""

    s: Array
    v: Array
    t: Array

    @staticmethod
    def fastest(s: Array, ceiling: Array, acceleration: Array, ends: tuple[float, float] = (0.0, 0.0)) -> Law:
        """Return the fastest law under a ceiling.

        Squares of speeds grow by twice the acceleration over the way: what is reached from the one end, and what can be left to the other, are running minima.

        Args:
            s: nodes (N,) [m].
            ceiling: (N,) [m/s].
            acceleration: the most between the nodes (N - 1,) [m/s^2].
            ends: the speeds at both ends [m/s], or less where these can't be.
        """
        gained = np.concatenate(([0.0], np.cumsum(2.0 * acceleration * np.diff(s))))
        square = ceiling**2
        square[0], square[-1] = ends[0] ** 2, ends[1] ** 2
        square = gained + np.minimum.accumulate(square - gained)
        left = gained[-1] - gained
        square = left + np.minimum.accumulate((square - left)[::-1])[::-1]
        v = np.sqrt(np.maximum(square, 0.0))
        t = np.concatenate(([0.0], np.cumsum(2.0 * np.diff(s) / np.maximum(v[1:] + v[:-1], _STILL))))
        return Law(s, v, t)

    @property
    def duration(self) -> float:
        """How long the whole way takes [s]."""
        return float(self.t[-1])

    def places(self, times: Array) -> Array:
        """Return where the law is (N,) [m] at times [s]; before and after it, at its ends."""
        k = np.clip(np.searchsorted(self.t, times, side="right") - 1, 0, len(self.t) - 2)
        passed = np.clip(times - self.t[k], 0.0, self.t[k + 1] - self.t[k])
        width = self.s[k + 1] - self.s[k]
        slope = (self.v[k + 1] ** 2 - self.v[k] ** 2) / (2.0 * width)
        return self.s[k] + np.clip(self.v[k] * passed + 0.5 * slope * passed**2, 0.0, width)

    def speeds(self, times: Array) -> Array:
        """Return how fast it is (N,) [m/s] at times [s]: linear between nodes."""
        found: Array = np.interp(times, self.t, self.v)
        return found


@frozen(eq=False)
class Pace:
    """A law that lasts whole segments where it ends at a seam: what is between the seams' surroundings is stretched by less than a segment.

    `seams` says which of its ends are seams, where it goes on as fast; at `times` (M,) [s] the law is where it is at `passed` (M,) [s] by itself.
    """

    law: Law
    seams: tuple[bool, bool]
    times: Array
    passed: Array

    @staticmethod
    def of(law: Law, seams: tuple[bool, bool], around: tuple[float, float], segment: float) -> Pace:
        """Stretch a law.

        Args:
            law: ends at rest, or at a seam.
            seams: which ends are seams.
            around: how long the law stays as it is at both ends [s].
            segment: [s].
        """
        duration = law.duration
        whole = segment * np.ceil(duration / segment - 1e-6) if seams[1] else duration
        begin, end = around[0] if seams[0] else 0.0, around[1] if seams[1] else 0.0
        times = np.array([0.0, begin, max(whole - end, begin), whole])
        passed = np.array([0.0, begin, max(duration - end, begin), duration])
        return Pace(law, seams, times, passed)

    @property
    def duration(self) -> float:
        """How long the way takes [s]."""
        return float(self.times[-1])

    def by_law(self, times: Array) -> Array:
        """Return the law's times [s] at times (N,) [s]; before and behind, the law goes on."""
        found: Array = np.interp(times, self.times, self.passed)
        found += np.minimum(times, 0.0) + np.maximum(times - self.duration, 0.0)
        return found

    def places(self, times: Array) -> Array:
        """Return where it is (N,) [m] at times [s]; beyond a seam it keeps its speed."""
        passed, law = self.by_law(times), self.law
        found = law.places(passed)
        if self.seams[0]:
            found += law.v[0] * np.minimum(passed, 0.0)
        if self.seams[1]:
            found += law.v[-1] * np.maximum(passed - law.duration, 0.0)
        return found
