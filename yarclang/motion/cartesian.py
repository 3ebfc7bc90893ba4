"""Compute the joint motion of the arm along Cartesian paths of the moving frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.robot.kinematics.fk import BLOCK, walk
from yarclang.robot.kinematics.inverse import follow
from yarclang.robot.kinematics.numeric import pose_columns
from yarclang.robot.kinematics.track import SAMPLES, Broken, Reason, Track, track
from yarclang.robot.model import Chain, Limits, Tolerance

_LIKE = Tolerance()
"""Tolerances of position and angle. Errors are divided by their tolerance, so that an error in position can
be compared with an error in angle.
"""

_AT_ONCE = 8_192
"""Number of samples of a long path that are processed at once: for inverse kinematics, or for the comparison
of joint positions with the path.
"""

_MANY_LEGS = 512
"""Number of legs above which a path is sampled at least once on each leg. With fewer samples, bends could be
missed.
"""

_STILL = 1e-9
"""Length below which a path counts as a pure rotation [m]."""

_ROUNDED, _TURNS = 1e-6, 1e-6
"""If a path turns the frame by at least the angle `_TURNS` [rad], it counts as a pure rotation already below
the length `_ROUNDED` [m]. This allows for coordinates that are rounded to four decimals of a millimetre.
"""


class FramePath(Protocol):
    """A path of the moving frame in {B}; its parameter s goes from 0 to 1."""

    @property
    def length(self) -> float:
        """The distance that the frame's origin travels [m]."""
        ...

    @property
    def angle(self) -> float:
        """The angle by which the frame turns [rad]."""
        ...

    def poses(self, s: Array) -> Array:
        """Return the frame's poses base_from_moving (N, 4, 4) at the places `s` (N,)."""
        ...

    def tangents(self, s: Array) -> Array:
        """Return the derivatives of the frame's pose with respect to s at N places s, as (N, 6): of the
        origin's position [m], and the rotation rate [rad]. Both are in the axes of {B}.
        """
        ...


@frozen(eq=False)
class CartesianPath:
    """A path of the moving frame, with the joint motion of the arm along it in one arm configuration.

    `followed` has joint positions along the path, without jumps. At any other place, the joint position is
    the inverse-kinematics solution nearest to them. `start` (n,) is the joint position at the start [rad or
    m].
    """

    chain: Chain
    flange_from_moving: Array
    frame: FramePath
    start: Array
    followed: Track

    @property
    def end(self) -> Array:
        """The joint position at s = 1, (n,) [rad or m]."""
        end: Array = self.followed.q[-1]
        return end

    @property
    def slope(self) -> Array:
        """The approximate largest absolute derivative of each joint position with respect to s, (n,) [rad or
        m].
        """
        track = self.followed
        # Difference quotients between the places at which inverse kinematics was solved.
        slope: Array = (np.abs(np.diff(track.q, axis=0)) / np.diff(track.s)[:, None]).max(axis=0)
        return slope

    @property
    def is_straight_in_joints(self) -> bool:
        """Always False: a Cartesian path is never assumed to be straight in joint space."""
        return False

    @property
    def places(self) -> Array:
        """The places s (k,) at which inverse kinematics was solved. They are closer together where a joint
        turns faster.
        """
        return self.followed.s

    @property
    def extent(self) -> tuple[float, bool]:
        """The length of the frame's path [m, or rad for a pure rotation], and True for a pure rotation; see
        `extent_of`.
        """
        return extent_of(self.frame)

    def joints(self, s: Array) -> Array:
        """Return joint positions (N, n) at the places `s` (N,)."""
        return joints_of([self], [s])[0]

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Return the largest deviation of the moving frame from the path: in position [m], and in angle
        [rad].

        A frame that is only early or late along the path doesn't deviate from the path. Therefore only the
        error perpendicular to the path's tangent counts.

        Args:
            q: (N, n) joint positions [rad or m].
            s: (N,) the place on the path for each joint position.
        """
        return deviations([self], [q], [s])[0]


def joints_of(paths: Sequence[CartesianPath], places: Sequence[Array]) -> list[Array]:
    """Return, for each path, the joint positions (N, n) at N places s on it.

    Inverse kinematics is solved for all paths together; the results are the same as for each path by itself.

    Args:
        paths: paths of one arm and one moving frame.
        places: the places s (N,) for each path, as for `CartesianPath.joints`.
    """
    chain, tool = paths[0].chain, paths[0].flange_from_moving
    if len(paths) == 1 and len(places[0]) > _AT_ONCE:
        begins = range(0, len(places[0]), _AT_ONCE)
        parts = [joints_of(paths, [places[0][begin : begin + _AT_ONCE]])[0] for begin in begins]
        return [np.concatenate(parts)]
    poses = np.concatenate([path.frame.poses(s) for path, s in zip(paths, places, strict=True)])
    seeds = np.concatenate([path.followed.at(s) for path, s in zip(paths, places, strict=True)])
    q = follow(chain, poses @ np.linalg.inv(tool), seeds)[0]
    return np.split(q, np.cumsum([len(s) for s in places])[:-1])


def deviations(
    paths: Sequence[CartesianPath], q: Sequence[Array], places: Sequence[Array]
) -> list[tuple[float, float]]:
    """Return for each path the largest deviations of the moving frame from it, as `CartesianPath.deviation`
    does.

    Args:
        paths: paths of one arm and one moving frame.
        q: for each path, joint positions (N, n) [rad or m].
        places: for each path, the places s (N,) of these joint positions.
    """
    if len(paths) == 1 and len(places[0]) > _AT_ONCE:
        each = [
            deviations(paths, [q[0][begin : begin + _AT_ONCE]], [places[0][begin : begin + _AT_ONCE]])[0]
            for begin in range(0, len(places[0]), _AT_ONCE)
        ]
        return [(max(one[0] for one in each), max(one[1] for one in each))]
    chain, tool = paths[0].chain, paths[0].flange_from_moving
    joints = np.concatenate(q)
    wanted = np.concatenate([path.frame.poses(s) for path, s in zip(paths, places, strict=True)])
    tangents = np.concatenate([path.frame.tangents(s) for path, s in zip(paths, places, strict=True)])
    missed = np.empty((2, len(joints)))
    for start in range(0, len(joints), BLOCK):
        piece = slice(start, start + BLOCK)
        columns = walk(chain, joints[piece].T, tool)[0]
        missed[:, piece] = _across(columns, pose_columns(wanted[piece]), tangents[piece].T)
    first = np.concatenate(([0], np.cumsum([len(s) for s in places])[:-1]))
    distances, angles = np.sqrt(np.maximum.reduceat(missed, first, axis=1))
    return list(zip((distances * _LIKE.position).tolist(), (angles * _LIKE.angle).tolist(), strict=True))


def _across(columns: Array, wanted: Array, tangent: Array) -> Array:
    """Return the squared errors in position and in angle perpendicular to the path (2, N), in units of
    `_LIKE`.

    Args:
        columns: the moving frame's axes and origin at N instants (4, 3, N).
        wanted: the axes and origin at the same places on the path (4, 3, N).
        tangent: derivatives of the path with respect to s (6, N) [m, rad].
    """
    miss: Array = np.empty((6, columns.shape[2]))
    miss[:3] = (columns[3] - wanted[3]) / _LIKE.position
    for row in range(3):
        after, before = (row + 1) % 3, (row + 2) % 3
        # The sum of the cross products of the frames' axes is twice the sine of the angle between the frames.
        sine = (columns[:3, before] * wanted[:3, after] - columns[:3, after] * wanted[:3, before]).sum(axis=0)
        miss[3 + row] = sine / (2.0 * _LIKE.angle)
    # Remove the component of the error along the tangent.
    scaled = np.concatenate((tangent[:3] / _LIKE.position, tangent[3:] / _LIKE.angle))
    square = np.maximum((scaled * scaled).sum(axis=0), 1e-300)
    miss -= ((miss * scaled).sum(axis=0) / square) * scaled
    miss *= miss
    squares: Array = miss.reshape(2, 3, -1).sum(axis=1)
    return squares


def extent_of(frame: FramePath) -> tuple[float, bool]:
    """Return the length of a frame's path, and True for a pure rotation.

    The length of a pure rotation is its angle [rad]. Otherwise it is the distance that the frame's origin
    travels [m].
    """
    still = _ROUNDED if frame.angle >= _TURNS else _STILL
    return (frame.angle, True) if frame.length < still else (frame.length, False)


def along(
    chain: Chain,
    limits: Limits,
    flange_from_moving: Array,
    frame: FramePath,
    q_start: Array,
    *,
    legs: int = 1,
    reason: Reason = "measured",
) -> CartesianPath | Broken:
    """Solve inverse kinematics along a path of the moving frame, keeping the arm configuration of the start.

    Args:
        chain: the arm, n joints.
        limits: the joint limits of the arm.
        flange_from_moving: (4, 4) pose of the moving frame on the flange [m].
        frame: the path of the moving frame.
        q_start: (n,) joint position at the path's start [rad or m].
        legs: number of legs of the path; if there are very many, each is sampled at least once.
        reason: as for `track`.
    """
    poses = flange_poses_of(frame, flange_from_moving)
    tracked = track(
        chain, limits, poses, q_start, samples=legs + 1 if legs > _MANY_LEGS else SAMPLES, reason=reason
    )
    if isinstance(tracked, Broken):
        return tracked
    return CartesianPath(chain, flange_from_moving, frame, q_start, tracked)


def flange_poses_of(frame: FramePath, flange_from_moving: Array) -> Callable[[Array], Array]:
    """Return a function that computes the flange's poses (N, 4, 4) at places s (N,) along a path of the
    moving frame.
    """
    moving_from_flange = np.linalg.inv(flange_from_moving)
    return lambda s: frame.poses(s) @ moving_from_flange
