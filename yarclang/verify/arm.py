"""Where the arm is, how fast its frames move, and how strongly their way can bend.

The proof tells the arm as steps: the first leads from the base to the first joint, each following one from a
joint to the next, the last to the flange. A joint turns about the z axis of its frame, or slides along it.
All in fixed-point.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from yarclang.verify.exact import BITS, ONE, PI, above, fixed, length, need, sine_and_cosine, times

Vector = list[int]
SQUARE_ROOT_OF_2 = above(Fraction(14143, 10000))
_UNEVEN = ONE >> 40
"""Rotations are as exact as this: they make vectors longer by less than 2**-30, which is added."""


@dataclass
class Frame:
    """A frame in {B}: `origin` and its velocity `rate`; the columns `axes` of its rotation, their `spin`."""

    origin: Vector
    axes: list[Vector]
    rate: Vector
    spin: Vector


def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product."""
    return [
        (a[1] * b[2] - a[2] * b[1]) >> BITS,
        (a[2] * b[0] - a[0] * b[2]) >> BITS,
        (a[0] * b[1] - a[1] * b[0]) >> BITS,
    ]


def dot(a: Sequence[int], b: Sequence[int]) -> int:
    """Return the scalar product."""
    return sum(x * y for x, y in zip(a, b, strict=True)) >> BITS


def placed(numbers: Sequence[Fraction]) -> tuple[list[Vector], Vector]:
    """Read a frame, three rows of a rotation with the origin [m] at their ends; return columns and origin."""
    need(len(numbers) == 12, "a frame isn't told by 12 numbers")
    columns = [[fixed(numbers[4 * row + column]) for row in range(3)] for column in range(4)]
    for i in range(3):
        for j in range(3):
            need(
                abs(dot(columns[i], columns[j]) - (i == j) * ONE) < _UNEVEN,
                "the axes of a frame aren't perpendicular",
            )
    x, y, z = columns[:3]
    need(dot(cross(x, y), z) > 0, "the axes of a frame are left-handed")
    need(length(*columns[3]) < 64 * ONE, "a frame is more than 64 m away")
    return columns[:3], columns[3]


class Arm:
    """The chain from {B} to the flange."""

    def __init__(self, robot: dict[str, Any]) -> None:
        self.turns: list[bool] = [kind == "turns" for kind in robot["kinds"]]
        self.steps = [placed(step) for step in robot["arm"]]
        need(
            len(self.steps) == len(self.turns) + 1 <= 17,
            "the arm has another number of steps than joints and one",
        )

    def frame(self, q: Sequence[int], rates: Sequence[int], tool: tuple[list[Vector], Vector]) -> Frame:
        """Return a frame that is told on the flange, at joint positions and their rates [rad or m, per s]."""
        need(
            all(abs(one) < 1024 * ONE for one in q) and sum(map(abs, rates)) < 1024 * ONE,
            "a joint is too far or fast",
        )
        axes, origin = self.steps[0]
        axes = list(axes)
        rate, spin = [0, 0, 0], [0, 0, 0]
        for joint, (columns, offset) in enumerate([*self.steps[1:], tool]):
            if joint < len(self.turns):
                z = axes[2]
                if self.turns[joint]:
                    sine, cosine = sine_and_cosine(q[joint])
                    x, y = axes[0], axes[1]
                    axes[0] = [(a * cosine + b * sine) >> BITS for a, b in zip(x, y, strict=True)]
                    axes[1] = [(b * cosine - a * sine) >> BITS for a, b in zip(x, y, strict=True)]
                    spin = [w + (a * rates[joint] >> BITS) for w, a in zip(spin, z, strict=True)]
                else:
                    slide = [a * q[joint] >> BITS for a in z]
                    origin = [o + d for o, d in zip(origin, slide, strict=True)]
                    turned = cross(spin, slide)
                    rate = [
                        v + t + (a * rates[joint] >> BITS) for v, t, a in zip(rate, turned, z, strict=True)
                    ]
            x, y, z = axes
            far = [
                (a * offset[0] + b * offset[1] + c * offset[2]) >> BITS
                for a, b, c in zip(x, y, z, strict=True)
            ]
            origin = [o + d for o, d in zip(origin, far, strict=True)]
            rate = [v + t for v, t in zip(rate, cross(spin, far), strict=True)]
            axes = [
                [(a * e[0] + b * e[1] + c * e[2]) >> BITS for a, b, c in zip(x, y, z, strict=True)]
                for e in columns
            ]
        return Frame(origin, axes, rate, spin)

    def reaches(self, tool: tuple[list[Vector], Vector], travel: Sequence[int]) -> list[int]:
        """Return how far a frame on the flange can ever be from the axis of each joint that turns.

        From the frame backwards, the point of each axis nearest to the last point: between two axes only
        turns lie, so the ways add up; a joint that slides adds its `travel`.
        """
        found = [0] * len(self.turns)
        columns, offset = self.steps[-1]
        point = _out(columns, offset, tool[1])
        way = 0
        for joint in reversed(range(len(self.turns))):
            if self.turns[joint]:
                way += length(point[0], point[1])
                found[joint] = way + (way >> 30) + 1
                point = [0, 0, point[2]]
            else:
                way += travel[joint]
            columns, offset = self.steps[joint]
            point = _out(columns, offset, point)
        return found

    def bends(
        self, reach: Sequence[int], w: Sequence[int], a: Sequence[int], j: Sequence[int]
    ) -> tuple[int, int]:
        """Return bounds of the fourth derivatives of a frame's origin and rotation matrix (Frobenius norm).

        Each joint has a constant jerk, and |q'|, |q''|, |q'''| of at most w, a, j. By Faa di Bruno, with the
        sums W, A, J of these up to a joint, B = W^4 + 6 W^2 A + 3 A^2 + 4 W J counts chains of cross products
        with axes, none longer than the reach of the joint nearest to the frame: the sum of reach (B - B
        before). A joint that slides is innermost, and once: the derivative of B in its direction. A product
        of [axis]x has the Frobenius norm sqrt 2 at most.
        """
        sum_w = sum_a = sum_j = before = origin = 0
        for joint, turns in enumerate(self.turns):
            if not turns:
                origin += times(
                    4 * times(sum_w, sum_w, sum_w) + 12 * times(sum_w, sum_a) + 4 * sum_j, w[joint]
                )
                origin += 6 * times(times(sum_w, sum_w) + sum_a, a[joint]) + 4 * times(sum_w, j[joint])
                continue
            sum_w, sum_a, sum_j = sum_w + w[joint], sum_a + a[joint], sum_j + j[joint]
            upto = fourth(sum_w, sum_a, sum_j)
            origin += times(reach[joint], upto - before + (ONE >> 64))  # `before` is rounded up, by less
            before = upto
        return origin + (origin >> 30), times(SQUARE_ROOT_OF_2, before + (before >> 30))


def fourth(w: int, a: int, j: int) -> int:
    """Return an upper bound of w^4 + 6 w^2 a + 3 a^2 + 4 w j."""
    square = times(w, w)
    return times(square, square) + 6 * times(square, a) + 3 * times(a, a) + 4 * times(w, j)


def _out(columns: list[Vector], offset: Vector, point: Vector) -> Vector:
    """Return a point, told in a frame, as seen from the frame before."""
    x, y, z = columns
    rows = zip(x, y, z, offset, strict=True)
    return [((a * point[0] + b * point[1] + c * point[2]) >> BITS) + o for a, b, c, o in rows]


def in_si(printed: int | Fraction, scale: int, turns: bool) -> int:
    """Return a number of 1 / scale deg or mm, or such a rate, in rad or m."""
    degrees = (printed.numerator << BITS) // (printed.denominator * scale)
    return degrees * PI // (180 << BITS) if turns else degrees // 1000
