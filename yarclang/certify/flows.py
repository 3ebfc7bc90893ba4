"""Which motions flow into each other, and which of their segments follow their own path."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.certify import tangent
from yarclang.certify.ball import radii
from yarclang.certify.bounds import Cubics
from yarclang.certify.corner import Judged, Starts
from yarclang.certify.joint import joint_weights
from yarclang.certify.layout import Layout, Place
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Robot

SHORTEST = 1e-6
"""Between two corners that may not be left lies at least this [s]."""

IN_JOINTS = (hir.JointMove, hir.AvoidMove, hir.SplineMove)


@frozen
class Corner:
    """Motion number `first` flows into motion number `second`, over `segments` segments.

    `rounded` says that a ball is allowed; without one, both paths are followed up to the corner. Between two motions in joint
    space each joint has its own ball, else the moving frame.
    """

    first: int
    second: int
    segments: int
    rounded: bool
    joints: bool


@frozen(eq=False)
class Flows:
    """Of each of P motions: the segments `follow` (P, 2), from and up to, that go along its path, and whether the path is joined and
    left elsewhere than at its ends, `free` (P, 2). The corners, in order. `whole` (P, 2) are all segments to look at: those of the
    motion, or, where it may not leave its corners, from when it passes the one, `since` [s] after the start of its first, up to when it
    passes the other, `until` after that of its last; NaN where these aren't cut.
    """

    follow: NDArray[np.int64]
    free: NDArray[np.bool_]
    corners: tuple[Corner, ...]
    whole: NDArray[np.int64]
    since: Array
    until: Array

    def is_cut(self, row: int) -> bool:
        """Whether a motion passes a corner that it may not leave."""
        return bool(np.isfinite(self.since[row]) or np.isfinite(self.until[row]))

    def cubics(self, layout: Layout, row: int) -> Cubics:
        """The segments that go along the path of a motion, or, where it is cut, up to its corners."""
        begin, stop = (int(x) for x in self.follow[row])
        return self.cut(layout.cubics(begin, stop), row, 0, stop - begin - 1)

    def cut(self, cubics: Cubics, row: int, first: int, last: int) -> Cubics:
        """The same segments, of which those in the rows `first` and `last` are the first and the last of a motion."""
        since, until = self.since[row], self.until[row]
        begin = float(since) if np.isfinite(since) else 0.0
        if np.isfinite(until):
            cubics = cubics.trimmed(last, begin if first == last else 0.0, float(until))
            if first == last:
                return cubics
        if np.isfinite(since):
            cubics = cubics.trimmed(first, begin, float(cubics.h[first]))
        return cubics


def find_flows(judged: Judged, layout: Layout, starts: Starts) -> Flows:
    """Where the motions of a text flow into each other."""
    count = len(layout.places)
    follow = np.array([[place.first, place.last] for place in layout.places], dtype=np.int64).reshape(
        count, 2
    )
    free = np.zeros((count, 2), dtype=np.bool_)
    since, until = np.full(count, np.nan), np.full(count, np.nan)
    corners = []
    before = 0
    for row, place in enumerate(layout.places):
        if not place.size:
            continue
        if place.before is not None:
            corner = _corner(layout, judged.robot, before, row, place.before)
            corners.append(corner)
            if corner.rounded:
                follow[before, 1] -= corner.segments // 2
                follow[row, 0] += corner.segments // 2
                free[before, 1] = free[row, 0] = True
            else:
                segment, time = _passed(judged, layout, starts, corner, int(follow[before, 0]))
                if segment == follow[before, 0] and np.isfinite(since[before]):
                    time = max(time, float(since[before]) + SHORTEST)
                follow[before, 1], follow[row, 0] = segment + 1, segment
                until[before] = since[row] = time
        before = row
    whole = np.array([[place.first, place.last] for place in layout.places], dtype=np.int64).reshape(count, 2)
    whole[:, 0] = np.where(np.isfinite(since), follow[:, 0], whole[:, 0])
    whole[:, 1] = np.where(np.isfinite(until), follow[:, 1], whole[:, 1])
    return Flows(follow, free, tuple(corners), whole, since, until)


def _passed(
    judged: Judged, layout: Layout, starts: Starts, corner: Corner, earliest: int
) -> tuple[int, float]:
    """When a corner that may not be left is passed: the segment, from `earliest` on, and how long after its start [s]."""
    go_on()
    one, other = layout.places[corner.first], layout.places[corner.second]
    reach = corner.segments // 2 + 1
    # nothing of what belongs to the other ends of both motions
    begin = max(one.last - reach, earliest)
    stop = max(min(other.first + reach, other.last - (other.behind or 0) // 2), begin + 1)
    robot, tolerance = judged.robot, judged.tolerance
    flange, q = starts.flange[corner.second], starts.q[corner.second]
    frame = None if corner.joints else frame_of(one.motion, other.motion)
    if frame is None:
        target = tangent.Corner(q, joint_weights(robot, tolerance))
    else:
        weights = np.array([1.0 / tolerance.position, 1.0 / tolerance.angle])
        target = tangent.Corner(q, weights, frame, flange @ frame)
    segment, time = tangent.passing(layout.cubics(begin, stop), target, robot.chain)
    return begin + segment, time


def frame_of(*motions: hir.Motion) -> Array | None:
    """Where the moving frame sits on the flange: that of the first of some motions that is Cartesian."""
    for motion in motions:
        if isinstance(motion, hir.PoseSplineMove):
            return motion.waypoints[0].flange_from_moving
        if isinstance(motion, hir.LineMove | hir.ArcMove):
            return motion.goal.flange_from_moving
    return None


def _corner(layout: Layout, robot: Robot, first: int, second: int, segments: int) -> Corner:
    one, other = layout.places[first].motion, layout.places[second].motion
    joints = isinstance(one, IN_JOINTS) and isinstance(other, IN_JOINTS)
    blend = one.blend
    assert blend is not None  # as the map and the program agree
    size = float(radii(blend, robot).max()) if joints else blend.length or 0.0
    return Corner(first, second, segments, segments > 0 and size > 0.0, joints)


def cruise(judged: Judged, place: Place) -> tuple[float, float]:
    """Return the speeds to which a motion is held, [m/s] and [rad/s]; NaN if it has none."""
    speed = place.motion.timing.speed
    if speed is None or isinstance(place.motion, IN_JOINTS):
        return np.nan, np.nan
    share = judged.share_of(place.step)
    return (
        np.nan if speed.length is None else speed.length * share,
        np.nan if speed.angle is None else speed.angle * share,
    )


def speeds_around(judged: Judged, layout: Layout, flows: Flows) -> Array:
    """Return the most that is allowed in the blends before and after each motion, (P, 2) [m/s]: the larger speed of both."""
    own = np.array([cruise(judged, place)[0] for place in layout.places])
    around = np.full((len(own), 2), np.inf)
    for corner in flows.corners:
        both = own[[corner.first, corner.second]]
        if not np.isnan(both).any():
            around[corner.first, 1] = around[corner.second, 0] = both.max()
    return around
