"""Compute the speeds and accelerations that a motion profile may have along a path. They are limited by the
joints, by requested speeds and at corners.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.flowing.turns import angle_between, matrices
from yarclang.motion.chains.flowing.way import Marks, Numbers, Way
from yarclang.motion.chains.links import Link
from yarclang.motion.zones import BELOW_CEILING, SlowZones
from yarclang.robot.kinematics.inverse import follow

_AT_ONCE = 2048
"""Number of poses that are computed together. If all poses of a long chain were computed at once, the
intermediate arrays would be larger than the result.
"""
_FEWEST = 3
_LONGEST = 4e-3
"""Least number of steps of the motion profile on each motion, and greatest length of a step [m]."""
_CLOSE, _CLOSER = 1e-3, (0.0625, 0.0625, 0.125, 0.25, 0.5)
"""Steps longer than `_CLOSE` [m] next to a corner at which the requested speed changes are divided into the
shares `_CLOSER`.

The nodes must be close to each other there, since the square of the speed is linear between nodes.
"""

_AT_LEAST = 1.02
"""Least duration of each motion [segments]."""
_BESIDE = 1e-3
"""Share of a motion's path, at either end, over which difference quotients are computed."""
_NOTHING = 1e-12
WITHIN = 0.97
"""Share of the radius of a corner's ball that the planner uses."""
SHARE_OF_TOLERANCE = 0.8
"""Share of the tolerance that the planner uses. The rest is a reserve for the proof, which is made later."""
_CUT = 0.4
"""Factor in the distance by which a corner is rounded. The distance is the product of this factor, the
standard deviation of the moving averages in time, and the change of velocity.
"""
_FOR_CORNER = 0.6
"""Factor that reduces the speed at a corner at which the motion profile changes from slowing down to speeding
up. The change of direction then needs only a part of the limits. The rest is for the change of acceleration.
"""
_NEARLY = 0.9
"""Share of the requested speeds below which a corner counts as slow: the motion profile slows down before it
and speeds up after it.
"""
_LOSS = 0.5
"""Factor in a second distance by which a corner is rounded, due to the acceleration along the path. The
distance is the product of this factor, half the acceleration, and the variance of the moving averages in
time.
"""
_REACH = 0.35
"""Share of the total duration of both moving averages. If a curve is rounded within a ball, it is off its
path for about this share of the duration before the corner, and for as long after it.
"""


@frozen(eq=False)
class Smoothing:
    """Parameters of the smoothing of poses in time.

    Poses are sampled every `segment` [s]. Two moving averages over `widths` segments, one after the other,
    smooth them.
    """

    segment: float
    widths: tuple[int, int]

    @property
    def times(self) -> tuple[float, float]:
        """The durations of the two moving averages [s], the longer one first; none is shorter than a
        segment.
        """
        long, short = sorted((max(width, 1) * self.segment for width in self.widths), reverse=True)
        return long, short

    @property
    def deviation(self) -> float:
        """The standard deviation of both moving averages together [s]."""
        # A uniform mean over a width w has the variance w^2 / 12, and variances of successive means add up.
        return float(np.sqrt(sum(width**2 for width in self.widths) / 12.0)) * self.segment

    @property
    def reach(self) -> int:
        """The approximate number of segments before and after an instant whose poses affect the smoothed pose
        at this instant.
        """
        return (sum(self.widths) + 5) // 2

    @property
    def around(self) -> int:
        """The number of segments on either side of a seam that both neighbouring windows examine.

        Everything that depends on the seam is within these segments.
        """
        return 2 * (self.reach + 2)

    @property
    def kept(self) -> int:
        """The number of segments on either side of a seam in which the speed doesn't change.

        Each window can therefore compute everything that it examines beyond the seam without its neighbour's
        result.
        """
        return self.around + self.reach


@frozen(eq=False)
class Limits:
    """The limits of the k motions of a chain.

    The limits of joints and motors are (k, n). `counts` (n, n) converts joint positions [rad or m] into motor
    counts. `speed` (k,) [m/s] are the requested speeds, infinite if none is requested. `position` (k,) [m]
    and `angle` (k,) [rad] are tolerances. `radius` (k - 1,) [m] are the radii of the balls around the
    corners, 0 if the path must be kept at the corner. `zones` are the slow zones of all motions.
    """

    velocity: Array
    acceleration: Array
    jerk: Array
    motor_velocity: Array
    counts: Array
    speed: Array
    position: Array
    angle: Array
    radius: Array
    zones: SlowZones | None

    @staticmethod
    def of(links: Sequence[Link], way: Way) -> Limits:
        """Return the limits of a chain."""
        bounds = [link.own_bounds for link in links]
        full = np.array([np.inf if link.full is None else link.full for link in links])
        zones = None
        ceilings = np.array([np.inf if one.zones is None else one.zones.ceiling for one in bounds])
        # Combine the slow zones of all motions. The speed limit that a motion's command sets isn't a zone: it
        # limits only the speed of this motion.
        for one in dict.fromkeys(bound.zones for bound in bounds):
            own = None if one is None else one.without_ceiling()
            zones = own if zones is None else zones.together(own)
        return Limits(
            np.array([one.velocity for one in bounds]),
            np.array([one.acceleration for one in bounds]),
            np.array([one.jerk for one in bounds]),
            np.array([one.motor_velocity for one in bounds]),
            bounds[0].counts,
            np.minimum(np.where(np.isfinite(full), way.lengths / full, np.inf), BELOW_CEILING * ceilings),
            np.array([SHARE_OF_TOLERANCE * link.tolerance.position for link in links]),
            np.array([SHARE_OF_TOLERANCE * link.tolerance.angle for link in links]),
            np.array([link.corner.radius if link.corner is not None else 0.0 for link in links[:-1]]),
            zones,
        )

    def part(self, first: int, last: int) -> Limits:
        """Return the limits of the motions from `first` up to but not including `last`."""
        own = slice(first, last)
        return Limits(
            self.velocity[own], self.acceleration[own], self.jerk[own], self.motor_velocity[own], self.counts,
            self.speed[own], self.position[own], self.angle[own], self.radius[first : last - 1], self.zones,
        )  # fmt: skip


@frozen(eq=False)
class Demands:
    """The speeds, accelerations and jerks that a path allows a motion profile, at N nodes and between them.

    `s` (N,) [m] are the places of the nodes; `corners` (k - 1,) are the indices of the nodes at corners.
    `own` (N - 1,) is the index of the motion after each node, `step` (N - 1,) [m] the distance to the next
    node.

    Between nodes, joints and motors allow the speeds `fastest` (N - 1,) [m/s]. Joints allow the accelerations
    `push` [m/s^2] and the jerks `jolt` [m/s^3] along the path. At inner nodes, where the joints' derivatives
    with respect to the path change, `bent` (N - 2,) [m/s] is the largest speed.

    At a corner these derivatives jump. Moving averages over the times T and t [s] turn this jump into
    accelerations, which allow the speed `kinks[:, 0]` T [m/s], and into jerks, which allow `kinks[:, 1]` T t;
    `kinks` is (k - 1, 2) [m/s^2 and m/s^3]. `turn` (N - 2,) is the jump of the frame's direction, and `spin`
    (N - 2,) [rad/m] the jump of its rotation per distance.
    """

    limits: Limits
    s: Array
    step: Array
    own: Numbers
    corners: Numbers
    fastest: Array
    push: Array
    jolt: Array
    bent: Array
    kinks: Array
    turn: Array
    spin: Array

    @staticmethod
    def of(way: Way, limits: Limits) -> Demands:
        """Compute the speeds, accelerations and jerks that a path allows a motion profile."""
        lengths = way.lengths
        number = np.maximum(_FEWEST, np.ceil(lengths / _LONGEST)).astype(np.int64)
        first, units = _nodes_of(number, *_closer(lengths / number, limits))
        own = np.repeat(np.arange(len(lengths)), np.diff(first))
        # Steps are sums of powers of two, which can be added without rounding errors.
        gone = np.concatenate(([0.0], np.cumsum(units)))
        inner = (gone[:-1] - gone[first[own]]) / number[own]
        # Compute each step from its own motion only, so that the results don't depend on the motion's place
        # in the chain.
        step = lengths[own] / number[own] * units
        p, q = _looked_at(way, np.append(own, len(lengths) - 1), np.append(inner, 1.0))
        slope, ahead = np.diff(q, axis=0) / step[:, None], np.diff(p, axis=0) / step[:, None]
        # The joints' slopes q' are constant between nodes and jump at nodes. A jump divided by the mean
        # length of the steps on both sides is the bend q''. At the speed v, it needs the acceleration q''
        # v^2.
        jump = np.abs(np.diff(slope, axis=0))
        turn, spin = np.linalg.norm(np.diff(ahead, axis=0), axis=1), np.zeros(len(step) - 1)
        bend = np.maximum(jump / (0.5 * (step[1:] + step[:-1]))[:, None], _NOTHING)
        acceleration = np.minimum(limits.acceleration[own[1:]], limits.acceleration[own[:-1]])
        bent = np.sqrt((acceleration / bend).min(axis=1))
        corners = first[1:-1]
        at, kinks = corners - 1, np.zeros((len(corners), 2))
        for begin in range(0, len(at), _AT_ONCE):
            rows = at[begin : begin + _AT_ONCE]
            # The derivatives jump at corners: measure them close to the corner on either side, not between
            # nodes.
            jump_there, turn[rows], spin[rows] = _jumps(way, begin, begin + len(rows))
            jump_there = np.maximum(jump_there, _NOTHING)
            jerk = np.minimum(limits.jerk[own[rows + 1]], limits.jerk[own[rows]])
            kinks[begin : begin + len(rows), 0] = (acceleration[rows] / jump_there).min(axis=1)
            kinks[begin : begin + len(rows), 1] = (jerk / jump_there).min(axis=1)
        return Demands(
            limits, _places(step), step, own, corners, *_between(limits, own, slope), bent, kinks, turn, spin
        )

    def part(self, first: int, last: int) -> Demands:
        """Return the part of these demands for the motions from `first` up to but not including `last`."""
        edges = np.concatenate(([0], self.corners, [len(self.step)]))
        begin, end = int(edges[first]), int(edges[last])
        between, inner = slice(begin, end), slice(begin, end - 1)
        return Demands(
            self.limits.part(first, last), _places(self.step[between]), self.step[between],
                self.own[between] - first,
            edges[first + 1 : last] - begin, self.fastest[between], self.push[between], self.jolt[between],
                self.bent[inner],
            self.kinks[first : last - 1], self.turn[inner], self.spin[inner],
        )  # fmt: skip

    def room(self) -> Array:
        """Return, for each inner node, the length of path over which the path may be rounded off, (N - 2,)
        [m].

        The stricter tolerance of the two motions beside the node applies.
        """
        limits, own = self.limits, self.own
        position = np.minimum(limits.position[own[1:]], limits.position[own[:-1]])
        angle = np.minimum(limits.angle[own[1:]], limits.angle[own[:-1]])
        found: Array = np.minimum(
            position / np.maximum(self.turn, _NOTHING), angle / np.maximum(self.spin, _NOTHING)
        )
        return found

    def ceilings(self, smoothing: Smoothing) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Compute the largest speeds and accelerations that a motion profile may have.

        Returns:
            The largest speeds at the nodes (N,) [m/s], the largest accelerations between them (N - 1,)
            [m/s^2], and a mask of the corners that are rounded within their balls, not within the tolerance
            (k - 1,).
        """
        limits, own, corners = self.limits, self.own, self.corners - 1
        # Each motion must last longer than a segment.
        lengths = np.add.reduceat(self.step, np.concatenate(([0], self.corners)))
        between = np.minimum(
            self.fastest, np.minimum(limits.speed, lengths / (_AT_LEAST * smoothing.segment))[own]
        )
        long, short = smoothing.times
        slope = np.minimum(self.push, 0.5 * long * self.jolt)
        # A mean in time moves a bend inwards: by half of the variance of the mean, times the acceleration at
        # the bend. The curvature is the change of direction divided by the mean length of the steps on both
        # sides.
        curvature = self.turn / (0.5 * (self.step[1:] + self.step[:-1]))
        pulled = 2.0 * limits.position[own[1:]] / smoothing.deviation**2
        inner = np.minimum(self.bent, np.sqrt(pulled / np.maximum(curvature, _NOTHING)))
        # A mean in time turns a jump of velocity into an acceleration. The second mean turns the jump of this
        # acceleration into a jerk.
        limited = np.minimum(self.kinks[:, 0] * long, self.kinks[:, 1] * long * short)
        # A corner can be rounded within the tolerance of the path. A corner with a ball can instead be
        # rounded within the ball. Compute the speed for both.
        steepest = 0.9 * np.maximum(slope[corners], slope[corners + 1])
        s = smoothing.deviation
        on_path, gentle_path = _slow_enough(self.room()[corners], _CUT * s, 0.5 * _LOSS * s**2, steepest)
        time = _REACH * (sum(smoothing.widths) + 2) * smoothing.segment
        in_ball, gentle_ball = _slow_enough(WITHIN * limits.radius, time, 0.5 * time**2, steepest)
        rounds = (in_ball > on_path) & (on_path < np.minimum(limits.speed[1:], limited))
        # If the motion profile changes at a corner from slowing down to speeding up, its acceleration jumps
        # from negative to positive. The acceleration due to the change of direction is added to this.
        slows = limited < _NEARLY * np.minimum(limits.speed[1:], limits.speed[:-1])
        passed = np.minimum(
            np.where(slows, _FOR_CORNER * limited, limited), np.where(rounds, in_ball, on_path)
        )
        inner[corners] = passed
        slope = 0.9 * slope
        gentle = np.where(rounds, gentle_ball, gentle_path)
        left = 1.0 - passed / limited
        for beside in (corners, corners + 1):
            turned = 0.5 * left * long * self.jolt[beside]
            slope[beside] = np.minimum(slope[beside], np.minimum(gentle, turned))
        # A node must keep the limits of the steps before and after it.
        nodes = np.concatenate((between[:1], np.minimum(between[1:], between[:-1]), between[-1:]))
        nodes[1:-1] = np.minimum(nodes[1:-1], inner)
        self._beside_slower(nodes, smoothing)
        return nodes, slope, rounds

    def _beside_slower(self, nodes: Array, smoothing: Smoothing) -> None:
        """Lower the largest speeds at nodes (N,) near a slower motion, so that no moving average on the
        slower motion includes a higher speed.
        """
        speed, s = self.limits.speed, self.s
        for place in np.flatnonzero(~np.isclose(speed[1:], speed[:-1], 1e-9, 0.0)).tolist():
            slow, corner = float(speed[place : place + 2].min()), int(self.corners[place])
            # Length of path that the moving averages cover at the slower speed.
            far = (smoothing.reach + 1) * smoothing.segment * slow
            if speed[place] > slow:
                beside = slice(max(int(np.searchsorted(s, s[corner] - far)) - 1, 0), corner)
            else:
                beside = slice(corner, int(np.searchsorted(s, s[corner] + far, side="right")) + 1)
            nodes[beside] = np.minimum(nodes[beside], slow)


def _slow_enough(room: Array, time: float, square: float, acceleration: Array) -> tuple[Array, Array]:
    """Return the largest speeds at corners (K,) [m/s], and the largest accelerations beside them (K,)
    [m/s^2].

    Within the duration of a moving average, the motion covers a distance: the speed times `time`, plus the
    acceleration times `square`. This distance must not exceed `room`, and the acceleration gets at most half
    of it.

    Args:
        room: the largest allowed distance from the corner (K,) [m].
        time: factor of the speed in this distance [s].
        square: factor of the acceleration in this distance [s^2].
        acceleration: (K,) the largest acceleration [m/s^2].
    """
    # The distance is time * v + square * a. The acceleration a gets at most half of the room, the speed v the
    # rest.
    gentle = np.minimum(acceleration, 0.5 * room / square)
    return (room - square * gentle) / time, gentle


def _closer(step: Array, limits: Limits) -> tuple[Marks, Marks]:
    """Return two masks (k,): the motions with closer nodes at their beginning, and the motions with closer
    nodes at their end.

    Nodes are closer to each other at corners where the requested speed changes and the path must be kept. If
    the first or the last corner is of this kind, nodes are also closer at that end of the chain.

    Args:
        step: (k,) distance between nodes on each motion [m].
        limits: the limits of the k motions.
    """
    changes = (limits.radius == 0.0) & ~np.isclose(limits.speed[1:], limits.speed[:-1], 1e-9, 0.0)
    changes &= np.isfinite(limits.speed[1:]) & np.isfinite(limits.speed[:-1])
    changes &= np.minimum(step[1:], step[:-1]) > _CLOSE
    if not len(changes):
        return np.zeros(1, np.bool_), np.zeros(1, np.bool_)
    return np.append(changes[:1], changes), np.append(changes, changes[-1:])


def _nodes_of(number: Numbers, begins: Marks, ends: Marks) -> tuple[Numbers, Array]:
    """Divide the paths of motions into steps between nodes.

    Each motion has `number` (k,) steps of length 1. If `begins` or `ends` is True for a motion, its first or
    last step is divided into shorter ones.

    Returns:
        The first node of each motion and the last node of all (k + 1,), and the steps between nodes (N - 1,).
    """
    extra = len(_CLOSER) - 1
    first = np.concatenate(([0], np.cumsum(number + extra * begins.astype(np.int64) + extra * ends)))
    units = np.ones(first[-1])
    units[first[:-1][begins][:, None] + np.arange(extra + 1)] = _CLOSER
    units[first[1:][ends][:, None] - 1 - np.arange(extra + 1)] = _CLOSER
    return first, units


def _places(step: Array) -> Array:
    """Return the distances of nodes from the first one (N,) [m], given the steps between them (N - 1,)."""
    return np.concatenate(([0.0], np.cumsum(step)))


def _between(limits: Limits, own: Numbers, slope: Array) -> tuple[Array, Array, Array]:
    """Return the largest speeds [m/s], accelerations [m/s^2] and jerks [m/s^3] along the path that joints and
    motors allow, (M,) each.

    Args:
        limits: the limits of all motions.
        own: (M,) the motion that each row of `slope` belongs to.
        slope: (M, n) derivatives of the joint positions with respect to the path [rad/m or 1].
    """
    parts = []
    for begin in range(0, len(own), _AT_ONCE):
        rows = slice(begin, begin + _AT_ONCE)
        # Between nodes the slope is constant, so that q' = slope v, q'' = slope a and q''' = slope j.
        motion, size = own[rows], np.maximum(np.abs(slope[rows]), _NOTHING)
        motors = np.maximum(np.abs(slope[rows] @ limits.counts.T), _NOTHING)
        fastest = np.minimum(
            (limits.velocity[motion] / size).min(axis=1), (limits.motor_velocity[motion] / motors).min(axis=1)
        )
        push, jolt = (
            (limits.acceleration[motion] / size).min(axis=1),
            (limits.jerk[motion] / size).min(axis=1),
        )
        parts.append(np.stack((fastest, push, jolt)))
    fastest, push, jolt = np.concatenate(parts, axis=1)
    return fastest, push, jolt


def _looked_at(way: Way, own: Numbers, share: Array) -> tuple[Array, Array]:
    """Return frame positions (N, 3) [m] and joint positions (N, n).

    `own` (N,) are indices of motions, and `share` (N,) the completed shares of their paths.
    """
    p, q = np.empty((len(own), 3)), np.empty((len(own), way.ends.shape[1]))
    for begin in range(0, len(own), _AT_ONCE):
        rows = slice(begin, begin + _AT_ONCE)
        p[rows], _, q[rows] = _poses_and_joints(way, own[rows], share[rows])
    return p, q


def _poses_and_joints(way: Way, own: Numbers, share: Array) -> tuple[Array, Array, Array]:
    """Return frame positions (N, 3) [m], rotations (N, 3, 3) and joint positions (N, n); inverse kinematics
    is solved for all at once.
    """
    p, turns = way.poses(own, share)
    rotations = matrices(turns)
    return p, rotations, joints(way, p, rotations, way.seeds(own, share), way.paths[0])[0]


def _jumps(way: Way, first: int, last: int) -> tuple[Array, Array, Array]:
    """Return the sizes of three jumps at corners: of the joints' derivatives with respect to the path (K, n),
    of the frame's direction (K,), and of its rotation per distance (K,) [rad/m].

    Args:
        way: the paths of all motions.
        first: the first corner; a corner has the number of the motion before it.
        last: the corner after the last one.
    """
    before, behind = np.arange(first, last), np.arange(first + 1, last + 1)
    own = np.stack((before, before, behind, behind), axis=1).ravel()
    share = np.tile([1.0 - _BESIDE, 1.0, 0.0, _BESIDE], last - first)
    p, turns, q = _poses_and_joints(way, own, share)
    # Difference quotients on either side of the corner, over a short part of both paths.
    step = (_BESIDE * way.lengths[own[::2]])[:, None]
    slope, ahead = (q[1::2] - q[::2]) / step, (p[1::2] - p[::2]) / step
    turned = _rates(turns[::2], turns[1::2], step)
    jumps = [one[1::2] - one[::2] for one in (slope, ahead, turned)]
    return np.abs(jumps[0]), np.linalg.norm(jumps[1], axis=1), np.linalg.norm(jumps[2], axis=1)


def joints(way: Way, p: Array, rotations: Array, seeds: Array, path: CartesianPath) -> tuple[Array, Array]:
    """Return joint positions (N, n) at which the moving frame has given poses, and the remaining errors (N,):
    the sum of those in position [m] and in angle [rad].
    """
    poses = np.zeros((len(p), 4, 4))
    poses[:, :3, :3], poses[:, :3, 3], poses[:, 3, 3] = rotations, p, 1.0
    q, position, angle = follow(path.chain, poses @ np.linalg.inv(way.flange_from_moving), seeds)
    return q, position + angle


def _rates(rotations: Array, others: Array, steps: Array) -> Array:
    """Return the rotation per distance (N, 3) in {B} from `rotations` (N, 3, 3) to `others`. `steps` (N, 1)
    are the distances along the path.
    """
    turn = others @ rotations.transpose(0, 2, 1)
    vector = (turn - turn.transpose(0, 2, 1))[:, (2, 0, 1), (1, 2, 0)] / 2.0
    size = np.linalg.norm(vector, axis=1)
    angle = angle_between(others, rotations)
    # `vector` is the axis times the sine of the angle: scale it to the axis times the angle.
    scale = np.where(size > _NOTHING, angle / np.maximum(size, _NOTHING), 1.0)
    found: Array = vector * scale[:, None] / steps
    return found
