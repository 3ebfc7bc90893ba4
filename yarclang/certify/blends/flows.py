"""Find the motions that flow into each other, and the segments that follow each motion's own path."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.certify.blends import tangent
from yarclang.certify.blends.ball import radii
from yarclang.certify.blends.starts import Starts
from yarclang.certify.judged import Judged
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.joint import joint_weights
from yarclang.certify.read.layout import Layout
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Robot

SHORTEST = 1e-6
"""Least time between passing one corner without a blend radius and passing the next [s]."""

_TOGETHER = 4096
"""Number of corners whose passing times are computed in one step."""

IN_JOINTS = (hir.JointMove, hir.AvoidMove, hir.SplineMove, hir.TimedMove)
"""Motions in joint space."""


@frozen
class Corner:
    """A corner at which one motion flows into another.

    Attributes:
        first: row of the first motion in the layout.
        second: row of the second motion in the layout.
        segments: number of segments of the blend.
        rounded: True if the corner may be rounded within a ball. Otherwise both paths are followed up to the
            corner.
        joints: True between two motions in joint space, where each joint has an allowed distance of its own.
            Otherwise the moving frame must stay in a ball.
    """

    first: int
    second: int
    segments: int
    rounded: bool
    joints: bool


@frozen(eq=False)
class Flows:
    """Segments and corners of P motions.

    At a corner without a blend radius, both motions are cut: their common segment is divided at the instant
    at which the robot passes the corner.

    Attributes:
        follow: (P, 2) range of the segments that follow the motion's path.
        free: (P, 2) True in the first column if a blend joins the path after its start, and in the second
            column if a blend leaves it before its end.
        corners: the corners, in order.
        whole: (P, 2) range of the segments of the motion, including its blends, but without segments beyond
            its cuts.
        since: (P,) time of the cut at the motion's start, from the start of the cut segment [s]; NaN without
            one.
        until: (P,) time of the cut at the motion's end, from the start of the cut segment [s]; NaN without
            one.
    """

    follow: NDArray[np.int64]
    free: NDArray[np.bool_]
    corners: tuple[Corner, ...]
    whole: NDArray[np.int64]
    since: Array
    until: Array

    def is_cut(self, row: int) -> bool:
        """Return True if a motion begins or ends inside a segment: at a corner without a ball (BLEND 0), the
        path changes to the next one at some time within a segment.
        """
        return bool(np.isfinite(self.since[row]) or np.isfinite(self.until[row]))

    def cubics(self, layout: Layout, row: int) -> Cubics:
        """Return the segments that follow the path of a motion, up to its cuts."""
        begin, stop = (int(x) for x in self.follow[row])
        return self.cut(layout.cubics(begin, stop), np.array([row]), np.array([0]), np.array([stop - begin]))

    def cut(
        self, cubics: Cubics, rows: NDArray[np.int64], begins: NDArray[np.int64], stops: NDArray[np.int64]
    ) -> Cubics:
        """Return segments without the parts that lie beyond the cuts of their motions.

        Args:
            cubics: all segments.
            rows: (K,) the motions' rows in the layout.
            begins: (K,) index in `cubics` of each motion's first segment.
            stops: (K,) index in `cubics` after each motion's last segment.
        """
        starts, ends = np.zeros(len(cubics.h)), cubics.h.copy()
        since, until = np.isfinite(self.since[rows]), np.isfinite(self.until[rows])
        starts[begins[since]] = self.since[rows[since]]
        ends[stops[until] - 1] = self.until[rows[until]]
        (cut,) = np.nonzero((starts > 0.0) | (ends < cubics.h))
        return cubics.trimmed(cut, starts[cut], ends[cut]) if len(cut) else cubics


def covered_by_balls(free: NDArray[np.bool_]) -> Array:
    """Return the fraction (...) at which each path is divided between the balls around the corners at its two
    ends. This is needed if blends cover a whole path.

    The ball at the start must contain the path up to this fraction, and the ball at the end must contain the
    rest. A path that is cut at its start has a ball at its end only, so the fraction is 0; for a path that is
    cut at its end, it is 1.

    Args:
        free: (..., 2) True in the first column if a blend joins the path after its start, and in the second
            column if a blend leaves it before its end.
    """
    shares: Array = np.where(free[..., 0], np.where(free[..., 1], 0.5, 1.0), 0.0)
    return shares


def find_flows(judged: Judged, layout: Layout, starts: Starts) -> Flows:
    """Find where the motions of a controller text flow into each other.

    Args:
        judged: the context of the judgement.
        layout: the commands of the controller text.
        starts: the start points of the programmed paths.
    """
    count = len(layout.places)
    follow = np.array([[place.first, place.last] for place in layout.places], dtype=np.int64).reshape(
        count, 2
    )
    free = np.zeros((count, 2), dtype=np.bool_)
    since, until = np.full(count, np.nan), np.full(count, np.nan)
    corners = corners_of(layout, judged.robot)
    passed = dict(_passed(judged, layout, starts, [corner for corner in corners if not corner.rounded]))
    for corner in corners:
        first, second, half = corner.first, corner.second, corner.segments // 2
        # If the corner may be rounded within a ball, half of the blend's segments belong to each motion.
        # These segments follow neither path.
        if corner.rounded:
            follow[first, 1] -= half
            follow[second, 0] += half
            free[first, 1] = free[second, 0] = True
            continue
        # At a corner without a ball (BLEND 0), the first motion owns its last segment up to the time at which
        # it passes the corner. The second motion owns the rest of that segment.
        segment, time = passed[corner]
        earliest = int(follow[first, 0])
        if segment < earliest:
            # Leave out segments that belong to the previous corner.
            segment, time = earliest, SHORTEST
        # If both corners are passed in one segment, the second one must be passed after the first.
        if segment == earliest and np.isfinite(since[first]):
            time = max(time, float(since[first]) + SHORTEST)
        follow[first, 1], follow[second, 0] = segment + 1, segment
        until[first] = since[second] = time
    whole = np.array([[place.first, place.last] for place in layout.places], dtype=np.int64).reshape(count, 2)
    whole[:, 0] = np.where(np.isfinite(since), follow[:, 0], whole[:, 0])
    whole[:, 1] = np.where(np.isfinite(until), follow[:, 1], whole[:, 1])
    return Flows(follow, free, tuple(corners), whole, since, until)


def corners_of(layout: Layout, robot: Robot) -> list[Corner]:
    """Return all corners, in order."""
    corners, before = [], 0
    for row, place in enumerate(layout.places):
        if place.size:
            if place.before is not None:
                corners.append(_corner(layout, robot, before, row, place.before))
            before = row
    return corners


def _passed(
    judged: Judged, layout: Layout, starts: Starts, corners: list[Corner]
) -> Iterator[tuple[Corner, tuple[int, float]]]:
    """Yield each corner without a blend radius, with the instant at which the robot passes it.

    The instant is given as a segment and the time after the start of that segment [s].
    """
    robot, tolerance = judged.robot, judged.tolerance
    # Corners of the same moving frame are computed together.
    groups: dict[bytes, tuple[Array | None, list[Corner]]] = {}
    for corner in corners:
        motions = layout.places[corner.first].motion, layout.places[corner.second].motion
        frame = None if corner.joints else frame_of(*motions)
        groups.setdefault(b"" if frame is None else frame.tobytes(), (frame, []))[1].append(corner)
    for frame, group in groups.values():
        for begin in range(0, len(group), _TOGETHER):
            go_on()
            batch = group[begin : begin + _TOGETHER]
            spans = np.array([_around(layout, corner) for corner in batch])
            rows = np.concatenate([np.arange(*span) for span in spans])
            owner = np.repeat(np.arange(len(batch)), spans[:, 1] - spans[:, 0])
            seconds = [corner.second for corner in batch]
            if frame is None:
                weights = np.tile(joint_weights(robot, tolerance), (len(batch), 1))
                target = tangent.Corners(starts.q[seconds], weights)
            else:
                weights = np.array([_weights(judged, layout, corner) for corner in batch])
                target = tangent.Corners(starts.q[seconds], weights, frame, starts.flange[seconds] @ frame)
            cubics = Cubics.of_spline(layout.control, layout.at[rows], layout.time[rows])
            found, time = tangent.passing(cubics, owner, target, robot.chain)
            yield from zip(batch, zip(rows[found].tolist(), time.tolist(), strict=True), strict=True)


def _weights(judged: Judged, layout: Layout, corner: Corner) -> tuple[float, float]:
    """Return the weights of distance [1/m] and angle [1/rad] in the search for a corner's passing time.

    Each weight is 1 / tolerance. If the tolerances of the two motions differ, the smaller one counts.
    """
    one, other = (judged.tolerance_of(layout.places[row].motion) for row in (corner.first, corner.second))
    return 1.0 / min(one.position, other.position), 1.0 / min(one.angle, other.angle)


def _around(layout: Layout, corner: Corner) -> tuple[int, int]:
    """Return the range of segments in which the passing time of a corner is searched.

    The range contains the segments in which both motions overlap at the corner, and one more on either side.
    It excludes the segments of the corners at the other ends of both motions.
    """
    one, other = layout.places[corner.first], layout.places[corner.second]
    reach = corner.segments // 2 + 1
    begin = max(one.last - reach, one.first + (one.before or 0) // 2 - 1, 0)
    return begin, max(min(other.first + reach, other.last - (other.behind or 0) // 2), begin + 1)


def frame_of(*motions: hir.Motion) -> Array | None:
    """Return the moving frame (4, 4), relative to the flange, of the first Cartesian motion among `motions`;
    None if all are in joint space.
    """
    return next((motion.flange_from_moving for motion in motions if motion.leads_frame), None)


def _corner(layout: Layout, robot: Robot, first: int, second: int, segments: int) -> Corner:
    one, other = layout.places[first].motion, layout.places[second].motion
    joints = isinstance(one, IN_JOINTS) and isinstance(other, IN_JOINTS)
    blend = one.blend
    assert blend is not None  # the map lists a blend only where the program has one
    size = float(radii(blend, robot).max()) if joints else blend.length or 0.0
    return Corner(first, second, segments, segments > 0 and size > 0.0, joints)


@frozen(eq=False)
class Asked:
    """Requirements on the speeds of P motions.

    Attributes:
        top: (P, 2) largest speed of the frame's origin [m/s], and largest angular speed [rad/s]; NaN without
            a limit.
        share: (P,) fraction of `top` below which the speed must not fall after `top` has been reached.
        around: (P, 2) largest allowed speed in the blend before the motion and in the blend after it [m/s].
        held: (P, 2) True in the first column if the motion must already have its speed at its start, in the
            second column if it must still have its speed at its end. This is required at a corner without a
            blend radius if the motion on the other side of the corner is not slower.
    """

    top: Array
    share: Array
    around: Array
    held: NDArray[np.bool_]


def speeds_asked(judged: Judged, layout: Layout, flows: Flows) -> Asked:
    """Return the requirements on the speeds of all motions of a controller text."""
    count = len(layout.places)
    top, share = np.full((count, 2), np.nan), np.ones(count)
    for row, place in enumerate(layout.places):
        speed = place.motion.timing.speed
        if speed is None or isinstance(place.motion, IN_JOINTS):
            continue
        kept = judged.share_of(place.step)
        # The speed must reach the fraction `kept` of the programmed speed. After that, it must never fall
        # below the planner's fraction `least`.
        share[row] = judged.least_of(place.step) / kept
        top[row] = (
            np.nan if speed.length is None else speed.length * kept,
            np.nan if speed.angle is None else speed.angle * kept,
        )
    around, held = np.full((count, 2), np.inf), np.zeros((count, 2), dtype=np.bool_)
    # In a blend, neither motion may be faster than the programmed speed of the faster motion. At a corner
    # without a ball (BLEND 0), a motion must have its speed at the corner too, unless the other motion is
    # slower.
    cruise = top[:, 0] * share
    for corner in flows.corners:
        pair = [corner.first, corner.second]
        if np.isnan(cruise[pair]).any():
            continue
        around[corner.first, 1] = around[corner.second, 0] = top[pair, 0].max()
        if not corner.rounded:
            held[corner.first, 1] = cruise[corner.second] >= cruise[corner.first]
            held[corner.second, 0] = cruise[corner.first] >= cruise[corner.second]
    return Asked(top, share, around, held)
