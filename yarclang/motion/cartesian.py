"""Paths of the moving frame, and how the arm goes along them."""

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
"""What distance counts as much as what angle where a pose is late or early along a path."""

_AT_ONCE = 8_192
"""Places of a long path that are solved, or compared with it, at a time."""

_MANY_LEGS = 512
"""A path of more legs than this is looked at once on each: a few places don't show its bends."""

_STILL = 1e-9
"""A path shorter than this [m] is a pure turn."""


class FramePath(Protocol):
    """A path of the moving frame over s from 0 to 1, in {B}."""

    @property
    def length(self) -> float:
        """How far the frame's origin goes [m]."""
        ...

    @property
    def angle(self) -> float:
        """How far the frame turns [rad]."""
        ...

    def poses(self, s: Array) -> Array:
        """base_from_moving (N, 4, 4) at `s` (N,)."""
        ...

    def tangents(self, s: Array) -> Array:
        """Velocity of the origin [m] and angular velocity [rad] over s, in the axes of {B}, (N, 6)."""
        ...


@frozen(eq=False)
class CartesianPath:
    """A path of the moving frame as the arm goes along it, in one configuration.

    `followed` follows the arm along the path without a jump; every further position is the
    inverse kinematics nearest to it. `start` is where the robot stands, (n,) [rad or m].
    """

    chain: Chain
    flange_from_moving: Array
    frame: FramePath
    start: Array
    followed: Track

    @property
    def end(self) -> Array:
        """Where the robot stands at s = 1."""
        end: Array = self.followed.q[-1]
        return end

    @property
    def slope(self) -> Array:
        """The steepest slope of each joint over s, about (n,) [rad or m]."""
        track = self.followed
        slope: Array = (np.abs(np.diff(track.q, axis=0)) / np.diff(track.s)[:, None]).max(axis=0)
        return slope

    @property
    def is_straight_in_joints(self) -> bool:
        """Never assumed."""
        return False

    @property
    def places(self) -> Array:
        """Where the arm was followed (k,): the denser the faster a joint turns."""
        return self.followed.s

    @property
    def extent(self) -> tuple[float, bool]:
        """As of `extent_of`."""
        return extent_of(self.frame)

    def joints(self, s: Array) -> Array:
        """Joint positions (N, n) at `s` (N,)."""
        return joints_of([self], [s])[0]

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Largest distance of the moving frame from the path [m] and angle from the turn that belongs there [rad].

        What is only early or late along the path doesn't count: the miss, position and turn together, is
        taken across the path's tangent.
        """
        return deviations([self], [q], [s])[0]


def joints_of(paths: Sequence[CartesianPath], places: Sequence[Array]) -> list[Array]:
    """Return the joint positions (N, n) of each path at its places (N,): solved together, and as each by itself.

    Args:
        paths: paths of one arm and one moving frame.
        places: the share of the way of each, as of `CartesianPath.joints`.
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
    """Return the deviation of joint positions from each path, as of `CartesianPath.deviation`.

    Args:
        paths: paths of one arm and one moving frame.
        q: joint positions (N, n) for each path [rad or m].
        places: the share of the way (N,) near each of them.
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
    """Return the squares of the miss in position and angle (2, N) across the path, as shares of `_LIKE`.

    Args:
        columns: the moving frame's axes and origin (4, 3, N).
        wanted: those that belong there (4, 3, N).
        tangent: velocity over s (6, N) [m, rad].
    """
    miss: Array = np.empty((6, columns.shape[2]))
    miss[:3] = (columns[3] - wanted[3]) / _LIKE.position
    for row in range(3):
        after, before = (row + 1) % 3, (row + 2) % 3
        sine = (columns[:3, before] * wanted[:3, after] - columns[:3, after] * wanted[:3, before]).sum(axis=0)
        miss[3 + row] = sine / (2.0 * _LIKE.angle)
    scaled = np.concatenate((tangent[:3] / _LIKE.position, tangent[3:] / _LIKE.angle))
    square = np.maximum((scaled * scaled).sum(axis=0), 1e-300)
    miss -= ((miss * scaled).sum(axis=0) / square) * scaled
    miss *= miss
    squares: Array = miss.reshape(2, 3, -1).sum(axis=1)
    return squares


def extent_of(frame: FramePath) -> tuple[float, bool]:
    """How far a moving frame goes: its way [m] and False, or, of a pure turn, the angle [rad] and True."""
    return (frame.angle, True) if frame.length < _STILL else (frame.length, False)


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
    """Follow a path from where the robot stands, `q_start` (n,), keeping the configuration; `reason` as of `track`. A path of very many
    `legs` is looked at once on each at least.
    """
    poses = flange_poses_of(frame, flange_from_moving)
    tracked = track(
        chain, limits, poses, q_start, samples=legs + 1 if legs > _MANY_LEGS else SAMPLES, reason=reason
    )
    if isinstance(tracked, Broken):
        return tracked
    return CartesianPath(chain, flange_from_moving, frame, q_start, tracked)


def flange_poses_of(frame: FramePath, flange_from_moving: Array) -> Callable[[Array], Array]:
    """The flange's poses along a path of the moving frame."""
    moving_from_flange = np.linalg.inv(flange_from_moving)
    return lambda s: frame.poses(s) @ moving_from_flange
