"""The judge's own bound of the speed of bodies in a slow zone.

The planner uses `yarclang.collision.zones.speed` instead; the two modules share no code.

Segments are halved into pieces until each piece is settled. A piece is settled if the body is proved to be
outside of the zone on it, or not faster than the largest speed found so far. It is also settled if it is too
short to decide this; then the bound of its speed counts as a speed in the zone. Three bounds settle a piece
of duration d. A point moves by at most V d. In any direction, take the lowest of a point's coordinates at
both ends and in the middle: in between, the point is lower by at most A d^2 / 32. A point's speed exceeds the
larger of its speeds at both ends by at most J d^2 / 8. V, A and J bound the first three derivatives of all
points of the body (`derivatives`).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import HalfSpace, JointWindow
from yarclang.certify.bodies.borders import Region, directions_to, extent
from yarclang.certify.kinematics.arm import axes_of, motions
from yarclang.certify.motion.bounds import Cubics
from yarclang.collision.zones.gaps import distance_outside
from yarclang.collision.zones.moved import Posed
from yarclang.collision.zones.watched import Item
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Chain

Rows = NDArray[np.int64]
Flags = NDArray[np.bool_]

SHARP = 2e-4
"""Fraction by which the bound of the largest speed may exceed the largest speed found."""
NEAR = 1e-5
"""Distance from a zone's border within which a point counts as on the border [m]."""
SAME = 1e-10
"""Largest differences of joint positions [rad or m] and velocities [rad/s or m/s] that count as rounding."""
NEAR_JOINT = 1e-6
"""Distance within which a joint position counts as on the end of a window [rad or m]."""


@frozen(eq=False)
class Fastest:
    """Largest speeds of a body in a zone, for each of G motions.

    Attributes:
        speed: (G,) upper bounds [m/s]; 0 if the body is never inside.
        segment: (G,) segment in which the body is fastest, -1 if it is never inside.
        time: (G,) middle of the fastest piece, after the start of the first segment [s].
    """

    speed: Array
    segment: Rows
    time: Array


@frozen(eq=False)
class Joints:
    """Placement and velocity, at P instants, of the bodies that the first few joints move.

    Attributes:
        turn: (3, 3, P) rotation from the pose with all joints at zero.
        shift: (3, P) translation from the pose with all joints at zero [m].
        spin: (3, P) angular velocity [rad/s].
        drift: (3, P) velocity of the point, rigidly attached to the bodies, that is at the origin of {B}
            [m/s].
    """

    turn: Array
    shift: Array
    spin: Array
    drift: Array

    def take(self, rows: Rows) -> Joints:
        """Return the placements and velocities at some of the instants."""
        return Joints(self.turn[:, :, rows], self.shift[:, rows], self.spin[:, rows], self.drift[:, rows])

    def joined(self, other: Joints) -> Joints:
        """Return these instants followed by those of `other`."""
        return Joints(
            np.concatenate([self.turn, other.turn], axis=2),
            np.concatenate([self.shift, other.shift], axis=1),
            np.concatenate([self.spin, other.spin], axis=1),
            np.concatenate([self.drift, other.drift], axis=1),
        )

    def point(self, own: Array) -> Array:
        """Return the positions (3, P) [m] of a body's point; `own` (3,) is its position with all joints at
        zero.
        """
        placed: Array = np.tensordot(self.turn, own, axes=(1, 0)) + self.shift
        return placed

    def lowest(self, item: Item, directions: Array) -> Array:
        """Compute the smallest d . p (P,) [m] over the points p of a body, for unit vectors d (3, P)."""
        own = (self.turn * directions[:, None, :]).sum(axis=0)
        low = (item.points @ own).min(axis=0) + (directions * self.shift).sum(axis=0) - item.radius
        if item.disc:
            low -= item.disc * np.sqrt(np.maximum(0.0, 1.0 - (item.axis @ own) ** 2))
        return np.asarray(low)

    def speed(self, item: Item) -> Array:
        """Bound the speeds (P,) [m/s] of all points of a body.

        The bound is exact for a body without round parts.
        """
        fastest = np.zeros(self.shift.shape[1])
        for own in item.points:
            # A point p has the velocity v + omega x p, where v is that of the body's point at the origin of
            # {B}.
            x, y, z = self.point(own)
            fastest = np.maximum(
                fastest,
                (self.drift[0] + self.spin[1] * z - self.spin[2] * y) ** 2
                + (self.drift[1] + self.spin[2] * x - self.spin[0] * z) ** 2
                + (self.drift[2] + self.spin[0] * y - self.spin[1] * x) ** 2,
            )
        return np.asarray(np.sqrt(fastest) + (item.disc + item.radius) * np.sqrt((self.spin**2).sum(axis=0)))


class Motions:
    """The segments of some motions and the arm at their ends, computed once for all bodies."""

    def __init__(self, chain: Chain, cubics: Cubics, spans: NDArray[np.int64]) -> None:
        self.chain, self.cubics, self.spans = chain, cubics, spans
        self.starts = np.cumsum(cubics.h) - cubics.h

    @cached_property
    def _ends(self) -> tuple[tuple[Array, Array, Array], Rows]:
        """Compute the arm's placements and velocities at the start of each segment, and at its end if that
        differs from the start of the next segment.

        The second value is, for each segment, the index of its end among the computed instants.
        """
        before, after = self.cubics.at(np.zeros(len(self.cubics.h))), self.cubics.at(self.cubics.h)
        count = len(self.cubics.h)
        same = [
            (np.abs(other[:-1] - one[1:]) <= SAME).all(axis=1)
            for one, other in zip(before, after, strict=True)
        ]
        last = np.append(np.flatnonzero(~(same[0] & same[1])), count - 1)
        stops = np.arange(1, count + 1)
        stops[last] = count + np.arange(len(last))
        q, rate = (np.concatenate([one, other[last]]) for one, other in zip(before, after, strict=True))
        return motions(self.chain, q, rate), stops

    def ends(self, joint: int) -> tuple[Joints, Joints]:
        """Return the placements and velocities of the bodies that the first `joint` joints move, at the
        starts and at the ends of all segments.
        """
        found, stops = self._ends
        arm = _of(found, joint)
        return arm.take(np.arange(len(stops))), arm.take(stops)

    def at(self, joint: int, segment: Rows, time: Array) -> Joints:
        """Return the placements of the bodies that the first `joint` joints move, at the times `time` (P,)
        after the starts of the segments `segment` (P,).
        """
        return _of(motions(self.chain, *self.cubics.take(segment).at(time)), joint)


def _of(found: tuple[Array, Array, Array], joint: int) -> Joints:
    placed, spin, drift = found
    return Joints(placed[joint, :, :3], placed[joint, :, 3], spin[joint], drift[joint])


def fastest_in(motions_: Motions, region: Region | JointWindow, margin: float, item: Item) -> Fastest:
    """Bound the speed of a body in a slow zone during each motion.

    Args:
        motions_: the segments, and the range of each motion.
        region: the region of the zone.
        margin: distance outside of the region at which the zone begins [m].
        item: a convex body or a point that the joints move.
    """
    return _Search(motions_, region, margin, item).found()


class _Search:
    """Search for the largest speed of one body in all motions."""

    def __init__(self, motions_: Motions, region: Region | JointWindow, margin: float, item: Item) -> None:
        self.all, self.region, self.margin, self.item = motions_, region, margin, item
        self.first, self.second, self.third = derivatives(motions_.chain, motions_.cubics, item)
        count = len(motions_.spans)
        self.motion = np.repeat(np.arange(count), np.diff(motions_.spans, axis=1)[:, 0])
        self.best, self.time = np.zeros(count), np.zeros(count)
        self.segment = np.full(count, -1, dtype=np.int64)

    def found(self) -> Fastest:
        """Halve pieces of segments until all are settled, and return the bounds of the speeds."""
        segment = np.arange(len(self.all.cubics.h))
        begin, end = np.zeros(len(segment)), self.all.cubics.h
        arms = self.all.ends(self.item.joint)
        while len(segment):
            go_on()
            rows = np.flatnonzero(~self._is_far(segment, begin, end, arms))
            segment, begin, end = segment[rows], begin[rows], end[rows]
            arms = arms[0].take(rows), arms[1].take(rows)
            bound = np.maximum(arms[0].speed(self.item), arms[1].speed(self.item))
            # On a chord of velocities, the speed is largest at an end. On a piece of duration d, the velocity
            # leaves its chord by at most J d^2 / 8, where J bounds the third derivative.
            bound = bound + self.third[segment] * (end - begin) ** 2 / 8.0
            rows = np.flatnonzero(self._is_open(segment, bound))
            segment, begin, end, bound = segment[rows], begin[rows], end[rows], bound[rows]
            arms = arms[0].take(rows), arms[1].take(rows)
            half = (begin + end) / 2.0
            middle = self.all.at(self.item.joint, segment, half)
            out, inside = self._where(segment, end - begin, half, (arms[0], middle, arms[1]))
            # If the body is inside the zone in the middle of a piece, its speed there may raise the largest
            # speed found, which settles other pieces.
            self._learn(segment[inside], half[inside], middle.take(np.flatnonzero(inside)).speed(self.item))
            # If the body moves by less than `NEAR` on a piece, more halving won't decide whether it is
            # inside: regard it as inside, and count the bound of its speed.
            short = ~out & ~(self.first[segment] * (end - begin) > NEAR)
            self._learn(segment[short], half[short], bound[short])
            rows = np.flatnonzero(~out & ~short & self._is_open(segment, bound))
            segment = np.concatenate([segment[rows], segment[rows]])
            begin, end = np.concatenate([begin[rows], half[rows]]), np.concatenate([half[rows], end[rows]])
            inner = middle.take(rows)
            arms = arms[0].take(rows).joined(inner), inner.joined(arms[1].take(rows))
        return Fastest(np.where(self.segment >= 0, self.best * (1.0 + SHARP), 0.0), self.segment, self.time)

    def _is_open(self, segment: Rows, bound: Array) -> Flags:
        """Return True for pieces that must be examined further: the bound of their speed exceeds the largest
        speed found so far in their motion, increased by the fraction `SHARP`.

        A comparison with NaN is False. It is negated, so that a piece whose bound is NaN stays open. A motion
        in which NaN was found is settled: no zone allows this speed.
        """
        known = self.best[self.motion[segment]] * (1.0 + SHARP)
        return np.asarray(~(bound <= known) & ~np.isnan(known))

    def _is_far(self, segment: Rows, begin: Array, end: Array, arms: tuple[Joints, Joints]) -> Flags:
        """Return True for pieces on which the body stays outside of the zone, as shown by a ball around the
        body or by the ranges of the joints.
        """
        region, long = self.region, end - begin
        if isinstance(region, JointWindow):
            # On a piece of duration d, a joint position leaves its chord by at most d^2 / 8 times the largest
            # acceleration.
            cubics = self.all.cubics.take(segment)
            before, after = cubics.at(begin)[0], cubics.at(end)[0]
            most = np.maximum(np.abs(cubics.a), np.abs(cubics.a + cubics.h[:, None] * cubics.j))
            sag = most * (long**2 / 8.0)[:, None] + NEAR_JOINT
            below = np.maximum(before, after) + sag < region.lower
            return np.asarray((below | (np.minimum(before, after) - sag > region.upper)).any(axis=1))
        # The body's middle is no faster than V = `first`, so its signed distance from the region changes by
        # at most V d on a piece of duration d. It is therefore nowhere less than half of (the sum of its
        # values at both ends, less V d).
        gaps = np.zeros(len(segment))
        for arm in arms:
            center = arm.point(self.item.middle)
            toward = directions_to(region, center)
            gaps += (toward * center).sum(axis=0) - extent(region, toward)
        far: Flags = (gaps - self.first[segment] * long) / 2.0 - self.item.bound > self.margin
        return far

    def _where(
        self, segment: Rows, long: Array, half: Array, arms: tuple[Joints, Joints, Joints]
    ) -> tuple[Flags, Flags]:
        """Return two masks of pieces: True where the body stays outside of the zone; True where it is inside
        in the middle of the piece.
        """
        region = self.region
        if isinstance(region, JointWindow):
            q = self.all.cubics.take(segment).at(half)[0]
            within = (q >= region.lower - NEAR_JOINT) & (q <= region.upper + NEAR_JOINT)
            return np.zeros(len(segment), dtype=np.bool_), np.asarray(within.all(axis=1))
        toward = directions_to(region, arms[1].point(self.item.middle))
        out, seen = self._beyond(region, segment, long, arms, toward)
        if self.item.of_coal is not None and not isinstance(region, HalfSpace):
            # For a body beside a region, the direction from its middle may show no gap although another
            # direction does: try the direction that coal proposes.
            rows = np.flatnonzero(~out)
            toward = self._proposed(region, arms[1].take(rows))
            few = arms[0].take(rows), arms[1].take(rows), arms[2].take(rows)
            out[rows], closer = self._beyond(region, segment[rows], long[rows], few, toward)
            seen[rows] = np.maximum(seen[rows], closer)
        return out, np.logical_not(seen > self.margin + NEAR / 2.0)

    def _beyond(
        self, region: Region, segment: Rows, long: Array, arms: tuple[Joints, Joints, Joints], toward: Array
    ) -> tuple[Flags, Array]:
        """Return a mask of the pieces on which planes keep the body out of the zone, and the gaps (P,) [m] in
        the middles of the pieces.

        `toward` (3, P) are the normals of the planes, one for each piece.
        """
        # Let n be the normal of a plane. The gap at an instant is the least n . p over the points p of the
        # body, less the largest n . p over the region.
        low = [arm.lowest(self.item, toward) for arm in arms]
        reach = extent(region, toward)
        seen = low[1] - reach
        # On each half of a piece of duration d, n . p leaves its chord by at most A (d / 2)^2 / 8, where A
        # bounds the acceleration.
        chords = (
            np.minimum(np.minimum(low[0], low[2]), low[1]) - reach - self.second[segment] * long**2 / 32.0
        )
        least = np.maximum(chords, seen - self.first[segment] * long / 2.0)
        return least > self.margin, seen

    def _proposed(self, region: Region, arm: Joints) -> Array:
        """Return normals (3, P) of separating planes, proposed by coal.

        A wrong normal does no harm, since `_beyond` proves the gap along it.
        """
        normal = np.empty((arm.shift.shape[1], 3))
        distance_outside(region, self.item, Posed(arm.turn, arm.shift, arm.spin, arm.drift), normal)
        size = np.sqrt((normal**2).sum(axis=1))
        lost = ~(np.abs(size - 1.0) < 1e-9)
        normal[lost] = [0.0, 0.0, 1.0]
        return np.ascontiguousarray(normal.T)

    def _learn(self, segment: Rows, time: Array, speed: Array) -> None:
        """Store the largest speed found so far in each motion, and where it occurs."""
        motion = self.motion[segment]
        most = self.best.copy()
        np.maximum.at(most, motion, speed)
        # Select the rows with a new maximum of their motion. The comparisons are negated, so that rows with
        # NaN are selected too.
        new = np.flatnonzero(~(speed < most[motion]) & ~(most[motion] <= self.best[motion]))
        self.segment[motion[new]] = segment[new]
        self.time[motion[new]] = self.all.starts[segment[new]] + time[new]
        self.best = most


def derivatives(chain: Chain, cubics: Cubics, item: Item) -> tuple[Array, Array, Array]:
    """Bound |p'|, |p''| and |p'''| of all points p of a body on N segments, (N,) each [m/s, m/s^2, m/s^3].

    The position of a point is a sum of vectors from one joint axis to the next, each of a fixed length and
    turned by the joints before it. The derivatives of such a vector are at most its length times W, W^2 + A
    and W^3 + 3 W A + J, with the sums W, A and J of these joints' largest velocities, accelerations and
    jerks. A vector along a prismatic joint also changes its length; Leibniz' rule gives its derivatives.
    """
    lines = axes_of(chain)
    peaks = (
        cubics.velocity_peaks(),
        np.maximum(np.abs(cubics.a), np.abs(cubics.a + cubics.h[:, None] * cubics.j)),
        np.abs(cubics.j),
    )
    # The largest distance of each joint from zero on a segment is at most that at its start, plus the largest
    # velocity times the duration.
    farthest = np.abs(cubics.x) + peaks[0] * cubics.h[:, None]
    # Go from the body towards the base. The foot on each axis is the point nearest to the previous foot, and
    # the distances between feet are the lengths of the vectors. They don't change while the joints turn.
    lengths = np.zeros(item.joint)
    here, rest = item.middle, item.bound
    for joint in range(item.joint - 1, -1, -1):
        if lines.turn[joint]:
            axis, on_axis = lines.axes[joint], lines.points[joint]
            foot = here - np.cross(axis, np.cross(here - on_axis, axis))
            lengths[joint] = rest + float(np.sqrt(((here - foot) ** 2).sum()))
            here, rest = foot, 0.0
    w, a, j = (np.zeros(len(cubics.h)) for _ in range(3))
    first, second, third = (np.zeros(len(cubics.h)) for _ in range(3))
    for joint in range(item.joint):
        turn, slide = float(lines.turn[joint]), abs(float(lines.slide[joint]))
        # Apply Leibniz' rule to a slide by the length s along an axis that turns with w, a and j, the sums of
        # the rates of the joints before.
        if slide:
            s, v, u, p = (slide * one[:, joint] for one in (farthest, *peaks))
            first = first + w * s + v
            second = second + (w**2 + a) * s + 2.0 * w * v + u
            third = third + (w**3 + 3.0 * w * a + j) * s + 3.0 * (w**2 + a) * v + 3.0 * w * u + p
        # The vectors beyond a revolute joint turn with it as well.
        w, a, j = (before + turn * one[:, joint] for before, one in zip((w, a, j), peaks, strict=True))
        first = first + lengths[joint] * w
        second = second + lengths[joint] * (w**2 + a)
        third = third + lengths[joint] * (w**3 + 3.0 * w * a + j)
    return first, second, third
