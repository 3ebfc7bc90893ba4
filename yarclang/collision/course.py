"""A motion as the collision check sees it: where the joints are at each instant, and how far they go meanwhile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.shapes import Array


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """Segments with constant jerk, one behind the other: position `x`, velocity `v`, acceleration `a` at the start of each and jerk `j`,
    (N, n) each [rad or m, s]; `begins` (N + 1,) are the times between them [s].

    `way` (N + 1, n) is a bound of how far each joint has gone, forth and back, up to these times.
    """

    x: Array
    v: Array
    a: Array
    j: Array
    begins: Array
    way: Array

    @staticmethod
    def of(x: Array, v: Array, a: Array, j: Array, h: Array, peaks: Array) -> Course:
        """The course of segments with durations `h` (N,) [s] and largest speeds `peaks` (N, n)."""
        begins = np.concatenate([[0.0], np.cumsum(h)])
        way = np.concatenate([np.zeros((1, x.shape[1])), np.cumsum(peaks * h[:, None], axis=0)])
        return Course(x, v, a, j, begins, way)

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

    def _segment(self, time: Array) -> tuple[np.ndarray[tuple[int], np.dtype[np.int64]], Array]:
        row = np.clip(np.searchsorted(self.begins, time, side="right") - 1, 0, len(self.x) - 1)
        return row, time - self.begins[row]
