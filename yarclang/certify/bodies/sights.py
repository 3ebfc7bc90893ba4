"""Proof that points stay in cones (KEEP ... FACING, KEEP ... SEEN) while a controller text runs.

It shares no code with `yarclang.collision.zones.sights`, which the planner uses: it has the judge's own
kinematics.

The vector v from the apex of the cone to the point has |v'| <= V and |v''| <= A on a segment, since one of
apex and point stands still and the other is a point of the flange. On a piece of duration d, v differs from
its chord by at most A d^2 / 8. Therefore the length r of v is at least the chord's least distance from the
apex, less A d^2 / 8. It is also at least half of (the sum of its values at both ends, less V d).

For u = v / r, the component of u'' along u is -|u'|^2, and the component across is that of
(v'' - 2 r' u') / r. With r'^2 + r^2 |u'|^2 <= V^2 this gives |u'| <= V / r and
|u''| <= A / r + 2 V^2 / r^2. The axis a of the cone has |a'| <= W and |a''| <= B, or stands still.
The angle between u and a therefore changes no faster than W + V / r, and the second derivative of its
cosine is at most B + 2 W V / r + |u''|. Pieces are halved until one of these two bounds of the angle
settles them. Where r isn't proved to be positive, there is no bound; this does no harm, since a rule always
has a least distance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.keeping import Sight
from yarclang.certify.bodies.fastest import Joints, Motions, derivatives
from yarclang.certify.bodies.tilts import KNOWN, MOST, SHARP, SLACK
from yarclang.certify.kinematics.arm import axes_of, flange_poses
from yarclang.collision.zones.watched import point_item
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Chain


@frozen(eq=False)
class Sighted:
    """Proved position of a point relative to a cone, during each of G motions.

    Attributes:
        most: (G,) upper bounds of the angle from the cone's axis [rad]; infinite for a motion that breaks the
            rule.
        least: (G,) lower bounds of the distance from the apex [m]; 0 for a motion that breaks the rule.
        farthest: (G,) upper bounds of the distance from the apex [m]; infinite for a motion that breaks the
            rule.
        when: (G,) the time of the worst sample after the start of the first segment [s].
        exceeds: (G,) True for motions that break the rule, or aren't proved to keep it.
    """

    most: Array
    least: Array
    farthest: Array
    when: Array
    exceeds: NDArray[np.bool_]


@frozen(eq=False)
class Aim:
    """Position of a point relative to a cone at P instants.

    Attributes:
        angle: (P,) angle of the point from the cone's axis [rad].
        distance: (P,) distance of the point from the apex [m].
        way: (3, P) vector from the apex to the point [m].
    """

    angle: Array
    distance: Array
    way: Array

    def take(self, rows: NDArray[np.int64]) -> Aim:
        """Return the positions at some of the instants."""
        return Aim(self.angle[rows], self.distance[rows], self.way[:, rows])

    def joined(self, other: Aim) -> Aim:
        """Return these instants followed by those of another object."""
        return Aim(
            np.concatenate([self.angle, other.angle]),
            np.concatenate([self.distance, other.distance]),
            np.concatenate([self.way, other.way], axis=1),
        )


def seen_at(chain: Chain, sight: Sight, q: Array) -> tuple[float, float]:
    """Return the angle [rad] and the distance [m] of a point relative to a cone, at a joint position (n,)."""
    flange = flange_poses(chain, q[None])[0]
    carried, spot = flange[:3, :3] @ np.array(sight.own) + flange[:3, 3], np.array(sight.spot)
    axis = flange[:3, :3] @ np.array(sight.axis) if sight.is_carried else np.array(sight.axis)
    way = spot - carried if sight.is_carried else carried - spot
    across = np.cross(axis, way)
    return float(np.arctan2(np.sqrt(across @ across), axis @ way)), float(np.sqrt(way @ way))


class _Cone:
    """A rule about a cone, for the segments of some motions, with bounds of the motions' derivatives."""

    def __init__(self, motions: Motions, sight: Sight) -> None:
        chain, cubics = motions.chain, motions.cubics
        turn, shift = chain.base_from_flange[:3, :3], chain.base_from_flange[:3, 3]
        self.sight, self.spot = sight, np.array(sight.spot)[:, None]
        self.own = turn @ np.array(sight.own) + shift
        self.axis = np.array(sight.axis)
        self.turning, self.bending = np.zeros(len(cubics.h)), np.zeros(len(cubics.h))
        if sight.is_carried:
            self.axis = turn @ self.axis
            turns = axes_of(chain).turn
            # The axis is a unit vector turned by the joints one after the other. Each of its partial
            # derivatives over joint positions has length 1 at most. With the sums W and A of all joints'
            # largest velocities and accelerations, |a'| <= W and |a''| <= A + W^2 therefore hold (Faa di
            # Bruno).
            self.turning = np.abs(cubics.velocity_peaks()) @ turns
            peaks = np.maximum(np.abs(cubics.a), np.abs(cubics.a + cubics.h[:, None] * cubics.j))
            self.bending = peaks @ turns + self.turning**2
        point = point_item("a point of the flange", chain.size, self.own)
        self.speed, self.strength, _ = derivatives(chain, cubics, point)

    def aim(self, arm: Joints) -> Aim:
        """Return the point's position relative to the cone, for placements of the arm."""
        carried = arm.point(self.own)
        if self.sight.is_carried:
            way, axis = self.spot - carried, np.tensordot(arm.turn, self.axis, axes=(1, 0))
        else:
            way, axis = carried - self.spot, np.broadcast_to(self.axis[:, None], carried.shape)
        # The angle by atan2 of cross and dot product is accurate near 0 and pi, where arccos of the dot
        # product is not.
        cross = (
            axis[1] * way[2] - axis[2] * way[1],
            axis[2] * way[0] - axis[0] * way[2],
            axis[0] * way[1] - axis[1] * way[0],
        )
        dot = axis[0] * way[0] + axis[1] * way[1] + axis[2] * way[2]
        angle = np.arctan2(np.sqrt(cross[0] ** 2 + cross[1] ** 2 + cross[2] ** 2), dot)
        return Aim(angle, np.sqrt(way[0] ** 2 + way[1] ** 2 + way[2] ** 2), way)

    def excess(self, aim: Aim) -> Array:
        """Return the amounts (P,) [rad or m] by which the rule is exceeded; not positive where it is kept."""
        sight = self.sight
        found: Array = np.maximum.reduce(
            [aim.angle - sight.limit, sight.near - aim.distance, aim.distance - sight.far]
        )
        return found

    def bounds(
        self, segment: NDArray[np.int64], long: Array, before: Aim, after: Aim
    ) -> tuple[Array, Array, Array]:
        """Return the largest angle [rad] and the least and the largest distance [m] on each piece, (P,)
        each.
        """
        # On a piece of duration d, the point moves by at most V d, and leaves its chord by at most A d^2 / 8.
        # V and A bound its velocity and its acceleration.
        speed, sag = self.speed[segment] * long, self.strength[segment] * long**2 / 8.0
        step = after.way - before.way
        # Find the point of the chord that is nearest to the apex: the projection of the apex, clipped to the
        # chord.
        size, toward = (step**2).sum(axis=0), -(before.way * step).sum(axis=0)
        share = np.where(size > 0.0, np.clip(toward / np.where(size > 0.0, size, 1.0), 0.0, 1.0), 0.0)
        chord = np.sqrt(((before.way + share * step) ** 2).sum(axis=0))
        both = before.distance + after.distance
        # On the piece, the point's distance from the apex changes by at most `speed`. It differs from the
        # chord's distance by at most `sag`, and the chord's distance is largest at an end.
        low = np.maximum((both - speed) / 2.0, chord - sag)
        high = np.minimum((both + speed) / 2.0, np.maximum(before.distance, after.distance) + sag)
        known = low > 0.0
        radius = np.where(known, low, np.inf)
        # Bound |u'| by V / r, and the second derivative of the cosine by B + 2 W V / r + |u''|, as derived at
        # the head of this module.
        swing = self.speed[segment] / radius
        turning = self.turning[segment]
        bend = self.bending[segment] + 2.0 * turning * swing
        bend = bend + self.strength[segment] / radius + 2.0 * swing**2
        worst = np.maximum(before.angle, after.angle)
        # On a piece of duration d, the cosine falls below its chord by at most d^2 / 8 times its second
        # derivative.
        cosine = np.cos(worst) - bend * long**2 / 8.0
        most = np.minimum(
            (before.angle + after.angle + (turning + swing) * long) / 2.0,
            np.arccos(np.clip(cosine, -1.0, 1.0)),
        )
        return np.where(known, most, np.inf), low, high


def sighted(motions: Motions, sight: Sight) -> Sighted:
    """Bound the angle and the distance of a point relative to a cone, during each motion.

    Args:
        motions: the segments, and the range of each motion; none is empty.
        sight: the cone and the point.
    """
    cone, spans, joints = _Cone(motions, sight), motions.spans, motions.chain.size
    count = len(spans)
    motion = np.repeat(np.arange(count), np.diff(spans, axis=1)[:, 0])
    # The motions' segments are consecutive.
    first = int(spans[0, 0])
    segment = np.arange(first, first + len(motion))
    begin, end = np.zeros(len(segment)), motions.cubics.h[segment]
    before, after = (cone.aim(one).take(segment) for one in motions.ends(joints))
    most, seen, farthest = np.zeros(count), np.zeros(count), np.zeros(count)
    least, over = np.full(count, np.inf), np.full(count, -np.inf)
    when, exceeds = np.zeros(count), np.zeros(count, np.bool_)

    def learn(rows: NDArray[np.int64], aim: Aim, time: Array) -> None:
        """Store the largest angle of each motion, and its worst sample with its time."""
        excess, owner = cone.excess(aim), motion[rows - first]
        np.maximum.at(seen, owner, aim.angle)
        # Written in ascending order, so that the largest excess of a motion is written last.
        order = np.argsort(excess, kind="stable")
        larger = order[excess[order] > over[owner[order]]]
        over[owner[larger]] = excess[larger]
        when[owner[larger]] = (motions.starts[rows] + time)[larger]

    learn(segment, before, begin)
    learn(segment, after, end)
    done = 0
    while len(segment):
        go_on()
        owner, long = motion[segment - first], end - begin
        angle, low, high = cone.bounds(segment, long, before, after)
        exceeds |= ~(over <= SLACK / 2.0)
        enough = np.minimum(
            sight.limit + SLACK, np.maximum(seen[owner] * (1.0 + SHARP) + SLACK, sight.limit * KNOWN)
        )
        # A comparison with NaN is False, so a piece with NaN is never settled.
        kept = (angle <= enough) & (low >= sight.near - SLACK) & (high <= sight.far + SLACK)
        settled = kept | exceeds[owner]
        np.maximum.at(most, owner[settled], angle[settled])
        np.minimum.at(least, owner[settled], low[settled])
        np.maximum.at(farthest, owner[settled], high[settled])
        rows = np.flatnonzero(~settled)
        done += len(rows)
        if done > MOST:
            exceeds[owner[rows]] = True
            break
        segment, begin, end = segment[rows], begin[rows], end[rows]
        before, after = before.take(rows), after.take(rows)
        # Halve the pieces that aren't settled. The middle is the end of one half and the start of the other.
        half = (begin + end) / 2.0
        if len(rows):
            middle = cone.aim(motions.at(joints, segment, half))
            learn(segment, middle, half)
            segment = np.concatenate([segment, segment])
            begin, end = np.concatenate([begin, half]), np.concatenate([half, end])
            before, after = before.joined(middle), middle.joined(after)
    return Sighted(
        np.where(exceeds, np.inf, most),
        np.where(exceeds, 0.0, least),
        np.where(exceeds, np.inf, farthest),
        when,
        exceeds,
    )
