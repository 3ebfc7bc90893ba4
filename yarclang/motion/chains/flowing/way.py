"""Join the Cartesian paths of many motions of one moving frame to one path."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath, extent_of
from yarclang.motion.chains.flowing.turns import product, quaternions
from yarclang.motion.paths.arc import Arc
from yarclang.motion.paths.line import Line
from yarclang.motion.paths.pose_spline import PoseSpline

Numbers = NDArray[np.int64]
Marks = NDArray[np.bool_]

RADIAN = 0.1
"""Length that a pure rotation by 1 rad adds to the joined path [m]."""

_SHORT = 0.05
"""Motion of a joint along a path [rad or m] up to which joint positions are interpolated linearly between the
path's ends, as initial guesses.
"""


@frozen(eq=False)
class Way:
    """The Cartesian paths of k motions, joined to one path.

    `lengths` (k,) [m] are the lengths of the paths. `begins` (k + 1,) [m] are the places at which the paths
    begin, and the end of the last one.

    Lines and arcs are stored as arrays. A line goes from `start` (k, 3) by `shift` (k, 3). An arc goes about
    its centre `start` (k, 3) by the angle `sweep` (k,), in the plane of the axes `along` and `side` (k, 3)
    [m]. Along both, the frame turns by `angle` (k,) about `axis` (k, 3), from the orientation `turn` (k, 4).
    """

    paths: tuple[CartesianPath, ...]
    lengths: Array
    begins: Array
    start: Array
    shift: Array
    sweep: Array
    along: Array
    side: Array
    axis: Array
    angle: Array
    turn: Array
    ends: Array
    is_plain: NDArray[np.bool_]
    is_bent: NDArray[np.bool_]

    @staticmethod
    def of(paths: Sequence[CartesianPath]) -> Way:
        """Join the paths of consecutive motions. Each path begins where the path before it ends."""
        count = len(paths)
        extents = [extent_of(path.frame) for path in paths]
        lengths = [size * RADIAN if turns else size for size, turns in extents]
        start, shift, along, side, axis = (np.zeros((count, 3)) for _ in range(5))
        sweep, angle = np.zeros(count), np.zeros(count)
        first = np.tile(np.eye(3), (count, 1, 1))
        is_plain = np.zeros(count, dtype=np.bool_)
        for place, frame in enumerate(path.frame for path in paths):
            if not isinstance(frame, Line | Arc):
                continue
            is_plain[place] = True
            first[place] = frame.base_from_start[:3, :3]
            axis[place], angle[place] = frame.axis, frame.angle
            if isinstance(frame, Line):
                start[place], shift[place] = frame.base_from_start[:3, 3], frame.shift
            else:
                # An arc is centre + cos(phi) spoke + sin(phi) (normal x spoke).
                spoke = frame.base_from_start[:3, 3] - frame.centre
                start[place], along[place], sweep[place] = frame.centre, spoke, frame.sweep
                side[place] = np.cross(frame.normal, spoke)
        ends = np.array([path.start for path in paths] + [paths[-1].end])
        tracks = [path.followed.q for path in paths]
        begins = np.cumsum([0] + [len(track) for track in tracks[:-1]])
        q = np.concatenate(tracks)
        # Determine the range of each joint on each path.
        moved = (np.maximum.reduceat(q, begins) - np.minimum.reduceat(q, begins)).max(axis=1)
        return Way(
            tuple(paths), *_begun(lengths), start, shift, sweep, along, side, axis, angle,
            quaternions(first), ends, is_plain, (moved > _SHORT) | ~is_plain,
        )  # fmt: skip

    def part(self, first: int, last: int) -> Way:
        """Return the joined path of the motions from `first` up to but not including `last`.

        The results of its methods don't depend on the motions' place in a chain.
        """
        own = slice(first, last)
        return Way(
            self.paths[own], *_begun(self.lengths[own]), self.start[own], self.shift[own], self.sweep[own],
                self.along[own], self.side[own],
            self.axis[own], self.angle[own], self.turn[own], self.ends[first : last + 1], self.is_plain[own],
                self.is_bent[own],
        )  # fmt: skip

    @property
    def flange_from_moving(self) -> Array:
        """The pose of the moving frame on the flange (4, 4)."""
        return self.paths[0].flange_from_moving

    def located(self, places: Array) -> tuple[Numbers, Array]:
        """Find the motion to which each of N places [m] along the joined path belongs. Return the motions
        (N,) and the shares (N,) of their paths.
        """
        own = np.clip(np.searchsorted(self.begins, places, side="right") - 1, 0, len(self.paths) - 1)
        begin = self.begins[own]
        return own, np.clip((places - begin) / (self.begins[own + 1] - begin), 0.0, 1.0)

    def poses(self, own: Numbers, share: Array) -> tuple[Array, Array]:
        """Return positions (N, 3) [m] and quaternions (N, 4) of the moving frame.

        `own` (N,) are motions, and `share` (N,) are shares of their paths. The signs of the quaternions are
        arbitrary.
        """
        p = self._plain_positions(own, share)
        # A rotation by an angle about an axis is the quaternion (cos(angle / 2), sin(angle / 2) axis).
        half = (share * self.angle[own] / 2.0)[:, None]
        turns = product(np.concatenate((np.cos(half), np.sin(half) * self.axis[own]), axis=1), self.turn[own])
        for rows in self._rows(own, ~self.is_plain):
            frame = self.paths[own[rows[0]]].frame
            s = frame.at_length(share[rows]) if isinstance(frame, PoseSpline) else share[rows]
            poses = frame.poses(s)
            p[rows], turns[rows] = poses[:, :3, 3], quaternions(poses[:, :3, :3])
        return p, turns

    def positions(self, own: Numbers, share: Array) -> Array:
        """Return the positions (N, 3) [m] of `poses`, without the orientations."""
        p = self._plain_positions(own, share)
        for rows in self._rows(own, ~self.is_plain):
            frame = self.paths[own[rows[0]]].frame
            s = frame.at_length(share[rows]) if isinstance(frame, PoseSpline) else share[rows]
            p[rows] = frame.poses(s)[:, :3, 3]
        return p

    @property
    def is_straight(self) -> bool:
        """True if all motions are lines."""
        return bool(self.is_plain.all()) and not self.sweep.any()

    def _plain_positions(self, own: Numbers, share: Array) -> Array:
        """Return positions (N, 3) [m] on lines and arcs. The rows of other motions are meaningless."""
        p: Array = self.start[own] + share[:, None] * self.shift[own]
        if self.sweep.any():
            turned = (share * self.sweep[own])[:, None]
            p += np.cos(turned) * self.along[own] + np.sin(turned) * self.side[own]
        return p

    def seeds(self, own: Numbers, share: Array) -> Array:
        """Return approximate joint positions (N, n) [rad or m] along the path, as initial guesses for inverse
        kinematics.
        """
        # Interpolate linearly between the ends. On motions with much joint motion, use the followed joint
        # positions instead.
        q = self.ends[own] + share[:, None] * (self.ends[own + 1] - self.ends[own])
        for rows in self._rows(own, self.is_bent):
            q[rows] = self.paths[own[rows[0]]].followed.at(share[rows])
        return q

    @staticmethod
    def _rows(own: Numbers, wanted: NDArray[np.bool_]) -> Iterator[Numbers]:
        """For each motion that is True in `wanted`, yield the indices of its rows in `own`."""
        (rows,) = np.nonzero(wanted[own])
        if len(rows):
            order = np.argsort(own[rows], kind="stable")
            yield from np.split(rows[order], np.flatnonzero(np.diff(own[rows][order])) + 1)


def _begun(lengths: Sequence[float] | Array) -> tuple[Array, Array]:
    """Return the lengths of joined paths as an array (k,), and the places (k + 1,) at which the paths begin,
    followed by the end of the last path.
    """
    own = np.array(lengths, dtype=np.float64)
    return own, np.concatenate(([0.0], np.cumsum(own)))
