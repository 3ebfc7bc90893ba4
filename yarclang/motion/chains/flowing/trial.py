"""What control points of a chain ask of the limits, and how far they leave its paths: as shares of what is allowed, at times."""

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
"""Half of the share of a way over which its direction is taken."""
_FOR_TURNS = 1.5
_LITTLE = 1e-3
_SHARPER = 0.35
"""By how much more, for each unit of the change of direction, a path is left where a corner is cut off: there it is followed to its end at one instant, which can't be proved so sharply."""
_FASTER = 1.0004
"""The share of a speed that is asked for by which it may be exceeded; that it may be a little more is left to the proof."""
_STEEP, _BETWEEN = 2e-4, 2.0
"""A speed is looked at more closely where it changes by this share from one half segment to the next, and so many times the change make it too fast: in between it is faster by less."""
_PARTS = np.array([0.0, 0.25, 0.5, 0.75])
"""Where in a half segment it is looked at more closely."""
_NEARBY = 1.5
"""A place so many segments from a corner may belong to the motion beside."""


@frozen(eq=False)
class Excess:
    """Shares of what is allowed (N,) that are above 1, at times (N,) [s]."""

    times: Array
    shares: Array

    @staticmethod
    def of(times: Array, shares: Array) -> Excess:
        """Return those above 1."""
        over = shares > 1.0
        return Excess(times[over], shares[over])

    def and_of(self, other: Excess) -> Excess:
        """Return these and others."""
        return Excess(np.concatenate((self.times, other.times)), np.concatenate((self.shares, other.shares)))

    def between(self, begin: float, end: float) -> Excess:
        """Return those from one time up to another [s]."""
        own = (self.times >= begin) & (self.times <= end)
        return Excess(self.times[own], self.shares[own])


@frozen(eq=False)
class Trial:
    """What was found of control points: the knots at which motions end (k + 1,), half the width of the overlap at each corner (k - 1,), and what is too much."""

    ends: Numbers
    halves: Numbers
    limits: Excess
    way: Excess
    zones: Excess

    @property
    def is_good(self) -> bool:
        """Whether nothing is too much."""
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
    """Look at control points; None where a motion would have no segment.

    Args:
        way: of the chain.
        demands: its limits and corners.
        sampled: the control points.
        segment: the segment time [s].
        rounds: the corners that use their balls (k - 1,).
        own: the motions that count, of k.
        time: from when up to when it counts what is too much [s].
    """
    passed = sampled.begin + sampled.passing(way.begins[1:-1], segment)
    inner = np.round((passed - sampled.begin) / segment).astype(np.int64)
    ends = np.concatenate(([0], inner, [len(sampled.points) - 3]))
    if (np.diff(ends)[own] < 1).any():
        return None
    sharper = 1.0 + _SHARPER * demands.turn[demands.corners - 1]
    looked = _Look(way, demands.limits, sampled, segment, passed, rounds, ends, sharper)
    poses = looked.poses()
    halves, beside = looked.way_left(poses)
    excesses = (looked.limits_broken().and_of(looked.too_fast(poses)), beside, looked.zones_broken())
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
        """What differences of control points ask of the limits: they bound the derivatives."""
        points, h, limits = self.sampled.points, self.segment, self.limits
        times, shares = [], []
        for order, name in ((1, "velocity"), (1, "motor_velocity"), (2, "acceleration"), (3, "jerk")):
            change = np.diff(points, order, axis=0)
            if name == "motor_velocity":
                change = change @ limits.counts.T
            # in the middle of the points it is made of
            at = self.sampled.begin + h * (np.arange(len(change), dtype=np.float64) + 0.5 * order - 1.0)
            own = self._own(at)
            times.append(at)
            shares.append((np.abs(change) / getattr(limits, name)[own]).max(axis=1) / h**order)
        return Excess.of(np.concatenate(times), np.concatenate(shares))

    def zones_broken(self) -> Excess:
        """Where something is too fast in its zone."""
        if self.limits.zones is None:
            return Excess(np.zeros(0), np.zeros(0))
        segments, factors = self.limits.zones.too_fast(self.sampled.points, self.segment)
        return Excess(self.sampled.begin + self.segment * (segments + 0.5), factors)

    def _own(self, times: Array) -> Numbers:
        """The motions (N,) at times."""
        return np.searchsorted(self.passed, times, side="right")

    def poses(self) -> Array:
        """Where the frame is (N, 4, 4), two a segment: at knots and between."""
        points, way = self.sampled.points, self.way
        curve = np.empty((2 * len(points) - 5, points.shape[1]))
        curve[0::2], curve[1::2] = knot_values(points), middle_values(points)
        found: Array = tool_poses(way.paths[0].chain, curve, way.flange_from_moving)
        return found

    def too_fast(self, poses: Array) -> Excess:
        """Where the frame is faster than it is told, by poses (N, 4, 4) of `poses`: control points that are sharpened overshoot a little."""
        h, path, points = self.segment, self.way.paths[0], self.sampled.points
        speeds = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1) / (0.5 * h)
        at = 0.5 * h * np.arange(len(speeds), dtype=np.float64)
        # in a blend the faster one counts
        one, other = (self.limits.speed[self._own(self.sampled.begin + at + aside * h)] for aside in (-1, 2))
        allowed = _FASTER * np.maximum(one, other)
        # where it changes, it may be faster for a moment
        change = np.abs(np.diff(speeds, prepend=speeds[0], append=speeds[-1]))
        steepest = np.maximum(change[1:], change[:-1])
        (rows,) = np.nonzero((steepest > _STEEP * speeds) & (speeds + _BETWEEN * steepest > allowed))
        times = at[rows] + 0.5 * h * _PARTS[:, None]
        q, rate, _ = Curve(points, h, points[:, 0]).sample(times.ravel())
        closer = frame_speeds(path, q, rate).reshape(times.shape)
        speeds[rows] = np.maximum(speeds[rows], closer.max(axis=0))
        return Excess.of(self.sampled.begin + at + 0.25 * h, speeds / allowed)

    def way_left(self, poses: Array) -> tuple[Numbers, Excess]:
        """How far overlaps reach to either side of the corners, and where the paths are left beyond what is allowed, by poses (N, 4, 4) of `poses`."""
        way, limits, h = self.way, self.limits, self.segment
        at = np.arange(len(poses)) / 2.0
        times = self.sampled.begin + h * at
        gone = np.empty(len(poses))
        gone[0::2], gone[1::2] = knot_values(self.sampled.places), middle_values(self.sampled.places)
        off = self._off(poses, gone)
        corner, far = self._nearest(at)
        halves = np.zeros(len(self.passed), dtype=np.int64)
        if not len(halves):
            return halves, Excess.of(times, off)
        # at a ball the knots say where one motion ends
        rows = np.flatnonzero(self.rounds[corner] & (off > _LITTLE))
        off[rows] = self._off_by_knots(poses[rows], gone[rows], at[rows])
        rows = rows[off[rows] > 1.0]
        np.maximum.at(halves, corner[rows], np.floor(far[rows] + 1e-9).astype(np.int64) + 1)
        halves = np.where(self.rounds, np.maximum(halves, 1), 0)
        sizes = np.diff(self.ends)
        halves = np.minimum(halves, np.minimum(sizes[:-1], sizes[1:]) // 2)
        # where a blend ends both count
        in_ball, on_path = far <= halves[corner], far >= halves[corner]
        in_ball &= halves[corner] > 0
        centres = way.positions(np.arange(1, len(halves) + 1), np.zeros(len(halves)))
        radii = np.maximum(WITHIN * limits.radius, _NOTHING)
        away = np.linalg.norm(poses[:, :3, 3] - centres[corner], axis=1)
        share = np.where(in_ball, away / radii[corner], 0.0)
        share = np.where(on_path, np.maximum(share, off), share)
        # a blend may end as near to another corner
        (rounded,) = np.nonzero(halves)
        for knots in (self.ends[1:-1] - halves, self.ends[1:-1] + halves):
            rows = 2 * knots[rounded]
            away = np.linalg.norm(poses[rows, :3, 3] - centres[rounded], axis=1)
            share[rows] = np.maximum(share[rows], away / radii[rounded])
        missed = np.where(self.rounds & (halves > 0), 0.0, self._missed())
        return halves, Excess.of(np.concatenate((times, self.passed)), np.concatenate((share, missed)))

    def _nearest(self, at: Array) -> tuple[Numbers, Array]:
        """The corner (N,) that is nearest to knots `at` (N,), and how many segments it is away."""
        own = np.clip(np.searchsorted(self.ends, at, side="right") - 1, 0, len(self.ends) - 2)
        before = at - self.ends[own] <= self.ends[own + 1] - at
        corner = np.clip(np.where(before, own - 1, own), 0, max(len(self.passed) - 1, 0))
        return corner, np.abs(at - self.ends[corner + 1])

    def _off(self, poses: Array, gone: Array) -> Array:
        """How far poses (N, 4, 4) at places `gone` (N,), two a segment, are from the path of their motion, or, next to a corner, of that beside: shares (N,) of the tolerance."""
        way = self.way
        own, share = way.located(gone)
        off = self._beside(poses, own, share)
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
        """How far poses (N, 4, 4) at knots `at` (N,) are from the path of the motion that the knots belong to; between two, from the farther one."""
        off, count = np.zeros(len(at)), len(self.way.paths)
        for side in ("left", "right"):
            own = np.clip(np.searchsorted(self.ends, at, side=side) - 1, 0, count - 1)
            begin = self.way.begins[own]
            share = np.clip((gone - begin) / (self.way.begins[own + 1] - begin), 0.0, 1.0)
            off = np.maximum(off, self._beside(poses, own, share))
        return off

    def _beside(self, poses: Array, own: Numbers, share: Array) -> Array:
        """How far poses (N, 4, 4) are from the paths of motions `own` (N,), as shares of the tolerance; `share` (N,) is about where."""
        way, p = self.way, poses[:, :3, 3]
        # on a line the first step gets there
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
        """Return where motions `own` (N,) go at shares (N,) of their ways, as velocities (N, 3) [m] over the share."""
        if self.way.is_straight:
            return self.way.shift[own]
        middle, way = np.clip(share, _AHEAD, 1.0 - _AHEAD), self.way
        ahead: Array = (way.positions(own, middle + _AHEAD) - way.positions(own, middle - _AHEAD)) / (
            2.0 * _AHEAD
        )
        return ahead

    def _missed(self) -> Array:
        """How far corners are missed, as shares (k - 1,) of the tolerance; early or late doesn't count."""
        way, h, limits = self.way, self.segment, self.limits
        points, count = self.sampled.points, len(self.passed)
        q, rate, _ = Curve(points, h, points[:, 0]).sample(self.passed - self.sampled.begin)
        poses, jacobians = poses_and_jacobians(way.paths[0].chain, q, way.flange_from_moving)
        p, turns = way.poses(np.arange(1, count + 1), np.zeros(count))
        twist = np.einsum("nij,nj->ni", jacobians, rate)
        velocity, spin = twist[:, :3], twist[:, 3:]
        miss = p - poses[:, :3, 3]
        square = np.maximum(np.einsum("ni,ni->n", velocity, velocity), _NOTHING)
        late = np.clip(np.einsum("ni,ni->n", miss, velocity) / square, -h, h)[:, None]
        turned = poses[:, :3, :3] + late[:, :, None] * np.cross(spin[:, :, None], poses[:, :3, :3], axis=1)
        distance = np.linalg.norm(miss - late * velocity, axis=1)
        turned_by = angle_between(matrices(turns), turned) / np.minimum(limits.angle[1:], limits.angle[:-1])
        # where the direction changes as well, another instant is the nearest for the turn
        turned_by *= self.sharper**_FOR_TURNS
        found: Array = self.sharper * np.maximum(
            distance / np.minimum(limits.position[1:], limits.position[:-1]), turned_by
        )
        return found
