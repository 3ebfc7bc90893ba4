"""Paths of joints: natural cubic splines, of which straight lines are the simplest, and timetables."""

from bisect import bisect
from collections.abc import Sequence
from fractions import Fraction
from itertools import accumulate, pairwise
from math import factorial
from typing import Any

from yarclang.verify.arm import Vector, in_si
from yarclang.verify.exact import BITS, ONE, SLACK, above, fixed, length, need, times
from yarclang.verify.paths import Motion, State

_NEAREST = ONE >> 13
"""Least distance of neighbouring way-points of a spline, about 1e-4 rad or m.

With less, rounding would matter.
"""
_EQUAL = ONE // 10**9


class Joints:
    """The joints on a motion, a group each. They are cubics themselves, so their fourth derivatives are 0."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion

    def at(self, place: Fraction) -> State:
        """Return joint positions and velocities at a place."""
        return [([q], [rate]) for q, rate in zip(*self._motion.at(place), strict=True)]

    def bends(self, _: int) -> Sequence[int]:
        """Return bounds of the fourth derivatives on a segment."""
        return [0] * len(self._motion.arm.turns)


class Spline:
    """The natural cubic spline through `y` over a parameter that grows by `steps`.

    All is in SI units: `s` are the parameters of the points, `bend` its second derivatives there. The path has
    the share of its `whole` parameter as its own. Through two points it is a straight line.
    """

    def __init__(self, y: list[Vector], steps: list[int]) -> None:
        self.y, self.steps, self.goal = y, steps, y[-1]
        need(len(steps) > 0, "a spline has one way-point only")
        near = len(steps) > 1 and min(steps) <= _NEAREST
        need(
            min(steps) > 0 and not near, "way-points of a spline are too near to each other for this checker"
        )
        self.s = [0, *accumulate(steps)]
        self.whole = self.s[-1]
        self.bend = [self._solve(joint) for joint in range(len(y[0]))]

    @classmethod
    def through(cls, points: Sequence[Vector]) -> "Spline":
        """Return the spline through joint positions, over the sum of their distances."""
        y, steps = [points[0]], list[int]()
        for one, other in pairwise(points):
            apart = ONE if len(points) == 2 else length(*(b - a for a, b in zip(one, other, strict=True)))
            if apart > _EQUAL:
                y.append(other)
                steps.append(apart)
        return cls(y, steps)

    def _solve(self, joint: int) -> list[int]:
        """Solve h M + 2 (h + h') M' + h' M'' = 6 (slope' - slope), M = 0 at both ends (Thomas algorithm)."""
        h = self.steps
        slope = [
            ((b[joint] - a[joint]) << BITS) // step for (a, b), step in zip(pairwise(self.y), h, strict=True)
        ]
        above_, right = [0], [0]
        for k in range(1, len(h)):
            pivot = 2 * (h[k - 1] + h[k]) - (h[k - 1] * above_[-1] >> BITS)
            right.append(((6 * (slope[k] - slope[k - 1]) - (h[k - 1] * right[-1] >> BITS)) << BITS) // pivot)
            above_.append((h[k] << BITS) // pivot)
        found = [0] * (len(h) + 1)
        for k in reversed(range(1, len(h))):
            found[k] = right[k] - (above_[k] * found[k + 1] >> BITS)
        return found

    def at(self, s: int) -> State:
        """Return the joints at a share, and their derivatives over it."""
        s = s * self.whole >> BITS
        k = self._span(s)
        h, t, found = self.steps[k], s - self.s[k], []
        for a, b, bend in zip(self.y[k], self.y[k + 1], self.bend, strict=True):
            m, n = bend[k], bend[k + 1]
            third = ((n - m) << BITS) // h
            slope = ((b - a) << BITS) // h - (h * (2 * m + n) >> BITS) // 6
            place = a + (t * (slope + (t * (m // 2 + (t * third >> BITS) // 6) >> BITS)) >> BITS)
            slope += t * (m + (t * third >> BITS) // 2) >> BITS
            found.append(([place], [slope * self.whole >> BITS]))
        return found

    def _span(self, s: int) -> int:
        """Return the span between way-points that contains a parameter."""
        return max((k for k, begin in enumerate(self.s[:-1]) if begin <= s), default=0)

    def bends(self, share: tuple[int, int]) -> Sequence[Sequence[int]]:
        """Return bounds of the derivatives over the share of order 2 to 4, and of the jumps of the third.

        The Hermite cubic misses a jump of a function's third derivative by at most d^3 / 192 times the jump.
        """
        low, high = (one * self.whole >> BITS for one in share)
        first, last, found = self._span(low - SLACK), self._span(high + SLACK), []
        for bend in self.bend:
            thirds = [((bend[k + 1] - bend[k]) << BITS) // self.steps[k] for k in range(first, last + 1)]
            jump = sum(abs(b - a) for a, b in pairwise(thirds))
            second = max(abs(one) for one in bend[first : last + 2])
            size, third = self.whole + 1, max(map(abs, thirds)) + SLACK
            found.append(
                (
                    times(second + SLACK, size, size),
                    times(third, size, size, size),
                    0,
                    times(jump + SLACK, size, size, size),
                )
            )
        return found


def _times(number: int, by: Fraction) -> int:
    return number * by.numerator // by.denominator


class Table:
    """A timetable: a polynomial of time from each row to the next, over the share of the whole time.

    A cubic has the positions and velocities of both rows, a quintic their accelerations as well. `times` are
    those of the rows, from 0 [s], and `pieces` the Bezier points of each joint between them.
    """

    def __init__(self, stands: Vector, rows: Sequence[dict[str, Any]], turns: Sequence[bool]) -> None:
        self.times: list[Fraction] = [row["at"] for row in rows]
        least = self.times[-1] / 10**9
        later = all(one + least < other for one, other in pairwise(self.times))
        need(later and self.times[0] == 0 and len(rows) > 1, "a timetable whose times don't grow from 0 on")
        self.edges = [fixed(at / self.times[-1]) for at in self.times]
        need(all(set(row) == set(rows[0]) for row in rows), "rows of a timetable with other numbers")
        v, a = ([in_joints(row.get(name, row["v"]), 1, turns) for row in rows] for name in ("v", "a"))
        q = [stands, *(in_joints(row["q"], 1, turns) for row in rows[1:])]
        need(not any(v[0]), "a timetable that doesn't begin at rest")
        self.pieces = list[list[Vector]]()
        for k, (begin, end) in enumerate(pairwise(self.times)):
            h = end - begin
            joints = list[Vector]()
            for j in range(len(turns)):
                if "a" not in rows[0]:
                    inner = [q[k][j] + _times(v[k][j], h / 3), q[k + 1][j] - _times(v[k + 1][j], h / 3)]
                else:
                    one, other = _times(v[k][j], h / 5), _times(v[k + 1][j], h / 5)
                    inner = [
                        q[k][j] + one,
                        q[k][j] + 2 * one + _times(a[k][j], h * h / 20),
                        q[k + 1][j] - 2 * other + _times(a[k + 1][j], h * h / 20),
                        q[k + 1][j] - other,
                    ]
                joints.append([q[k][j], *inner, q[k + 1][j]])
            self.pieces.append(joints)

    def at(self, s: int) -> State:
        """Return the joints at a share, and their derivatives over it (de Casteljau)."""
        k, h, u = self._span(s)
        found: State = []
        for points in self.pieces[k]:
            degree, near = len(points) - 1, points
            while len(near) > 2:
                near = [a + (u * (b - a) >> BITS) for a, b in pairwise(near)]
            way = near[1] - near[0]
            found.append(([near[0] + (u * way >> BITS)], [(degree * way << BITS) // h]))
        return found

    def bends(self, share: tuple[int, int]) -> Sequence[Sequence[int]]:
        """Return bounds of the derivatives over the share of order 2 to 4, and of the jumps of the third.

        The share grows evenly, so only the fourth counts. The share lies between two rows.
        """
        k, h, _ = self._span(sum(share) // 2)
        found = []
        for points in self.pieces[k]:
            degree, steps = len(points) - 1, points
            for _ in range(4):
                steps = [b - a for a, b in pairwise(steps)]
            fourth = factorial(degree) // factorial(max(degree - 4, 0)) * max(map(abs, steps), default=0)
            for _ in range(4):
                fourth = (fourth << BITS) // h + 1
            found.append((0, 0, fourth, 0))
        return found

    def _span(self, s: int) -> tuple[int, int, int]:
        """Return the piece that contains a share, its width, and the share of the piece."""
        k = min(max(bisect(self.edges, s) - 1, 0), len(self.pieces) - 1)
        h = self.edges[k + 1] - self.edges[k]
        return k, h, ((s - self.edges[k]) << BITS) // h

    def is_smooth(self) -> bool:
        """Return True if accelerations are continuous, as in the one cubic spline that rests at both ends.

        With intervals h and g beside a row, an acceleration that jumps there by J moves no velocity by more
        than J h g / 2 (h + g), since the spline's equations are diagonally dominant. Times the longest
        interval, this bounds how far positions are from those of the spline: no more than `_EQUAL`.
        """
        spans = [above(end - begin) for begin, end in pairwise(self.times)]
        for (here, then), (h, g) in zip(pairwise(self.pieces), pairwise(spans), strict=True):
            for one, other in zip(here, then, strict=True):
                end, begin = one[-1] - 2 * one[-2] + one[-3], other[0] - 2 * other[1] + other[2]
                jump = abs(end * g * g - begin * h * h) // (h * g)  # J h g / 6
                if 3 * jump * max(spans) // (h + g) > _EQUAL:
                    return False
        return not any(row[-1] - row[-2] for row in self.pieces[-1])


def in_joints(numbers: Sequence[Fraction | int], scale: int, turns: Sequence[bool]) -> Vector:
    """Return joint positions in units of 1 / scale deg or mm, in SI units."""
    need(len(numbers) == len(turns), "a joint position has another number of joints")
    return [in_si(one, scale, turn) for one, turn in zip(numbers, turns, strict=True)]
