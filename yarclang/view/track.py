"""Joint positions over time, and the paths of a frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from yarclang.motion.curve import Curve, Sampler
from yarclang.progress import each, go_on
from yarclang.robot.kinematics.fk import poses_and_jacobians, tool_poses
from yarclang.robot.model import Array, Chain
from yarclang.view.stage import Track, Way

MOST_POINTS = 20_000
"""Approximate largest number of points of a path."""
_MOST_EACH, _FEWEST_EACH = 400, 8
"""Largest number of points of one motion, and smallest number if there are only few motions."""
_AT_ONCE = 4_096
"""Number of points that are computed together."""


@dataclass(frozen=True, eq=False)
class Curves:
    """Joint positions over time as planned motions. Between the motions, the robot is at rest.

    Attributes:
        start: (n,) joint positions before the first motion [rad or m].
        curves: (m,) the motions.
        begins: (m,) times at which they begin [s].
    """

    start: Array
    curves: tuple[Curve, ...]
    begins: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return positions and velocities; see `Track.at`."""
        q = np.tile(self.start, (len(times), 1))
        v = np.zeros_like(q)
        number = np.searchsorted(self.begins, times, side="right") - 1
        moved = number >= 0
        if moved.any():
            q[moved], v[moved] = self.of(number[moved], times[moved] - self.begins[number[moved]])
        return q, v

    def of(self, number: NDArray[np.intp], times: Array) -> tuple[Array, Array]:
        """Return joint positions [rad or m] and velocities, (N, n) each, during planned motions.

        Args:
            number: (N,) indices of the motions.
            times: (N,) times after the start of each motion [s].
        """
        q, v, _ = self._sampler.sample(number, times)
        return q, v

    @cached_property
    def _sampler(self) -> Sampler:
        return Sampler(self.curves)


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """Joint positions over time as recorded samples, connected by straight lines.

    Attributes:
        times: (N,) [s], never decreasing.
        q: (N, n) joint positions [rad or m].
    """

    times: Array
    q: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return positions and velocities; see `Track.at`."""
        columns = range(self.q.shape[1])
        q = np.column_stack([np.interp(times, self.times, self.q[:, column]) for column in columns])
        if len(self.times) < 2:
            return q, np.zeros_like(q)
        rate = np.gradient(
            self.q, np.maximum.accumulate(self.times + 1e-9 * np.arange(len(self.times))), axis=0
        )
        v = np.column_stack([np.interp(times, self.times, rate[:, column]) for column in columns])
        v[(times < self.times[0]) | (times > self.times[-1])] = 0.0
        return q, v


@dataclass(frozen=True, slots=True, eq=False)
class Shifted:
    """Joint positions over time, converted to another time scale. Velocities are still derivatives with
    respect to the original time.

    Attributes:
        track: the joint positions over their original time.
        outer: (N,) times on the new scale [s], never decreasing.
        inner: (N,) corresponding times of `track` [s], never decreasing.
    """

    track: Track
    outer: Array
    inner: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return positions and velocities; see `Track.at`."""
        return self.track.at(np.interp(times, self.outer, self.inner))


def way_of_curves(curves: Curves, chain: Chain, flange_from_frame: Array, pieces: Sequence[int]) -> Way:
    """Return the path of a frame during motions.

    Motions get more points if their joints move farther. If there are many motions, short ones have few
    points; if there are very many, only their start and end.

    Args:
        curves: the motions.
        chain: the robot's joints.
        flange_from_frame: (4, 4) pose of the frame.
        pieces: index of the command of each motion.
    """
    if not curves.curves:
        still = tool_poses(chain, curves.start[None], flange_from_frame)[:, :3, 3]
        return Way(np.zeros(1), still, np.zeros(1), np.array([0, 1]), np.array([-1]))
    ways = np.array([np.abs(np.diff(curve.points, axis=0)).sum() for curve in each(curves.curves)])
    share = ways / max(float(ways.sum()), 1e-12)
    fewest = int(np.clip(MOST_POINTS // len(ways), 1, _FEWEST_EACH))
    parts = np.clip((share * MOST_POINTS).astype(np.int64), fewest, _MOST_EACH)
    breaks = np.concatenate([[0], np.cumsum(parts + 1)])
    owner = np.repeat(np.arange(len(parts)), parts + 1)
    durations = np.array([curve.duration for curve in curves.curves])
    local = (np.arange(breaks[-1]) - breaks[owner]) / parts[owner] * durations[owner]
    points, speeds = np.empty((len(local), 3)), np.empty(len(local))
    for first in range(0, len(local), _AT_ONCE):
        rows = slice(first, first + _AT_ONCE)
        q, v = curves.of(owner[rows], local[rows])
        points[rows], speeds[rows] = followed(chain, q, v, flange_from_frame)
        go_on()
    return Way(curves.begins[owner] + local, points, speeds, breaks, np.array(pieces))


def way_of_track(track: Track, times: Array, chain: Chain, flange_from_frame: Array) -> Way:
    """Return the path of a frame as one connected section.

    Args:
        track: the joint positions over time.
        times: (N,) times of the path's points [s].
        chain: the robot's joints.
        flange_from_frame: (4, 4) pose of the frame.
    """
    q, v = track.at(times)
    points, speed = followed(chain, q, v, flange_from_frame)
    return Way(times, points, speed, np.array([0, len(times)]), np.array([-1]))


def followed(chain: Chain, q: Array, v: Array, flange_from_frame: Array) -> tuple[Array, Array]:
    """Return positions (N, 3) [m] and speeds (N,) [m/s] of a frame's origin.

    Args:
        chain: the robot's joints.
        q: (N, n) joint positions [rad or m].
        v: (N, n) joint velocities.
        flange_from_frame: (4, 4) pose of the frame.
    """
    poses, jacobians = poses_and_jacobians(chain, q, flange_from_frame)
    speed: Array = np.linalg.norm(np.einsum("nij,nj->ni", jacobians[:, :3], v), axis=1)
    return poses[:, :3, 3], speed
