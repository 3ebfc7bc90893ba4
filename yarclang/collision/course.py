"""Represent a motion for the collision check: the joint positions at each instant, and bounds of the
joints' speed, acceleration and travel.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.shapes import Array


@frozen(eq=False)
class Course:
    """The joint positions of a motion over time, as N consecutive segments with constant jerk.

    All rates are in rad or m per s, s^2 or s^3.

    Attributes:
        x: (N, n) joint positions at the start of each segment [rad or m].
        v: (N, n) joint velocities at the start of each segment.
        a: (N, n) joint accelerations at the start of each segment.
        j: (N, n) jerks of the joints on each segment.
        begins: (N + 1,) times at which segments begin, and the time at which the last one ends [s].
        way: (N + 1, n) upper bounds of the distance that each joint has travelled up to these times, back and
            forth.
        speed: (N, n) largest |velocity| of the joints on each segment.
        strength: (N, n) largest |acceleration| of the joints on each segment.
    """

    x: Array
    v: Array
    a: Array
    j: Array
    begins: Array
    way: Array
    speed: Array
    strength: Array

    @staticmethod
    def of(x: Array, v: Array, a: Array, j: Array, h: Array, peaks: Array) -> Course:
        """Make a course from segments.

        Args:
            x: (N, n) joint positions at the starts of the segments [rad or m].
            v: (N, n) joint velocities at the starts of the segments.
            a: (N, n) joint accelerations at the starts of the segments.
            j: (N, n) joint jerks on the segments.
            h: (N,) durations of the segments [s].
            peaks: (N, n) largest joint speeds on the segments.
        """
        begins = np.concatenate([[0.0], np.cumsum(h)])
        way = np.concatenate([np.zeros((1, x.shape[1])), np.cumsum(peaks * h[:, None], axis=0)])
        # The acceleration is linear on a segment, so its largest magnitude is at an end.
        strength = np.maximum(np.abs(a), np.abs(a + h[:, None] * j))
        return Course(x, v, a, j, begins, way, peaks, strength)

    def at(self, time: Array) -> Array:
        """Return joint positions (P, n) at times (P,) [s]."""
        row, t = self._segment(time)
        t = t[:, None]
        positions: Array = self.x[row] + t * (self.v[row] + t * (self.a[row] / 2.0 + t * self.j[row] / 6.0))
        return positions

    def gone(self, time: Array) -> Array:
        """Return upper bounds (P, n) of the distance that each joint has travelled up to times (P,) [s].

        Between two times, a joint moves by at most the difference of its bounds at these times.
        """
        row, t = self._segment(time)
        # Within a segment the bound grows at the segment's largest speed.
        share = t / (self.begins[row + 1] - self.begins[row])
        way: Array = self.way[row] + share[:, None] * (self.way[row + 1] - self.way[row])
        return way

    def peaks(self, begin: Array, end: Array) -> tuple[Array, Array]:
        """Return upper bounds (P, n) of each joint's |velocity|, and of its |acceleration|, from times
        `begin` to times `end`, (P,) each [s].
        """
        first = np.clip(np.searchsorted(self.begins, begin, side="right") - 1, 0, len(self.x) - 1)
        last = np.clip(np.searchsorted(self.begins, end, side="left") - 1, first, len(self.x) - 1)
        edges = np.stack([first, last + 1], axis=1).ravel()
        nothing = np.zeros((1, self.x.shape[1]))  # an extra row N for `reduceat`, since an edge may be N
        speed, strength = (
            np.maximum.reduceat(np.concatenate([values, nothing]), edges)[::2]
            for values in (self.speed, self.strength)
        )
        return speed, strength

    def _segment(self, time: Array) -> tuple[np.ndarray[tuple[int], np.dtype[np.int64]], Array]:
        row = np.clip(np.searchsorted(self.begins, time, side="right") - 1, 0, len(self.x) - 1)
        return row, time - self.begins[row]
