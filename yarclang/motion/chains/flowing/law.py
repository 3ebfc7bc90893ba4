"""Define a motion profile: the speed along a path, and the time at which the motion is at each place."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array

_STILL = 1e-12


@frozen(eq=False)
class Law:
    """A motion profile along a path.

    At nodes `s` (N,) [m] the speed is `v` (N,) [m/s], and its square is linear in between; `t` (N,) [s] are
    the times of the nodes.
    """

    s: Array
    v: Array
    t: Array

    @staticmethod
    def fastest(s: Array, ceiling: Array, acceleration: Array, ends: tuple[float, float] = (0.0, 0.0)) -> Law:
        """Return the fastest motion profile that is nowhere faster than a ceiling.

        From node to node, the square of the speed changes by at most twice the acceleration times the
        distance. Therefore the speeds that can be reached from the start, and those from which the end can be
        reached, are running minima.

        Args:
            s: the places of the nodes (N,) [m].
            ceiling: the largest speeds at the nodes (N,) [m/s].
            acceleration: the largest accelerations between the nodes (N - 1,) [m/s^2].
            ends: the wanted speeds at both ends [m/s]; they are lower in the result if they aren't possible.
        """
        # v^2 grows by at most 2 a ds, summed up in `gained`. The largest v^2 that can be reached from the
        # start is `gained` plus the least value of ceiling^2 - gained up to the node. In the other direction,
        # the same holds from the end.
        gained = np.concatenate(([0.0], np.cumsum(2.0 * acceleration * np.diff(s))))
        square = ceiling**2
        square[0], square[-1] = ends[0] ** 2, ends[1] ** 2
        square = gained + np.minimum.accumulate(square - gained)
        left = gained[-1] - gained
        square = left + np.minimum.accumulate((square - left)[::-1])[::-1]
        v = np.sqrt(np.maximum(square, 0.0))
        # The acceleration is constant between nodes, so the mean speed between two nodes is the mean of their
        # speeds.
        t = np.concatenate(([0.0], np.cumsum(2.0 * np.diff(s) / np.maximum(v[1:] + v[:-1], _STILL))))
        return Law(s, v, t)

    @property
    def duration(self) -> float:
        """The duration of the whole path [s]."""
        return float(self.t[-1])

    def places(self, times: Array) -> Array:
        """Return the places (N,) [m] at times [s]. Before the start this is the first place, and after the
        end the last one.
        """
        k = np.clip(np.searchsorted(self.t, times, side="right") - 1, 0, len(self.t) - 2)
        passed = np.clip(times - self.t[k], 0.0, self.t[k + 1] - self.t[k])
        width = self.s[k + 1] - self.s[k]
        # Constant acceleration between nodes: (v1^2 - v0^2) / (2 ds).
        slope = (self.v[k + 1] ** 2 - self.v[k] ** 2) / (2.0 * width)
        return self.s[k] + np.clip(self.v[k] * passed + 0.5 * slope * passed**2, 0.0, width)

    def speeds(self, times: Array) -> Array:
        """Return the speeds (N,) [m/s] at times [s]: linear between nodes."""
        found: Array = np.interp(times, self.t, self.v)
        return found


@frozen(eq=False)
class Pace:
    """A motion profile between seams, stretched in time to an integer number of segments.

    Only a profile that ends at a seam is stretched. This adds less than a segment, and parts near seams stay
    unchanged. `seams` has two flags: True if the profile begins at a seam, and True if it ends at a seam.
    Beyond a seam the motion continues at the seam's speed. At `times` (M,) [s] the stretched profile is where
    the unstretched `law` is at `passed` (M,) [s].
    """

    law: Law
    seams: tuple[bool, bool]
    times: Array
    passed: Array

    @staticmethod
    def of(law: Law, seams: tuple[bool, bool], around: tuple[float, float], segment: float) -> Pace:
        """Stretch a motion profile to an integer number of segments if it ends at a seam.

        Args:
            law: the motion profile, which ends at rest or at a seam.
            seams: two flags: True if the profile begins at a seam, and True if it ends at one.
            around: time after the first seam, and time before the second one, in which the profile stays
                unchanged [s].
            segment: the segment time [s].
        """
        duration = law.duration
        # Times near a seam aren't stretched; the times in between are stretched evenly.
        whole = segment * np.ceil(duration / segment - 1e-6) if seams[1] else duration
        begin, end = around[0] if seams[0] else 0.0, around[1] if seams[1] else 0.0
        times = np.array([0.0, begin, max(whole - end, begin), whole])
        passed = np.array([0.0, begin, max(duration - end, begin), duration])
        return Pace(law, seams, times, passed)

    @property
    def duration(self) -> float:
        """The duration of the path [s]."""
        return float(self.times[-1])

    def by_law(self, times: Array) -> Array:
        """Return the times of the unstretched profile [s] that correspond to stretched times (N,) [s].

        Before the start and after the end, both times pass at the same rate.
        """
        found: Array = np.interp(times, self.times, self.passed)
        found += np.minimum(times, 0.0) + np.maximum(times - self.duration, 0.0)
        return found

    def places(self, times: Array) -> Array:
        """Return the places (N,) [m] at times [s]. Beyond a seam the motion continues at the seam's speed."""
        passed, law = self.by_law(times), self.law
        found = law.places(passed)
        if self.seams[0]:
            found += law.v[0] * np.minimum(passed, 0.0)
        if self.seams[1]:
            found += law.v[-1] * np.maximum(passed - law.duration, 0.0)
        return found
