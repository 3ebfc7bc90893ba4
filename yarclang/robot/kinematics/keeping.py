"""Follow a path within joint limits with a redundant arm: a joint at its limit stays there, and the other
joints compensate.

A joint path is first computed step by step along the path, each step with the least joint motion. The motion
of each joint is measured relative to the joint's range. This joint path has a corner wherever a joint arrives
at its limit or leaves it. The joint path is therefore smoothed and put back onto the poses, alternately, so
that a joint slows down before its limit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from yarclang.progress import go_on
from yarclang.robot.kinematics.pulling import EXACT, Pull
from yarclang.robot.kinematics.redundant import weights
from yarclang.robot.kinematics.strands import Strand
from yarclang.robot.model import Array, Chain, Limits

PLACES = 129
"""Number of places along the path at which joint positions are computed."""

FARTHEST, SHARPEST = 0.15, 0.02
"""Largest motion of a joint from one place to the next, and largest change of this motion from one place to
the next [rad or m].
"""

ROOM = 2e-3
"""Distance that joints keep from their limits [rad or m], unless the start is nearer to them. It leaves room
for the overshoot of a curve through the joint positions at the places.
"""

ROUNDS = 12
"""The largest number of smoothing rounds."""

PASSES = 30
"""Number of smoothing passes in one round. In each pass, the joint position at every place moves halfway to
the mean of its two neighbours.
"""

STEPS = 6
"""Number of iteration steps that put the joint positions back onto their poses."""


def kept_within(
    chain: Chain, limits: Limits, paths: Sequence[Callable[[Array], Array]], starts: Array
) -> list[Strand | None]:
    """Follow several paths within limits. Return one entry for each path: joint positions that follow it from
    its start, or None if none are found.

    Args:
        chain: an arm with more than six joints.
        limits: its limits.
        paths: for each path, a function that returns the poses base_from_flange (N, 4, 4) at path parameters
            (N,), from 0 to 1.
        starts: (K, n) [rad or m], each at the start of its path and within limits.
    """
    s = np.linspace(0.0, 1.0, PLACES)
    poses = np.array([pose_at(s) for pose_at in paths])
    kept = _Kept(chain, limits, starts)
    strands: list[Strand | None] = [None] * len(paths)
    for row, way in kept.stepped(poses).items():
        smooth = kept.smoothed(row, poses[row], way)
        if smooth is not None:
            strands[row] = Strand(s, smooth, "whole", smooth[-1])
    return strands


class _Kept:
    """Limits (K, n) for joint paths that start at `starts` (K, n): the arm's limits, narrowed by `ROOM` and
    widened to include the starts.
    """

    __slots__ = ("chain", "lower", "scale", "starts", "upper")

    def __init__(self, chain: Chain, limits: Limits, starts: Array) -> None:
        self.chain, self.starts = chain, starts
        self.lower = np.minimum(limits.lower + ROOM, starts)
        self.upper = np.maximum(limits.upper - ROOM, starts)
        scale = weights(chain, limits)
        self.scale = scale / scale.max()

    def stepped(self, poses: Array) -> dict[int, Array]:
        """Return joint paths (PLACES, n) of least motion through the poses (K, PLACES, 4, 4) of K paths, by
        the index of the path. Paths that can't be followed are left out.
        """
        ways = np.repeat(self.starts[:, None], PLACES, axis=1)
        rows = np.arange(len(ways))
        for place in range(1, PLACES):
            go_on()
            before = ways[rows, place - 1]
            # with the previous joint positions as reference, the step to the next pose is the shortest
            # possible
            pull = Pull(
                self.chain, self.lower[rows], self.upper[rows], poses[rows, place], before, self.scale
            )
            q, miss = pull.put_back(before, STEPS)
            ways[rows, place] = q
            rows = rows[(miss < EXACT) & (np.abs(q - before).max(axis=1) < FARTHEST)]
            if not len(rows):
                break
        return {row: ways[row] for row in rows.tolist()}

    def smoothed(self, row: int, poses: Array, way: Array) -> Array | None:
        """Return the joint path `way` (PLACES, n) after its corners were smoothed. It passes through the
        poses (PLACES, 4, 4). Return None if corners remain.
        """
        for _ in range(ROUNDS):
            if _is_smooth(way):
                return way
            go_on()
            target = way.copy()
            for _ in range(PASSES):
                # a binomial filter (1, 2, 1) / 4 along the path; start and end stay fixed
                target[1:-1] += 0.25 * (target[:-2] - 2.0 * target[1:-1] + target[2:])
            pull = Pull(self.chain, self.lower[row], self.upper[row], poses[1:], target[1:], self.scale)
            back, miss = pull.put_back(target[1:], STEPS)
            if miss.max() > EXACT:
                return None
            way = np.vstack((way[:1], back))
        return way if _is_smooth(way) else None


def _is_smooth(q: Array) -> bool:
    moves = np.diff(q, axis=0)
    return bool(np.abs(moves).max() < FARTHEST and np.abs(np.diff(moves, axis=0)).max() < SHARPEST)
