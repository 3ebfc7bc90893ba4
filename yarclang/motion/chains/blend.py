"""Superpose motions that flow into each other: their motion profiles overlap, and during the overlap both
paths are traversed at once.

Each profile starts and ends at rest. While motion 1 is ending and motion 2 begins, two displacements from the
corner are added: back by the remaining part of path 1, and forward by the completed part of path 2. The curve
is therefore smooth at any corner, and leaves the programmed path only where profiles overlap.

Between two paths of one moving frame, poses are added, and the frame stays in the plane of its two lines.
Otherwise joint positions are added. If the corner's ball has radius 0, the paths are tangent. Then distances
along both paths are added, and the path isn't left at all.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Hashable, Sequence

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath, extent_of
from yarclang.motion.curve import knot_values, solve_tridiagonal
from yarclang.motion.leading.led import FrameWay
from yarclang.motion.path import Path
from yarclang.motion.trials import Trial
from yarclang.progress import go_on
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.inverse import follow
from yarclang.robot.model import Chain

_FADE = 24
"""Number of knots on either side of an overlap that are also corrected. The effect of a correction falls to
about a fourth from knot to knot.
"""


@frozen(eq=False)
class Corner:
    """The corner at which one motion flows into the next, and the largest allowed distance of the curve from
    this corner.

    `point` (n,) is the joint position at the corner. If `flange_from_moving` (4, 4) is given, the moving
    frame stays within a ball of `radius` [m] around its position at the corner. If `flange_from_moving` is
    None, each joint stays within `reach` (n,) [rad or m] of the corner.
    """

    point: Array
    radius: float
    flange_from_moving: Array | None
    reach: Array | None = None

    @property
    def key(self) -> Hashable:
        """A hashable key that contains all values of the corner."""
        arrays = (self.point, self.flange_from_moving, self.reach)
        return self.radius, *(None if one is None else one.tobytes() for one in arrays)

    def farthest(self, chain: Chain, q: Array) -> Array:
        """Return the distances of joint positions `q` (N, n) from the corner, as shares (N,) of the allowed
        distance.
        """
        if self.flange_from_moving is None:
            assert self.reach is not None
            shares: Array = (np.abs(q - self.point) / np.maximum(self.reach, 1e-300)).max(axis=1)
            return shares
        both = tool_poses(chain, np.concatenate((self.point[None], q)), self.flange_from_moving)[:, :3, 3]
        distance: Array = np.linalg.norm(both[1:] - both[0], axis=1) / max(self.radius, 1e-300)
        return distance

    @property
    def is_tangent(self) -> bool:
        """True if the path may not be left at all."""
        return self.reach is None and self.radius == 0.0


@frozen(eq=False)
class Part:
    """One motion of a chain: its path, and the control points (n + 3, d) of the motion without its
    neighbours.
    """

    path: Path
    trial: Trial

    @property
    def segments(self) -> int:
        """The number of segments of its motion profile."""
        return self.trial.segments


def superpose(
    chain: Chain, parts: Sequence[Part], corners: Sequence[Corner], overlaps: Sequence[int]
) -> Array:
    """Superpose the motions of a chain, and return the control points (n + 3, d) of the whole chain.

    A spline is linear in its control points, so the control points of the motions can be added, each relative
    to its start. Where poses, or distances along the paths, are to be added instead of joint positions, the
    control points are corrected.

    Args:
        chain: the arm.
        parts: the k motions of the chain.
        corners: the k - 1 corners between them.
        overlaps: for each corner, the number of segments in which two motions overlap; even, and at most the
            number of segments of either motion. 0 is a stop.
    """
    starts = begins(parts, overlaps)
    total = starts[-1] + parts[-1].segments
    stops = [0, *(start for start, overlap in zip(starts[1:], overlaps, strict=True) if not overlap), total]
    points = np.tile(parts[0].path.start, (total + 3, 1))
    for part, begin in zip(parts, starts, strict=True):
        own = part.trial.points
        # Add each motion's displacement from its start; after its end, it stays at its full displacement.
        points[begin : begin + len(own)] += own - part.path.start
        points[begin + len(own) :] += part.path.end - part.path.start
    for number, (corner, overlap) in enumerate(zip(corners, overlaps, strict=True)):
        first, second = parts[number], parts[number + 1]
        if overlap and (corner.is_tangent or _share_a_frame(first.path, second.path)):
            begin = starts[number + 1]
            after = bisect_right(stops, begin)
            rests = stops[after - 1], stops[after]
            _correct(points, chain, first, second, corner, overlap, begin, rests)
    return points


def begins(parts: Sequence[Part], overlaps: Sequence[int]) -> list[int]:
    """Return, for each motion of a chain, the knot at which its motion profile begins."""
    starts = [0]
    for part, overlap in zip(parts, overlaps, strict=False):
        starts.append(starts[-1] + part.segments - overlap)
    return starts


def shares(first: Part, second: Part, overlap: int) -> tuple[Array, Array]:
    """Return the completed shares of the first and of the second path at each knot strictly inside their
    overlap, (overlap - 1,) each.
    """
    done, begun = knot_values(first.trial.control), knot_values(second.trial.control)
    return done[len(done) - overlap : -1], begun[1:overlap]


def leads_frame(first: Path, second: Path, flange_from_moving: Array | None) -> bool:
    """Return True if both paths are paths of the given moving frame (4, 4)."""
    return (
        flange_from_moving is not None
        and isinstance(first, CartesianPath)
        and np.array_equal(first.flange_from_moving, flange_from_moving)
        and _share_a_frame(first, second)
    )


def places_of_both(first: Path, second: Path, done: Array, begun: Array) -> Array:
    """Return the positions (N, 3) [m] of a frame that traverses two paths at once, relative to their common
    corner.

    Args:
        first: the path to the corner.
        second: the path from the corner on.
        done: (N,) completed share of the first path.
        begun: (N,) completed share of the second path.
    """
    assert isinstance(first, CartesianPath)
    assert isinstance(second, CartesianPath)
    middle = second.frame.poses(np.zeros(1))[0, :3, 3]
    one, other = first.frame.poses(done), second.frame.poses(begun)
    # Displacements from the corner add up: (p1 - c) + (p2 - c).
    places: Array = one[:, :3, 3] + other[:, :3, 3] - 2.0 * middle
    return places


def _share_a_frame(first: Path, second: Path) -> bool:
    """Return True if both paths are paths of one moving frame."""
    return (
        isinstance(first, CartesianPath)
        and isinstance(second, CartesianPath)
        and np.array_equal(first.flange_from_moving, second.flange_from_moving)
    )


def _correct(
    points: Array,
    chain: Chain,
    first: Part,
    second: Part,
    corner: Corner,
    overlap: int,
    begin: int,
    rests: tuple[int, int],
) -> None:
    """Change control points so that the curve passes through the right joint positions at the knots of an
    overlap.

    `rests` are the knots of the stops before and after the overlap. At each stop, three equal control points
    stay as they are.
    """
    wanted = both(chain, first.path, second.path, corner, *shares(first, second, overlap))
    # The control points k to k + 2 of a stop at knot k are equal, and the curve is at control point k + 1
    # when it passes knot k. Knots k - 1 and k + 1 can't be corrected without moving the stop, as in
    # `through_knots`.
    low, high = max(begin + 1 - _FADE, rests[0] + 2), min(begin + overlap + _FADE, rests[1] - 1)
    if low >= high:
        return
    miss = np.zeros((high - low, points.shape[1]))
    # Outside of the overlap, the error at the knots is zero.
    one, end = max(begin + 1, low), min(begin + overlap, high)
    if one < end:
        miss[one - low : end - low] = wanted[one - begin - 1 : end - begin - 1] - knot_values(
            points[one : end + 2]
        )
    # Compute the change d of control points that corrects the errors at the knots near the overlap: (d[k] + 4
    # d[k+1] + d[k+2]) / 6 = miss[k], with d zero outside of the range.
    points[low + 1 : high + 1] += solve_tridiagonal(
        np.full(len(miss), 4.0), np.ones(len(miss) - 1), 6.0 * miss
    )


def both(chain: Chain, first: Path, second: Path, corner: Corner, done: Array, begun: Array) -> Array:
    """Return joint positions (N, n) at N instants of an overlap of two motions.

    Args:
        chain: the arm.
        first: path of the first motion.
        second: path of the second motion.
        corner: the corner between them.
        done: (N,) completed share of the first path.
        begun: (N,) completed share of the second path.
    """
    if corner.is_tangent:
        return _along_both(first, second, done, begun)
    if _share_a_frame(first, second):
        assert isinstance(first, CartesianPath)
        assert isinstance(second, CartesianPath)
        return _poses_of_both(chain, first, second, corner, done, begun)
    return first.joints(done) + second.joints(begun) - corner.point


def _poses_of_both(
    chain: Chain, first: CartesianPath, second: CartesianPath, corner: Corner, done: Array, begun: Array
) -> Array:
    one, other = first.frame.poses(done), second.frame.poses(begun)
    middle = second.frame.poses(np.zeros(1))[0]
    poses = other.copy()
    poses[:, :3, 3] += one[:, :3, 3] - middle[:3, 3]
    # The orientation on path 1, turned by the rotation of path 2 since the corner: R2 Rc' R1.
    poses[:, :3, :3] = other[:, :3, :3] @ middle[:3, :3].T @ one[:, :3, :3]
    seeds = first.followed.at(done) + second.followed.at(begun) - corner.point
    return follow(chain, poses @ np.linalg.inv(first.flange_from_moving), seeds)[0]


def _along_both(first: Path, second: Path, done: Array, begun: Array) -> Array:
    """Return joint positions on two paths that are tangent to each other at their corner.

    The distances covered on both paths are added. Up to the length of the first path, the sum is a place on
    the first path; the rest is a place on the second path.
    """
    go_on()
    lengths = way_length(first), way_length(second)
    gone = done * lengths[0] + begun * lengths[1]
    behind = gone > lengths[0]
    q = np.empty((len(gone), len(first.start)))
    q[~behind] = first.joints(gone[~behind] / lengths[0])
    q[behind] = second.joints(np.minimum((gone[behind] - lengths[0]) / lengths[1], 1.0))
    return q


def way_length(path: Path | FrameWay) -> float:
    """Return the length of a path: of the moving frame's path [m, or rad for a pure rotation], or of the path
    in joint space [rad and m].
    """
    if isinstance(path, CartesianPath | FrameWay):
        return extent_of(path.frame)[0]
    q = path.joints(np.linspace(0.0, 1.0, 257))
    return float(np.linalg.norm(np.diff(q, axis=0), axis=1).sum())
