"""A motion as the collision check sees it: where the joints are at each instant, and how far they go meanwhile."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.shapes import Array


@frozen(eq=False)
class Course:
    """Segments with constant jerk, one behind the other: position `x`, velocity `v`, acceleration `a` at the start of each and jerk `j`,
    (N, n) each [rad or m, s]; `begins` (N + 1,) are the times between them [s].

    `way` (N + 1, n) is a bound of how far each joint has gone, forth and back, up to these times. `speed` and `strength` (N, n) are the largest
    |velocity| and |acceleration| on each segment.
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
        """The course of segments with durations `h` (N,) [s] and largest speeds `peaks` (N, n)."""
        begins = np.concatenate([[0.0], np.cumsum(h)])
        way = np.concatenate([np.zeros((1, x.shape[1])), np.cumsum(peaks * h[:, None], axis=0)])
        strength = np.maximum(np.abs(a), np.abs(a + h[:, None] * j))
        return Course(x, v, a, j, begins, way, peaks, strength)

    def at(self, time: Array) -> Array:
        """Joint positions (P, n) at times (P,)."""
        row, t = self._segment(time)
        t = t[:, None]
        positions: Array = self.x[row] + t * (self.v[row] + t * (self.a[row] / 2.0 + t * self.j[row] / 6.0))
        return positions

    def gone(self, time: Array) -> Array:
        """How far each joint has gone at most up to times (P,), (P, n): what lies between two of them is no more than their difference."""
        row, t = self._segment(time)
        share = t / (self.begins[row + 1] - self.begins[row])
        way: Array = self.way[row] + share[:, None] * (self.way[row + 1] - self.way[row])
        return way

    def peaks(self, begin: Array, end: Array) -> tuple[Array, Array]:
        """Bounds (P, n) of |velocity| and |acceleration| from times `begin` to times `end` (P,)."""
        first = np.clip(np.searchsorted(self.begins, begin, side="right") - 1, 0, len(self.x) - 1)
        last = np.clip(np.searchsorted(self.begins, end, side="left") - 1, first, len(self.x) - 1)
        edges = np.stack([first, last + 1], axis=1).ravel()
        nothing = np.zeros((1, self.x.shape[1]))  # the last segment ends where this one begins
        speed, strength = (
            np.maximum.reduceat(np.concatenate([values, nothing]), edges)[::2]
            for values in (self.speed, self.strength)
        )
        return speed, strength

    def _segment(self, time: Array) -> tuple[np.ndarray[tuple[int], np.dtype[np.int64]], Array]:
        row = np.clip(np.searchsorted(self.begins, time, side="right") - 1, 0, len(self.x) - 1)
        return row, time - self.begins[row]
