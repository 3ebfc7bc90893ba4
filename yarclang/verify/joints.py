"""Paths in joint space: straight lines, natural cubic splines, and timetables.

All are polynomials from one point to the next. Their parameter from 0 to 1 is a share of the path's length,
or of its duration.
"""

from bisect import bisect, bisect_left
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import accumulate, pairwise
from math import perm
from typing import Any

from yarclang.verify.arm import Vector, in_si
from yarclang.verify.exact import BITS, ONE, fixed, length, need
from yarclang.verify.paths import Motion, State

_NEAREST = ONE >> 13
"""Least distance of neighbouring waypoints of a spline, about 1e-4 rad or m.

Between nearer waypoints, rounding errors would be too large.
"""
_EQUAL = ONE // 10**9


class Joints:
    """The joints of the arm during a motion. Each joint is a group (see `State`) of one number. On a segment
    the joints move by cubics, so their fourth derivatives are 0.
    """

    def __init__(self, motion: Motion) -> None:
        self._motion = motion

    def at(self, place: Fraction) -> State:
        """Return joint positions and velocities at a place."""
        return [([q], [rate]) for q, rate in zip(*self._motion.at(place), strict=True)]

    def bends(self, _: int) -> Sequence[int]:
        """Return bounds of the fourth derivatives on a segment."""
        return [0] * len(self._motion.arm.turns)


class Pieces:
    """A path of several numbers, such as joint positions: a polynomial on each of its pieces, over a
    parameter from 0 to 1.

    Attributes:
        edges: parameter values at which pieces begin and end.
        points: for each piece, the Bezier points of each number; the k-th derivative lies in the hull of
            their k-th differences, times degree! / (degree - k)! / width^k.
        goal: the end of the path.
    """

    def __init__(self, steps: Sequence[int], points: list[list[Vector]]) -> None:
        whole = sum(steps)
        self.edges = [(one << BITS) // whole for one in accumulate(steps, initial=0)]
        self.points = points
        self.goal = [one[-1] for one in points[-1]]
        self._bounds = lru_cache(64)(self._bounds_of)

    def at(self, s: int) -> State:
        """Return the path's numbers at a parameter value, and their derivatives over the parameter (de
        Casteljau).
        """
        k = min(bisect(self.edges, s), len(self.points)) - 1
        width, found = self.edges[k + 1] - self.edges[k], []
        u = ((s - self.edges[k]) << BITS) // width
        for points in self.points[k]:
            degree, near = len(points) - 1, points
            while len(near) > 2:
                near = [a + (u * (b - a) >> BITS) for a, b in pairwise(near)]
            way = near[1] - near[0]
            found.append(([near[0] + (u * way >> BITS)], [(degree * way << BITS) // width]))
        return found

    def bends(self, share: tuple[int, int]) -> Sequence[Sequence[int]]:
        """Return bounds of the path's derivatives of order 2 to 4 over its parameter, and of the jumps of the
        third derivative.

        If a function's third derivative jumps, its Hermite cubic is off by at most d^3 / 192 times the jump.
        """
        first = min(bisect(self.edges, share[0]), len(self.points)) - 1
        return self._bounds(first, max(bisect_left(self.edges, share[1]), first + 1))

    def _bounds_of(self, first: int, last: int) -> Sequence[Sequence[int]]:
        """Return the bounds of `bends` on the pieces from `first` to the one before `last`."""
        found = []
        for number in range(len(self.goal)):
            bounds, thirds = [0, 0, 0, 0], list[tuple[int, int]]()
            for k in range(first, last):
                of_order = _derivatives(self.points[k][number], self.edges[k + 1] - self.edges[k])
                for order in (2, 3, 4):
                    bounds[order - 2] = max(bounds[order - 2], *(abs(one) + 1 for one in of_order[order]))
                thirds.append((of_order[3][0], of_order[3][-1]))
            bounds[3] = sum(abs(b - a) + 2 for (_, a), (b, _) in pairwise(thirds))
            found.append(bounds)
        return found


def _derivatives(points: Vector, width: int) -> list[Vector]:
    """Return Bezier points of the derivatives of order 0 to 4 of a polynomial on a piece."""
    found, degree = [points], len(points) - 1
    for order in range(1, 5):
        points = [b - a for a, b in pairwise(points)] or [0]
        found.append([(perm(degree, order) * one << order * BITS) // width**order for one in points])
    return found


def smooth(y: Sequence[Vector], steps: list[int], clamped: bool = False) -> Pieces:
    """Return the cubic spline through points. The parameter grows from one point to the next by given steps.

    The spline is natural, so that its second derivatives at both ends are 0, or clamped, so that its first
    derivatives are.
    """
    need(len(steps) > 0, "a spline has one waypoint only")
    near = min(steps) <= (_NEAREST if len(steps) > 1 else 0)
    need(not near, "waypoints of a spline are too near to each other for this checker")
    columns = []
    for column in zip(*y, strict=True):
        slopes = [((b - a) << BITS) // step for (a, b), step in zip(pairwise(column), steps, strict=True)]
        bend = _bend([0, *steps, 0], [0, *slopes, 0])[1:-1] if clamped else _bend(steps, slopes)
        pieces = []
        for (a, b), (m, n), slope, h in zip(pairwise(column), pairwise(bend), slopes, steps, strict=True):
            inner = h * (slope - (h * (2 * m + n) >> BITS) // 6) >> BITS
            outer = h * (slope + (h * (m + 2 * n) >> BITS) // 6) >> BITS
            pieces.append([a, a + inner // 3, b - outer // 3, b])
        columns.append(pieces)
    return Pieces(steps, [list(piece) for piece in zip(*columns, strict=True)])


def _bend(h: list[int], slope: list[int]) -> list[int]:
    """Solve the equations of a natural cubic spline for its second derivatives M (Thomas algorithm):
    h M + 2 (h + h') M' + h' M'' = 6 (slope' - slope), with M = 0 at both ends.
    """
    above, right, found = [0], [0], [0] * (len(h) + 1)
    for k in range(1, len(h)):
        pivot = 2 * (h[k - 1] + h[k]) - (h[k - 1] * above[-1] >> BITS)
        right.append(((6 * (slope[k] - slope[k - 1]) - (h[k - 1] * right[-1] >> BITS)) << BITS) // pivot)
        above.append((h[k] << BITS) // pivot)
    for k in reversed(range(1, len(h))):
        found[k] = right[k] - (above[k] * found[k + 1] >> BITS)
    return found


def through(points: Sequence[Vector]) -> Pieces:
    """Return the natural spline through joint positions; its parameter is the sum of their distances. For two
    positions, it is a line.
    """
    y, steps = [points[0]], list[int]()
    for one, other in pairwise(points):
        apart = ONE if len(points) == 2 else length(*(b - a for a, b in zip(one, other, strict=True)))
        if apart > _EQUAL:
            y.append(other)
            steps.append(apart)
    return smooth(y, steps)


def timetable(stands: Vector, rows: Sequence[dict[str, Any]], turns: Sequence[bool]) -> Pieces:
    """Return the path of a timetable, which begins at rest at the robot's current position.

    If the timetable gives positions, velocities and accelerations, the path is a quintic between two rows;
    with positions and velocities, it is a cubic. With positions alone, it is the clamped spline.
    """
    times = [row["at"] for row in rows]
    later = all(one + times[-1] / 10**9 < other for one, other in pairwise(times))
    need(later and times[0] == 0 and len(rows) > 1, "a timetable whose times don't grow from 0 on")
    need(all(set(row) == set(rows[0]) for row in rows), "rows of a timetable with other numbers")
    steps = [fixed(other - one) for one, other in pairwise(times)]
    q = [stands, *(in_joints(row["q"], 1, turns) for row in rows[1:])]
    if "v" not in rows[0]:
        need("a" not in rows[0], "accelerations of a timetable without velocities")
        return smooth(q, steps, clamped=True)
    v, a = ([in_joints(row.get(name, row["v"]), 1, turns) for row in rows] for name in ("v", "a"))
    need(not any(v[0]), "a timetable that doesn't begin at rest")
    pieces = list[list[Vector]]()
    for k, h in enumerate(steps):
        pieces.append([])
        for (p, r), (v0, v1), (a0, a1) in zip(
            *(zip(*one[k : k + 2], strict=True) for one in (q, v, a)), strict=True
        ):
            degree = 5 if "a" in rows[0] else 3
            left, right = (h * one // degree >> BITS for one in (v0, v1))
            inner = [p + left, r - right]
            if degree == 5:
                left_bend, right_bend = ((h * h >> BITS) * one // 20 >> BITS for one in (a0, a1))
                inner[1:1] = [p + 2 * left + left_bend, r - 2 * right + right_bend]
            pieces[-1].append([p, *inner, r])
    return Pieces(steps, pieces)


def in_joints(numbers: Sequence[Fraction | int], scale: int, turns: Sequence[bool]) -> Vector:
    """Convert joint positions from units of 1 / scale deg or mm to SI units."""
    need(len(numbers) == len(turns), "a joint position has another number of joints")
    return [in_si(one, scale, turn) for one, turn in zip(numbers, turns, strict=True)]
