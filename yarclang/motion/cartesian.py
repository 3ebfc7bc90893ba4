"""Paths of the moving frame, and how the arm goes along them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.inverse import follow
from yarclang.robot.kinematics.track import Broken, Reason, Track, track
from yarclang.robot.model import Chain, Limits, Tolerance

_LIKE = Tolerance()
"""What distance counts as much as what angle where a pose is late or early along a path."""

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
        poses = flange_poses_of(self.frame, self.flange_from_moving)(s)
        return follow(self.chain, poses, self.followed.at(s))[0]

    def deviation(self, q: Array, s: Array) -> tuple[float, float]:
        """Largest distance of the moving frame from the path [m] and angle from the turn that belongs there [rad].

        What is only early or late along the path doesn't count: the miss, position and turn together, is
        taken across the path's tangent.
        """
        poses = tool_poses(self.chain, q, self.flange_from_moving)
        wanted = self.frame.poses(s)
        spin = np.einsum("nij,nkj->nik", poses[:, :3, :3], wanted[:, :3, :3])
        turn = (spin - spin.transpose(0, 2, 1))[:, (2, 0, 1), (1, 2, 0)] / 2.0
        miss = np.concatenate(((poses - wanted)[:, :3, 3] / _LIKE.position, turn / _LIKE.angle), axis=1)
        tangent = self.frame.tangents(s)
        tangent[:, :3] /= _LIKE.position
        tangent[:, 3:] /= _LIKE.angle
        square = np.maximum(np.einsum("ni,ni->n", tangent, tangent), 1e-300)
        across = miss - (np.einsum("ni,ni->n", miss, tangent) / square)[:, None] * tangent
        distance = np.linalg.norm(across[:, :3], axis=1).max() * _LIKE.position
        angle = np.linalg.norm(across[:, 3:], axis=1).max() * _LIKE.angle
        return float(distance), float(angle)


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
    reason: Reason = "measured",
) -> CartesianPath | Broken:
    """Follow a path from where the robot stands, `q_start` (n,), keeping the configuration; `reason` as of `track`."""
    poses = flange_poses_of(frame, flange_from_moving)
    tracked = track(chain, limits, poses, q_start, reason=reason)
    if isinstance(tracked, Broken):
        return tracked
    return CartesianPath(chain, flange_from_moving, frame, q_start, tracked)


def flange_poses_of(frame: FramePath, flange_from_moving: Array) -> Callable[[Array], Array]:
    """The flange's poses along a path of the moving frame."""
    moving_from_flange = np.linalg.inv(flange_from_moving)
    return lambda s: frame.poses(s) @ moving_from_flange
