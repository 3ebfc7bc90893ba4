"""Check the distance of joints from their paths: straight lines, and natural cubic splines."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from yarclang.verify.arm import Vector, in_si
from yarclang.verify.exact import BITS, ONE, SLACK, above, fixed, length, need, times
from yarclang.verify.paths import SHARE, Motion, path_bend, pieces_of
from yarclang.verify.reader import PRINTED

_FINE = 1 << 64
_NEAREST = ONE >> 13
"""Least distance of neighbouring way-points of a spline, about 1e-4 rad or m.

With less, rounding would matter.
"""
_EQUAL = ONE // 10**9


def straight(motion: Motion, goal: Sequence[Fraction], tolerances: Sequence[int]) -> list[int]:
    """Return bounds of the distance of each joint from a straight line to a goal [deg or mm].

    With control points S + s D + r, the motion at any instant is at S + s D for the mean of their s, plus the
    mean of their r. The nearest s are taken, made to grow from 0 to 1; any other choice would be a proof as
    well.
    """
    control = motion.row.control[motion.row.first : motion.row.last + 3]
    start = control[0]
    scaled = [fixed(one * PRINTED) for one in goal]
    way = [g - (a << BITS) for g, a in zip(scaled, start, strict=True)]
    # Least squares with each joint in units of its tolerance: s = (way . offset) / (way . way).
    pull = [w // (t * t) for w, t in zip(way, tolerances, strict=True)]
    norm = sum(p * w >> BITS for p, w in zip(pull, way, strict=True))
    most, s = [0] * len(start), 0
    for k, point in enumerate(control):
        offset = [(a - b) for a, b in zip(point, start, strict=True)]
        along = sum(p * o for p, o in zip(pull, offset, strict=True)) * _FINE // norm if norm > 0 else 0
        s = _FINE if k == len(control) - 1 else max(s, min(along, _FINE))
        for joint, (o, w) in enumerate(zip(offset, way, strict=True)):
            most[joint] = max(most[joint], abs((o << BITS) - w * s // _FINE) + 1)
    return [
        in_si(Fraction(one, ONE), PRINTED, turns) + SLACK
        for one, turns in zip(most, motion.arm.turns, strict=True)
    ]


class Spline:
    """The natural cubic spline through way-points in joint space, over the sum of their distances.

    All is in SI units: `s` are the parameters of its way-points `y`, `bend` its second derivatives there.
    """

    def __init__(self, points: Sequence[Vector]) -> None:
        self.y = [points[0]]
        self.s = [0]
        for one, other in pairwise(points):
            apart = length(*(b - a for a, b in zip(one, other, strict=True)))
            if apart > _EQUAL:
                need(apart > _NEAREST, "way-points of a spline are too near to each other for this checker")
                self.y.append(other)
                self.s.append(self.s[-1] + apart)
        self.steps = [b - a for a, b in pairwise(self.s)]
        need(len(self.steps) > 0, "a spline has one way-point only")
        self.bend = [self._bends(joint) for joint in range(len(points[0]))]

    def _bends(self, joint: int) -> list[int]:
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

    def at(self, s: int) -> tuple[Vector, Vector]:
        """Return the joints at a parameter, and their derivatives over it."""
        k = self.span(s)
        h, t = self.steps[k], s - self.s[k]
        places, slopes = [], []
        for a, b, bend in zip(self.y[k], self.y[k + 1], self.bend, strict=True):
            m, n = bend[k], bend[k + 1]
            third = ((n - m) << BITS) // h
            slope = ((b - a) << BITS) // h - (h * (2 * m + n) >> BITS) // 6
            places.append(a + (t * (slope + (t * (m // 2 + (t * third >> BITS) // 6) >> BITS)) >> BITS))
            slopes.append(slope + (t * (m + (t * third >> BITS) // 2) >> BITS))
        return places, slopes

    def span(self, s: int) -> int:
        """Return the span between way-points that contains a parameter."""
        return max((k for k, begin in enumerate(self.s[:-1]) if begin <= s), default=0)

    def derivatives(self, joint: int, low: int, high: int) -> tuple[int, int, int]:
        """Return bounds of the second and third derivatives on a stretch, and of the third's jumps."""
        bend, first, last = self.bend[joint], self.span(low), self.span(high)
        second = max(abs(one) for one in bend[first : last + 2])
        thirds = [((bend[k + 1] - bend[k]) << BITS) // self.steps[k] for k in range(first, last + 1)]
        jump = sum(abs(b - a) for a, b in pairwise(thirds))
        return second + SLACK, max(map(abs, thirds)) + SLACK, jump + SLACK


def along_spline(motion: Motion, points: Sequence[Vector], proof: dict[str, Any]) -> list[int]:
    """Return bounds of the distance of each joint from the natural spline through way-points.

    The method is that for frames (paths.py). Where s passes a way-point, the third derivative of e jumps by
    s'^3 times that of the spline, which the Hermite cubic misses by at most d^3 / 192 times the jump.
    """
    spline = Spline(points)
    whole = spline.s[-1]
    most = [0] * len(points[0])
    here = motion.at(motion.begin)
    need("from" not in proof and (proof["s"][0], proof["s"][-1]) == (0, SHARE), "s doesn't lead from 0 to 1")
    for piece in pieces_of(motion, proof):
        # Scale s and its bounds from shares to the spline's parameter.
        then = motion.at(piece.end)
        d = above(piece.d)
        s = [one * whole >> BITS for one in piece.s]
        rates = [one * whole >> BITS for one in piece.rates]
        w, a, j = (times(one, whole + 1) for one in piece.bends)
        ends = [spline.at(one) for one in s]
        for joint in range(len(most)):
            second, third, jump = spline.derivatives(joint, s[0] - SLACK, s[1] + SLACK)
            rest = (
                times(d, d, d, d, path_bend([second, third, 0], (w, a, j))) // 384
                + times(d, d, d, w, w, w, jump) // 192
            )
            # Errors and their rates at both ends of the piece.
            e, f = (at[0][joint] - end[0][joint] for at, end in zip((here, then), ends, strict=True))
            v, u = (
                at[1][joint] - (rate * end[1][joint] >> BITS)
                for at, end, rate in zip((here, then), ends, rates, strict=True)
            )
            # Largest of the four Bezier points of the error's Hermite cubic.
            third_d = d // 3
            hull = max(abs(e), abs(e + (third_d * v >> BITS)), abs(f - (third_d * u >> BITS)), abs(f))
            most[joint] = max(most[joint], hull + rest + SLACK)
        here = then
    return most


def in_joints(numbers: Sequence[Fraction | int], scale: int, turns: Sequence[bool]) -> Vector:
    """Return joint positions in units of 1 / scale deg or mm, in SI units."""
    need(len(numbers) == len(turns), "a joint position has another number of joints")
    return [in_si(one, scale, turn) for one, turn in zip(numbers, turns, strict=True)]
