"""Check the control points of a chain over time: compute which share of each limit they use, and which share
of the allowed distance from the paths.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.chains.flowing.demands import WITHIN, Demands, Limits
from yarclang.motion.chains.flowing.means import Sampled
from yarclang.motion.chains.flowing.turns import angle_between, matrices
from yarclang.motion.chains.flowing.way import Marks, Numbers, Way
from yarclang.motion.curve import Curve, knot_values, middle_values
from yarclang.motion.framespeed import frame_speeds
from yarclang.robot.kinematics.fk import poses_and_jacobians, tool_poses

_NOTHING = 1e-12
_AHEAD = 5e-4
"""Half of the interval of a path's parameter over which its direction is measured."""
_FOR_TURNS = 1.5
_LITTLE = 1e-3
_SHARPER = 0.35
"""Factor for a reserve at corners: the distance from the path is multiplied by 1 plus this factor times the
change of direction at the corner.

Bounds are less sharp at a corner, and the proof requires that each path is followed up to its end at some
instant.
"""
_FASTER = 1.0004
"""Factor up to which a requested speed may be exceeded. The proof allows more; the difference is its
reserve.
"""
_STEEP, _BETWEEN = 2e-4, 2.0
"""A speed is sampled more closely if it changes by more than the share `_STEEP` from one half segment to the
next, and would be too fast if it rose by `_BETWEEN` times this change.
"""
_PARTS = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
"""Shares of a half segment at which the speed is sampled more closely.

The end of the half segment is included, since a slower motion may end there, just before the speed rises.
"""
_NEARBY = 1.5
"""Number of segments from a corner within which a place may belong to either motion at the corner."""


@frozen(eq=False)
class Excess:
    """The places at which something exceeds what is allowed: `times` (N,) [s], and `shares` (N,), which are
    the ratios to the allowed amounts, all above 1.
    """

    times: Array
    shares: Array

    @staticmethod
    def of(times: Array, shares: Array) -> Excess:
        """Return those of the shares (N,) that are above 1, with their times."""
        over = shares > 1.0
        return Excess(times[over], shares[over])

    def and_of(self, other: Excess) -> Excess:
        """Return these excesses together with others."""
        return Excess(np.concatenate((self.times, other.times)), np.concatenate((self.shares, other.shares)))

    def between(self, begin: float, end: float) -> Excess:
        """Return the excesses that occur from one time up to another [s]."""
        own = (self.times >= begin) & (self.times <= end)
        return Excess(self.times[own], self.shares[own])


@frozen(eq=False)
class Trial:
    """The result of checking the control points of a chain.

    `ends` (k + 1,) are the knots at which motions end, `halves` (k - 1,) half the widths of the overlaps at
    the corners [segments]. `limits`, `way` and `zones` are the excesses over limits and requested speeds,
    over the allowed distances from the paths, and over the speeds of slow zones.
    """

    ends: Numbers
    halves: Numbers
    limits: Excess
    way: Excess
    zones: Excess

    @property
    def is_good(self) -> bool:
        """True if there is no excess."""
        return not (len(self.limits.times) or len(self.way.times) or len(self.zones.times))


def tried(
    way: Way,
    demands: Demands,
    sampled: Sampled,
    segment: float,
    rounds: Marks,
    own: slice,
    time: tuple[float, float],
) -> Trial | None:
    """Check the control points of a chain; return None if a motion would have no segment.

    Args:
        way: the paths of the chain.
        demands: the limits and corners of the chain.
        sampled: the control points.
        segment: the segment time [s].
        rounds: mask of the corners that are rounded within their balls (k - 1,).
        own: range of the motions that belong to the window. Only these must have a segment.
        time: the interval in which excesses are reported [s].
    """
    passed = sampled.begin + sampled.passing(way.begins[1:-1], segment)
    # A motion ends at the knot nearest to the time at which its end corner is passed.
    inner = np.round((passed - sampled.begin) / segment).astype(np.int64)
    ends = np.concatenate(([0], inner, [len(sampled.points) - 3]))
    if (np.diff(ends)[own] < 1).any():
        return None
    sharper = 1.0 + _SHARPER * demands.turn[demands.corners - 1]
    looked = _Look(way, demands.limits, sampled, segment, passed, rounds, ends, sharper)
    poses = looked.poses()
    halves, beside = looked.way_left(poses)
    excesses = (looked.limits_broken().and_of(looked.too_fast(poses, halves)), beside, looked.zones_broken())
    return Trial(ends, halves, *(one.between(*time) for one in excesses))


@frozen(eq=False)
class _Look:
    way: Way
    limits: Limits
    sampled: Sampled
    segment: float
    passed: Array
    rounds: Marks
    ends: Numbers
    sharper: Array

    def limits_broken(self) -> Excess:
        """Return the excesses of the control points over the limits of velocity, acceleration and jerk.

        The derivatives of the curve are bounded by differences of control points (convex hull property).
        """
        points, h, limits = self.sampled.points, self.segment, self.limits
        times, shares = [], []
        for order, name in ((1, "velocity"), (1, "motor_velocity"), (2, "acceleration"), (3, "jerk")):
            change = np.diff(points, order, axis=0)
            if name == "motor_velocity":
                change = change @ limits.counts.T
            # A difference counts for the middle of the control points from which it is computed.
            at = self.sampled.begin + h * (np.arange(len(change), dtype=np.float64) + 0.5 * order - 1.0)
            own = self._own(at)
            times.append(at)
            shares.append((np.abs(change) / getattr(limits, name)[own]).max(axis=1) / h**order)
        return Excess.of(np.concatenate(times), np.concatenate(shares))

    def zones_broken(self) -> Excess:
        """Return the excesses of items over the speeds of their slow zones."""
        if self.limits.zones is None:
            return Excess(np.zeros(0), np.zeros(0))
        segments, factors = self.limits.zones.too_fast(self.sampled.points, self.segment)
        return Excess(self.sampled.begin + self.segment * (segments + 0.5), factors)

    def _own(self, times: Array) -> Numbers:
        """Return the motions (N,) that are under way at given times."""
        return np.searchsorted(self.passed, times, side="right")

    def poses(self) -> Array:
        """Return the poses of the moving frame (N, 4, 4) at all knots and in the middle of all segments."""
        points, way = self.sampled.points, self.way
        curve = np.empty((2 * len(points) - 5, points.shape[1]))
        curve[0::2], curve[1::2] = knot_values(points), middle_values(points)
        found: Array = tool_poses(way.paths[0].chain, curve, way.flange_from_moving)
        return found

    def too_fast(self, poses: Array, halves: Numbers) -> Excess:
        """Return the excesses of the moving frame over the requested speeds.

        The frame may be too fast because the control points were sharpened, so that the curve overshoots
        slightly.

        Args:
            poses: (N, 4, 4) poses of the frame, two in each segment.
            halves: (k - 1,) half the widths of the overlaps at the corners, in segments.
        """
        h, path, points = self.segment, self.way.paths[0], self.sampled.points
        speeds = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1) / (0.5 * h)
        at = 0.5 * h * np.arange(len(speeds), dtype=np.float64)
        # A segment belongs to the motion between whose ends it lies. Only in a blend, the speed of the faster
        # of the two motions is allowed.
        segments = np.arange(len(speeds)) // 2
        limit, inner = self.limits.speed, self.ends[1:-1]
        one = limit[np.searchsorted(inner - halves, segments, side="right")]
        other = limit[np.searchsorted(inner + halves, segments, side="right")]
        allowed = _FASTER * np.maximum(one, other)
        # A changing speed may be higher between two samples than at them.
        change = np.abs(np.diff(speeds, prepend=speeds[0], append=speeds[-1]))
        steepest = np.maximum(change[1:], change[:-1])
        (rows,) = np.nonzero((steepest > _STEEP * speeds) & (speeds + _BETWEEN * steepest > allowed))
        times = at[rows] + 0.5 * h * _PARTS[:, None]
        q, rate, _ = Curve(points, h, points[:, 0]).sample(times.ravel())
        closer = frame_speeds(path, q, rate).reshape(times.shape)
        speeds[rows] = np.maximum(speeds[rows], closer.max(axis=0))
        return Excess.of(self.sampled.begin + at + 0.25 * h, speeds / allowed)

    def way_left(self, poses: Array) -> tuple[Numbers, Excess]:
        """Compute the excesses of the curve over the allowed distance from the programmed paths.

        Args:
            poses: (N, 4, 4) poses of the frame, two in each segment.

        Returns:
            Half the widths of the overlaps at the corners [segments], and the excesses. In overlaps the
            distance is from the corner, otherwise from the path.
        """
        way, limits, h = self.way, self.limits, self.segment
        at = np.arange(len(poses)) / 2.0
        times = self.sampled.begin + h * at
        gone = np.empty(len(poses))
        gone[0::2], gone[1::2] = knot_values(self.sampled.places), middle_values(self.sampled.places)
        off = self._off(poses, gone)
        corner, from_corner = self._nearest(at)
        halves = np.zeros(len(self.passed), dtype=np.int64)
        if not len(halves):
            return halves, Excess.of(times, off)
        # At a corner with a ball, the knots determine which motion a place belongs to.
        rows = np.flatnonzero(self.rounds[corner] & (off > _LITTLE))
        off[rows] = self._off_by_knots(poses[rows], gone[rows], at[rows])
        rows = rows[off[rows] > 1.0]
        np.maximum.at(halves, corner[rows], np.floor(from_corner[rows] + 1e-9).astype(np.int64) + 1)
        halves = np.where(self.rounds, np.maximum(halves, 1), 0)
        sizes = np.diff(self.ends)
        halves = np.minimum(halves, np.minimum(sizes[:-1], sizes[1:]) // 2)
        # At the end of a blend, both the distance from the corner and that from the path count.
        in_ball, on_path = from_corner <= halves[corner], from_corner >= halves[corner]
        in_ball &= halves[corner] > 0
        centres = way.positions(np.arange(1, len(halves) + 1), np.zeros(len(halves)))
        radii = np.maximum(WITHIN * limits.radius, _NOTHING)
        away = np.linalg.norm(poses[:, :3, 3] - centres[corner], axis=1)
        share = np.where(in_ball, away / radii[corner], 0.0)
        share = np.where(on_path, np.maximum(share, off), share)
        # The end of a blend may be nearer to another corner than to its own: check it for its own corner.
        (rounded,) = np.nonzero(halves)
        for knots in (self.ends[1:-1] - halves, self.ends[1:-1] + halves):
            rows = 2 * knots[rounded]
            away = np.linalg.norm(poses[rows, :3, 3] - centres[rounded], axis=1)
            share[rows] = np.maximum(share[rows], away / radii[rounded])
        missed = np.where(self.rounds & (halves > 0), 0.0, self._missed())
        return halves, Excess.of(np.concatenate((times, self.passed)), np.concatenate((share, missed)))

    def _nearest(self, at: Array) -> tuple[Numbers, Array]:
        """Return the nearest corner for each of N times `at` [segments], and the time from or to this corner
        [segments], (N,) each.
        """
        own = np.clip(np.searchsorted(self.ends, at, side="right") - 1, 0, len(self.ends) - 2)
        before = at - self.ends[own] <= self.ends[own + 1] - at
        corner = np.clip(np.where(before, own - 1, own), 0, max(len(self.passed) - 1, 0))
        return corner, np.abs(at - self.ends[corner + 1])

    def _off(self, poses: Array, gone: Array) -> Array:
        """Return the distances of poses from the path of their motion, as shares (N,) of the tolerance.

        Near a corner, the distance from the path beyond the corner counts if it is smaller.

        Args:
            poses: (N, 4, 4) poses of the frame, two in each segment.
            gone: (N,) places of these poses along the chain [m].
        """
        way = self.way
        own, share = way.located(gone)
        off = self._beside(poses, own, share)
        # Up to this distance from a corner, the path beyond the corner counts too: the distance covered in
        # `_NEARBY` segments. In each segment there are two poses.
        near = 2.0 * _NEARBY * np.gradient(gone)
        for side, edge, end in ((-1, gone - way.begins[own], 1.0), (1, way.begins[own + 1] - gone, 0.0)):
            other = np.clip(own + side, 0, len(way.paths) - 1)
            (rows,) = np.nonzero((edge < near) & (other != own))
            if len(rows):
                beside = self._beside(poses[rows], other[rows], np.full(len(rows), end))
                corner = np.clip(own[rows] + min(side, 0), 0, len(self.sharper) - 1)
                off[rows] = self.sharper[corner] * np.minimum(off[rows], beside)
        return off

    def _off_by_knots(self, poses: Array, gone: Array, at: Array) -> Array:
        """Return the distances of poses (N, 4, 4) from the path of their motion, as shares (N,) of the
        tolerance.

        The time `at` (N,) [segments] decides to which motion a pose belongs. At the border of two motions,
        the larger distance counts.
        """
        off, count = np.zeros(len(at)), len(self.way.paths)
        for side in ("left", "right"):
            own = np.clip(np.searchsorted(self.ends, at, side=side) - 1, 0, count - 1)
            begin = self.way.begins[own]
            share = np.clip((gone - begin) / (self.way.begins[own + 1] - begin), 0.0, 1.0)
            off = np.maximum(off, self._beside(poses, own, share))
        return off

    def _beside(self, poses: Array, own: Numbers, share: Array) -> Array:
        """Return the distances of poses (N, 4, 4) from the paths of motions `own` (N,), as shares (N,) of the
        tolerance.

        `share` (N,) is the approximate place of each pose on its path.
        """
        way, p = self.way, poses[:, :3, 3]
        # Find the nearest place on the path by Newton's method; on a line one step suffices.
        for _ in range(1 if way.is_straight else 2):
            ahead = self._ahead(own, share)
            along = np.einsum("ni,ni->n", p - way.positions(own, share), ahead) / np.maximum(
                np.einsum("ni,ni->n", ahead, ahead), _NOTHING
            )
            share = np.clip(share + along, 0.0, 1.0)
        there, turns = way.poses(own, share)
        distance = np.linalg.norm(p - there, axis=1) / self.limits.position[own]
        found: Array = np.maximum(
            distance, angle_between(matrices(turns), poses[:, :3, :3]) / self.limits.angle[own]
        )
        return found

    def _ahead(self, own: Numbers, share: Array) -> Array:
        """Return the derivatives (N, 3) [m] of the frame's position with respect to the share of the path, at
        shares (N,) of the paths of motions `own` (N,).
        """
        if self.way.is_straight:
            return self.way.shift[own]
        middle, way = np.clip(share, _AHEAD, 1.0 - _AHEAD), self.way
        ahead: Array = (way.positions(own, middle + _AHEAD) - way.positions(own, middle - _AHEAD)) / (
            2.0 * _AHEAD
        )
        return ahead

    def _missed(self) -> Array:
        """Return the distance by which the curve misses each corner, as a share (k - 1,) of the tolerance.

        Passing a corner early or late along the path doesn't count as missing it.
        """
        way, h, limits = self.way, self.segment, self.limits
        points, count = self.sampled.points, len(self.passed)
        q, rate, _ = Curve(points, h, points[:, 0]).sample(self.passed - self.sampled.begin)
        poses, jacobians = poses_and_jacobians(way.paths[0].chain, q, way.flange_from_moving)
        p, turns = way.poses(np.arange(1, count + 1), np.zeros(count))
        twist = np.einsum("nij,nj->ni", jacobians, rate)
        velocity, spin = twist[:, :3], twist[:, 3:]
        miss = p - poses[:, :3, 3]
        square = np.maximum(np.einsum("ni,ni->n", velocity, velocity), _NOTHING)
        # Find the instant, at most a segment away, at which the frame is nearest to the corner: move the
        # frame along its velocity, and rotate it at its present rate, up to this instant.
        late = np.clip(np.einsum("ni,ni->n", miss, velocity) / square, -h, h)[:, None]
        turned = poses[:, :3, :3] + late[:, :, None] * np.cross(spin[:, :, None], poses[:, :3, :3], axis=1)
        distance = np.linalg.norm(miss - late * velocity, axis=1)
        turned_by = angle_between(matrices(turns), turned) / np.minimum(limits.angle[1:], limits.angle[:-1])
        # If the direction of the path changes as well, the orientation is nearest at another instant than the
        # position: add a reserve.
        turned_by *= self.sharper**_FOR_TURNS
        found: Array = self.sharper * np.maximum(
            distance / np.minimum(limits.position[1:], limits.position[:-1]), turned_by
        )
        return found
