"""Compute poses and velocities of watched items at instants of a motion, and bounds between the instants."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.bodies import Rows, Scene
from yarclang.collision.course import Course
from yarclang.collision.placing import place
from yarclang.collision.zones.watched import Item
from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import lines_of
from yarclang.robot.model import Chain
from yarclang.shapes import Array


@frozen(eq=False)
class Posed:
    """The pose and velocity, at P instants, of a body that some of the joints move.

    Attributes:
        turn: (3, 3, P) rotation of the body from its pose with all joints at zero.
        shift: (3, P) translation of the body from its pose with all joints at zero [m].
        angular: (3, P) angular velocity of the body [rad/s].
        linear: (3, P) velocity of the body's point that is at the origin of {B} [m/s].
    """

    turn: Array
    shift: Array
    angular: Array
    linear: Array

    def points(self, points: Array) -> Array:
        """Return the positions (P, V, 3) of points (V, 3) of the body, in {B} [m]."""
        moved: Array = np.matmul(points, self.turn) + self.shift[:, None]
        return moved.transpose(2, 1, 0)

    def point(self, point: Array) -> Array:
        """Return the positions (P, 3) of one point (3,) of the body, in {B} [m]."""
        moved: Array = np.matmul(point, self.turn) + self.shift
        return moved.T

    def support(self, item: Item, directions: Array) -> Array:
        """Return the support function of an item in unit directions (F, 3): the largest d · p over its points
        p, (F, P) [m].
        """
        return _reach(item, np.tensordot(directions, self.turn, axes=1)) + directions @ self.shift

    def support_each(self, item: Item, directions: Array) -> Array:
        """Return the support function (P,) of an item [m], in one unit direction per instant (P, 3)."""
        own = np.einsum("pi,ijp->jp", directions, self.turn)
        reach: Array = _reach(item, own) + np.einsum("pi,ip->p", directions, self.shift)
        return reach

    def speed(self, item: Item) -> Array:
        """Return the speed of the fastest point of an item (P,) [m/s]; slightly too large if the item is
        round.
        """
        # A point p has the velocity omega x p plus the velocity of the body's point at the origin of {B}.
        at = np.matmul(item.points, self.turn) + self.shift[:, None]
        velocity = _cross(self.angular[:, None], at) + self.linear[:, None]
        fastest: Array = np.sqrt(np.einsum("ivp,ivp->vp", velocity, velocity).max(axis=0))
        # The velocity of a point of the disc or ball is that of its center plus angular velocity x distance.
        turning: Array = (item.disc + item.radius) * np.sqrt(
            np.einsum("ip,ip->p", self.angular, self.angular)
        )
        return fastest + turning

    def take(self, rows: Rows) -> Posed:
        """Return some of the instants."""
        return Posed(*(getattr(self, name)[..., rows] for name in self.__dataclass_fields__))

    def beside(self, other: Posed) -> Posed:
        """Return the poses and velocities at these instants, followed by those at the instants of `other`."""
        return Posed(
            *(
                np.concatenate([getattr(self, name), getattr(other, name)], axis=-1)
                for name in self.__dataclass_fields__
            )
        )


@frozen(eq=False)
class Arm:
    """The poses and velocities of all parts of the arm at P instants.

    The fields are those of `Posed`, with one more dimension in front: row k belongs to a body that the first
    k joints move.
    """

    turn: Array
    shift: Array
    angular: Array
    linear: Array

    @staticmethod
    def at(scene: Scene, q: Array, rate: Array | None = None) -> Arm:
        """Place the arm at joint positions (P, n) [rad or m], with joint velocities `rate` (P, n); without
        `rate`, it is at rest.
        """
        placed = place(scene, q)
        # `Posed` needs the instants as the last dimension.
        turn, shift = placed.turn.transpose(0, 2, 3, 1), placed.shift.transpose(0, 2, 1)
        angular, linear = np.zeros(shift.shape), np.zeros(shift.shape)
        for joint in range(scene.chain.size if rate is not None else 0):
            assert rate is not None
            screw = scene.chain.screws[joint]
            spin, slide = np.matmul(screw[3:], turn[joint]), np.matmul(screw[:3], turn[joint])
            # Per unit of the joint's rate, the body's point at the origin of {B} has the velocity slide +
            # shift x spin.
            slide += _cross(shift[joint], spin)
            np.multiply(spin, rate[:, joint], out=angular[joint + 1])
            angular[joint + 1] += angular[joint]
            np.multiply(slide, rate[:, joint], out=linear[joint + 1])
            linear[joint + 1] += linear[joint]
        return Arm(turn, shift, angular, linear)

    def of(self, item: Item) -> Posed:
        """Return the pose and velocity of the body that carries an item."""
        return Posed(*(getattr(self, name)[item.joint] for name in self.__dataclass_fields__))


def _reach(item: Item, directions: Array) -> Array:
    """Return the support function of an item in unit directions (..., 3, P) in its own axes: the largest d ·
    p over its points p, (..., P) [m].
    """
    reach: Array = np.matmul(item.points, directions).max(axis=-2) + item.radius
    if item.disc:
        reach += item.disc * np.sqrt(np.maximum(1.0 - np.matmul(item.axis, directions) ** 2, 0.0))
    return reach


def _cross(one: Array, other: Array) -> Array:
    """Return the cross products of vectors (3, ...); the first dimension is that of the components."""
    product = np.empty(np.broadcast_shapes(one.shape, other.shape))
    for row in range(3):
        after, before = (row + 1) % 3, (row + 2) % 3
        np.multiply(one[after], other[before], out=product[row])
        product[row] -= one[before] * other[after]
    return product


@frozen(eq=False)
class Rates:
    """Upper bounds of the speed [m/s], acceleration [m/s^2] and jerk [m/s^3] of all points of an item, (N,)
    each, on the N segments of a motion.
    """

    first: Array
    second: Array
    third: Array


def rates(chain: Chain, course: Course, item: Item) -> Rates:
    """Bound speed, acceleration and jerk of an item's points on each segment of a motion.

    A partial derivative of a point with respect to some joints is a nested cross product with their axes. The
    innermost axis is that of the joint m nearest to the point, so the derivative is at most R_m, the largest
    distance of the item's points from this axis. The time derivatives are therefore at most the sum over
    the joints m of R_m (B_m - B_(m-1)). Let w, a and j be the sums of the bounds of speed, acceleration and
    jerk over the joints up to m. Then B_m is w for the speed of the point, w² + a for its acceleration, and
    w³ + 3 w a + j for its jerk. A prismatic joint moves the point along a vector of length 1 that the joints
    before it turn; Leibniz' rule gives the derivatives of this product.

    Args:
        chain: the arm.
        course: the segments of the motion.
        item: the item.
    """
    reach, turn, slide = _reaches(chain, course, item)
    w, a, j = course.speed, course.strength, np.abs(course.j)
    zero = np.zeros(len(w))
    sum_w, sum_a, sum_j = zero, zero, zero
    first, second, third = zero, zero, zero
    for joint in range(item.joint):
        if slide[joint]:
            s, v, u = (values[:, joint] * slide[joint] for values in (w, a, j))
            # Apply Leibniz' rule to the displacement by a prismatic joint: its position times a vector of
            # length 1 that the joints before it turn.
            first = first + s
            second = second + 2.0 * sum_w * s + v
            third = third + 3.0 * (sum_w**2 + sum_a) * s + 3.0 * sum_w * v + u
        if not turn[joint]:
            continue
        # Compute B before and after this joint. R_m (B_m - B_(m-1)) bounds the sum of all partial derivatives
        # in which this joint is the one nearest to the point.
        before = sum_w, sum_w**2 + sum_a, sum_w**3 + 3.0 * sum_w * sum_a + sum_j
        sum_w = sum_w + w[:, joint] * turn[joint]
        sum_a = sum_a + a[:, joint] * turn[joint]
        sum_j = sum_j + j[:, joint] * turn[joint]
        after = sum_w, sum_w**2 + sum_a, sum_w**3 + 3.0 * sum_w * sum_a + sum_j
        first = first + reach[joint] * (after[0] - before[0])
        second = second + reach[joint] * (after[1] - before[1])
        third = third + reach[joint] * (after[2] - before[2])
    return Rates(first, second, third)


def _reaches(chain: Chain, course: Course, item: Item) -> tuple[Array, Array, Array]:
    """Compute the lever arm of an item about the axis of each joint.

    Go from the item towards the base. On each axis take the point nearest to the point chosen last. The
    lengths between these points add up, since a rotation doesn't change them.

    Returns:
        Three arrays (n,): the largest distance of any point of the item from each axis [m], and the amounts
        by which each joint turns and slides per unit of its position.
    """
    lines = lines_of(chain)
    # The largest distance of each joint from zero is at most that at the start of a segment, plus the travel
    # within the segment.
    way = np.abs(course.x).max(axis=0) + np.diff(course.way, axis=0).max(axis=0)
    point, length = item.middle, item.bound
    reach = np.zeros(chain.size)
    for joint in reversed(range(item.joint)):
        length += abs(float(lines.slide[joint])) * float(way[joint])
        if not lines.turn[joint]:
            continue
        axis, origin = lines.axes[joint], lines.points[joint]
        nearest = origin + axis * float(axis @ (point - origin))
        length += float(np.linalg.norm(point - nearest))
        reach[joint] = length
        point = nearest
    return reach, lines.turn, np.abs(lines.slide)


@frozen(eq=False)
class Pieces:
    """Pieces of a motion's time.

    Attributes:
        segment: (P,) index of the segment in which each piece lies.
        begin: (P,) start of each piece, from the start of its segment [s].
        end: (P,) end of each piece, from the start of its segment [s].
    """

    segment: Rows
    begin: Array
    end: Array

    @staticmethod
    def whole(course: Course, first: int, last: int) -> Pieces:
        """Return one piece for each whole segment from `first` up to `last` (not included)."""
        segment = np.arange(first, last)
        return Pieces(segment, np.zeros(len(segment)), np.diff(course.begins)[segment])

    @property
    def middle(self) -> Array:
        """The times (P,) in the middle of the pieces, after the starts of their segments [s]."""
        return (self.begin + self.end) / 2.0

    def take(self, rows: Rows) -> Pieces:
        """Return some of the pieces."""
        return Pieces(self.segment[rows], self.begin[rows], self.end[rows])

    def halves(self) -> Pieces:
        """Return both halves of each piece: first all first halves, then all second halves."""
        middle = self.middle
        return Pieces(
            np.concatenate([self.segment, self.segment]),
            np.concatenate([self.begin, middle]),
            np.concatenate([middle, self.end]),
        )

    def posed(self, item: Item, scene: Scene, course: Course, time: Array, *, moving: bool = False) -> Posed:
        """Return the pose and velocity of the body that carries an item, at times (P,) [s] after the starts
        of the pieces' segments.

        Velocities are zero unless `moving` is True.
        """
        q, rate = joints(course, self.segment, time)
        return Arm.at(scene, q, rate if moving else None).of(item)


class Ends:
    """The arm at both ends of whole segments of a motion.

    Most segments end where the next one begins; the arm is then computed only once.
    """

    def __init__(self, scene: Scene, course: Course, pieces: Pieces, *, moving: bool = False) -> None:
        begin, rate = joints(course, pieces.segment, pieces.begin)
        end, last = joints(course, pieces.segment, pieces.end)
        # Compute separately those ends that aren't the start of the next segment, such as the last one.
        off = (np.abs(end[:-1] - begin[1:]) > _SAME).any(axis=1)
        off |= (np.abs(last[:-1] - rate[1:]) > _SAME).any(axis=1)
        jumps = np.append(np.flatnonzero(off), len(end) - 1)
        # All other segments end where the next one starts.
        q, there = np.concatenate([begin, end[jumps]]), np.concatenate([rate, last[jumps]])
        self.arm = Arm.at(scene, q, there if moving else None)
        self.begins = np.arange(len(begin))
        self.stops = np.arange(1, len(begin) + 1)
        self.stops[jumps] = len(begin) + np.arange(len(jumps))

    def of(self, item: Item, rows: Rows | None = None) -> tuple[Posed, Posed]:
        """Return the pose and velocity of the body that carries an item, first at the beginnings and then at
        the ends of all segments, or of the segments `rows`.
        """
        posed = self.arm.of(item)
        begins, stops = (self.begins, self.stops) if rows is None else (self.begins[rows], self.stops[rows])
        return posed.take(begins), posed.take(stops)


class Whole:
    """The arm at the ends of all segments of motions, computed at the first use, and once for all items."""

    def __init__(self, scene: Scene, course: Course, spans: NDArray[np.int64]) -> None:
        self.scene, self.course = scene, course
        self.pieces = Pieces.whole(course, int(spans[0, 0]), int(spans[-1, 1]))

    @cached_property
    def ends(self) -> Ends:
        """The arm at both ends of all segments, with joint velocities."""
        return Ends(self.scene, self.course, self.pieces, moving=True)


_SAME = 1e-10
"""Largest difference of joint positions [rad or m] and of their rates [per s] that counts as rounding."""


def joints(course: Course, segment: Rows, time: Array) -> tuple[Array, Array]:
    """Return joint positions and velocities, (P, n) each, at times (P,) [s] after the starts of segments
    (P,).
    """
    t = time[:, None]
    v, a, j = course.v[segment], course.a[segment], course.j[segment]
    return course.x[segment] + t * (v + t * (a / 2.0 + t * j / 6.0)), v + t * (a + t * j / 2.0)
