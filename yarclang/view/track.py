"""Where joints are over time, and the paths that a frame takes with them."""

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
"""The points of a path."""
_MOST_EACH, _FEWEST_EACH = 400, 8
"""The points of one motion, where there are few motions."""
_AT_ONCE = 4_096
"""The points that are worked out at once."""


@dataclass(frozen=True, eq=False)
class Curves:
    """Motions: the curve `curves[k]` begins at `begins[k]` (m,) [s]; between them the robot stands; before the first it stands at `start` (n,)."""

    start: Array
    curves: tuple[Curve, ...]
    begins: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """As `Track` says."""
        q = np.tile(self.start, (len(times), 1))
        v = np.zeros_like(q)
        number = np.searchsorted(self.begins, times, side="right") - 1
        moved = number >= 0
        if moved.any():
            q[moved], v[moved] = self.of(number[moved], times[moved] - self.begins[number[moved]])
        return q, v

    def of(self, number: NDArray[np.intp], times: Array) -> tuple[Array, Array]:
        """Positions [rad or m] and velocities, (N, n) each, of curves `number` (N,) at times (N,) [s] from the start of each."""
        q, v, _ = self._sampler.sample(number, times)
        return q, v

    @cached_property
    def _sampler(self) -> Sampler:
        return Sampler(self.curves)


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """Samples `q` (N, n) at `times` (N,) [s], which never fall; in straight lines from one to the next."""

    times: Array
    q: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """As `Track` says."""
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
    """Another track, whose time is `inner` (N,) [s] when it is `outer` (N,) here; neither falls. Velocities are per s of the inner one."""

    track: Track
    outer: Array
    inner: Array

    def at(self, times: Array) -> tuple[Array, Array]:
        """As `Track` says."""
        return self.track.at(np.interp(times, self.outer, self.inner))


def way_of_curves(curves: Curves, chain: Chain, flange_from_frame: Array, pieces: Sequence[int]) -> Way:
    """The path of a frame through motions, each of which belongs to one of `pieces`; the points are dealt out by how far the joints move.

    The more motions there are, the fewer points a short one has: of very many only its start and its end.
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
    """The path of a frame at some times (N,) [s], in one stretch."""
    q, v = track.at(times)
    points, speed = followed(chain, q, v, flange_from_frame)
    return Way(times, points, speed, np.array([0, len(times)]), np.array([-1]))


def followed(chain: Chain, q: Array, v: Array, flange_from_frame: Array) -> tuple[Array, Array]:
    """Where the origin of a frame is (N, 3) [m], and how fast it goes (N,) [m/s]."""
    poses, jacobians = poses_and_jacobians(chain, q, flange_from_frame)
    speed: Array = np.linalg.norm(np.einsum("nij,nj->ni", jacobians[:, :3], v), axis=1)
    return poses[:, :3, 3], speed
