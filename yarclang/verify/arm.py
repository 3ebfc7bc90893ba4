"""The kinematics of the arm: its pose, the velocities of its frames, and bounds of the fourth derivatives of
their paths.

The proof describes the arm by constant transforms (steps): the first leads from the base to the first joint,
each following one from a joint to the next, the last to the flange. A joint turns about the z axis of its
frame, or slides along it. All numbers are fixed-point.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb
from typing import Any

from yarclang.verify.exact import BITS, ONE, PI, above, fixed, length, need, sine_and_cosine, times

Vector = list[int]
Step = tuple[list[Vector], Vector]
"""A frame relative to another one: the columns of its rotation, and its origin."""
SQUARE_ROOT_OF_2 = above(Fraction(14143, 10000))
_UNEVEN = ONE >> 40
"""Largest deviation of a rotation's columns from unit length and right angles. Bounds include its effect,
less than 2**-30 of a length.
"""


@dataclass
class Frame:
    """A moving frame in {B}.

    The velocity of `origin` is `rate`; the angular velocity of the rotation with the columns `axes` is
    `spin`.
    """

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
    """Return the scalar product of two vectors."""
    return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) >> BITS


def placed(numbers: Sequence[Fraction], farthest: int = 64) -> Step:
    """Read a pose from the proof; return the columns of its rotation, and its origin.

    The proof gives three rows of the rotation, each followed by a coordinate of the origin [m]. The origin
    must be nearer than `farthest` [m].
    """
    need(len(numbers) == 12, "a frame doesn't have 12 numbers")
    columns = [[fixed(numbers[4 * row + column]) for row in range(3)] for column in range(4)]
    for i in range(3):
        for j in range(3):
            need(
                abs(dot(columns[i], columns[j]) - (i == j) * ONE) < _UNEVEN,
                "the axes of a frame aren't perpendicular",
            )
    x, y, z = columns[:3]
    need(dot(cross(x, y), z) > 0, "the axes of a frame are left-handed")
    need(length(*columns[3]) < farthest * ONE, f"a frame is more than {farthest} m away")
    return columns[:3], columns[3]


class Arm:
    """The kinematic chain from {B} to the flange."""

    def __init__(self, robot: dict[str, Any]) -> None:
        self.turns: list[bool] = [kind == "turns" for kind in robot["kinds"]]
        self.steps = [placed(step) for step in robot["arm"]]
        need(
            len(self.steps) == len(self.turns) + 1 <= 17,
            "the arm has another number of steps than joints and one",
        )

    def links(self, q: Sequence[int], rates: Sequence[int]) -> list[Frame]:
        """Compute the forward kinematics: return {B}, and the frame of each joint after the joint has moved.

        Args:
            q: joint positions [rad or m].
            rates: joint velocities [rad/s or m/s].
        """
        need(all(abs(one) < 1024 * ONE for one in q), "a joint is too far")
        need(sum(map(abs, rates)) < 1024 * ONE, "a joint is too fast")
        here = Frame([0, 0, 0], [[ONE * (i == j) for j in range(3)] for i in range(3)], [0, 0, 0], [0, 0, 0])
        found = [here]
        for joint, (at, speed) in enumerate(zip(q, rates, strict=True)):
            here = beyond(here, self.steps[joint])
            z = here.axes[2]
            if self.turns[joint]:
                sine, cosine = sine_and_cosine(at)
                x, y = here.axes[:2]
                here.axes[0] = [(a * cosine + b * sine) >> BITS for a, b in zip(x, y, strict=True)]
                here.axes[1] = [(b * cosine - a * sine) >> BITS for a, b in zip(x, y, strict=True)]
                here.spin = [w + (a * speed >> BITS) for w, a in zip(here.spin, z, strict=True)]
            else:
                slide = [a * at >> BITS for a in z]
                here.origin = [o + d for o, d in zip(here.origin, slide, strict=True)]
                turned = zip(here.rate, cross(here.spin, slide), z, strict=True)
                here.rate = [v + t + (a * speed >> BITS) for v, t, a in turned]
            found.append(here)
        return found

    def frame(self, q: Sequence[int], rates: Sequence[int], tool: Step) -> Frame:
        """Return the frame `tool` on the flange, with its velocities, for `q` and `rates` as in `links`."""
        return beyond(beyond(self.links(q, rates)[-1], self.steps[-1]), tool)

    def reaches(self, size: int, point: Vector, travel: Sequence[int], way: int = 0) -> list[int]:
        """Bound the distance of a body from the axis of each joint that turns it, over all joint positions.

        The bound is the length of a polyline from the body towards the base, through the nearest point of
        each axis. Turning a joint doesn't change the length of a section. A sliding joint adds its `travel`.

        Args:
            size: number of joints that move the body.
            point: the body's middle, in the frame of the last of these joints.
            travel: largest distance of each sliding joint from its zero position.
            way: radius of the body around its middle.
        """
        found = [0] * size
        for joint in reversed(range(size)):
            if self.turns[joint]:
                way += length(point[0], point[1])
                found[joint] = way + (way >> 30) + 1
                point = [0, 0, point[2]]
            else:
                way += travel[joint]
            point = _out(*self.steps[joint], point)
        return found

    def to_flange(self, point: Vector) -> Vector:
        """Convert a point from the flange's frame to the frame of the last joint."""
        return _out(*self.steps[-1], point)

    def bends(
        self, reach: Sequence[int], w: Sequence[int], a: Sequence[int], j: Sequence[int]
    ) -> tuple[int, int]:
        """Bound the fourth derivatives of a frame's origin and of its rotation matrix (Frobenius norm).

        w, a, j bound each joint's |q'|, |q''|, |q'''|. The Frobenius norm of a product of cross-product
        matrices of unit axes is at most sqrt 2.
        """
        origin, turn = derivative(4, self.turns, reach, w, a, j)
        return origin + (origin >> 30), times(SQUARE_ROOT_OF_2, turn + (turn >> 30))


def derivative(
    order: int, turns: Sequence[bool], reach: Sequence[int], *rates: Sequence[int]
) -> tuple[int, int]:
    """Bound the derivatives of one order (1 to 4) over time of a point and of a rotation that joints move.

    Each joint has a constant jerk, and |q'|, |q''|, |q'''| are at most its `rates`. Let W, A, J be the sums
    of these bounds up to a turning joint, and B the complete Bell polynomial of W, A, J. By Faa di Bruno's
    formula, B counts chains of cross products with axes. No chain is longer than the reach of the joint
    nearest to the point, so the bound is the sum of reach times the growth of B at each joint. A sliding
    joint appears once in a chain, as its innermost factor. Its k-th derivative is multiplied by the chains of
    order - k, and there are comb(order, k) such products.
    """
    sums, polynomials, before, found = [0, 0, 0], _bell(0, 0, 0), 0, 0
    for turn, far, *own in zip(turns, reach, *rates, strict=True):
        if turn:
            sums = [a + b for a, b in zip(sums, own, strict=True)]
            polynomials = _bell(*sums)
            # `before` is rounded up, which makes the difference too small. The added term makes up for this.
            found += times(far, polynomials[order] - before + (ONE >> 64))
            before = polynomials[order]
            continue
        for k in range(1, min(order, 3) + 1):
            found += comb(order, k) * times(polynomials[order - k], own[k - 1])
    return found, before


def _bell(w: int, a: int, j: int) -> tuple[int, int, int, int, int]:
    """Return upper bounds of the complete Bell polynomials of orders 0 to 4, at the arguments w, a, j, 0."""
    square = times(w, w)
    third = times(square, w) + 3 * times(w, a) + j
    fourth = times(square, square) + 6 * times(square, a) + 3 * times(a, a) + 4 * times(w, j)
    return ONE, w, square + a, third, fourth


def beyond(here: Frame, step: Step) -> Frame:
    """Return the frame at a constant transform from another frame."""
    rows = list(zip(*here.axes, strict=True))
    far = [dot(row, step[1]) for row in rows]
    return Frame(
        [o + d for o, d in zip(here.origin, far, strict=True)],
        [[dot(row, column) for row in rows] for column in step[0]],
        [v + t for v, t in zip(here.rate, cross(here.spin, far), strict=True)],
        here.spin,
    )


def _out(columns: list[Vector], offset: Vector, point: Vector) -> Vector:
    """Convert a point from a frame to the previous frame of the chain."""
    x, y, z = columns
    rows = zip(x, y, z, offset, strict=True)
    return [((a * point[0] + b * point[1] + c * point[2]) >> BITS) + o for a, b, c, o in rows]


def in_si(printed: int | Fraction, scale: int, turns: bool) -> int:
    """Convert a number in units of 1 / scale deg or mm, or a rate in these units, to rad or m."""
    degrees = (printed.numerator << BITS) // (printed.denominator * scale)
    return degrees * PI // (180 << BITS) if turns else degrees // 1000
