"""Paths of joints: natural cubic splines, of which straight lines are the simplest."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from yarclang.verify.arm import Vector, in_si
from yarclang.verify.exact import BITS, ONE, SLACK, length, need, times
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
    """The natural cubic spline through way-points in joint space, over the sum of their distances.

    All is in SI units: `s` are the parameters of its way-points `y`, `bend` its second derivatives there. The
    path has the share of its `whole` length as its parameter. Through two points it is a straight line.
    """

    def __init__(self, points: Sequence[Vector]) -> None:
        self.goal = points[-1]
        self.y = [points[0]]
        self.s = [0]
        for one, other in pairwise(points):
            apart = ONE if len(points) == 2 else length(*(b - a for a, b in zip(one, other, strict=True)))
            if apart > _EQUAL:
                need(apart > _NEAREST, "way-points of a spline are too near to each other for this checker")
                self.y.append(other)
                self.s.append(self.s[-1] + apart)
        self.steps = [b - a for a, b in pairwise(self.s)]
        need(len(self.steps) > 0, "a spline has one way-point only")
        self.whole = self.s[-1]
        self.bend = [self._solve(joint) for joint in range(len(points[0]))]

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


def in_joints(numbers: Sequence[Fraction | int], scale: int, turns: Sequence[bool]) -> Vector:
    """Return joint positions in units of 1 / scale deg or mm, in SI units."""
    need(len(numbers) == len(turns), "a joint position has another number of joints")
    return [in_si(one, scale, turn) for one, turn in zip(numbers, turns, strict=True)]
