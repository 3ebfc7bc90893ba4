"""Chains of motions that flow into each other, planned by the tests. Where the laws of two motions overlap,
the displacements of both are added.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tests.certify.certify_bench import (
    FLANGE_FROM_TCP,
    Job,
    grid_law,
    industrial6,
    inverse,
    inverted,
    knots,
)
from tests.certify.certify_paths import joined
from yarclang import hir
from yarclang.robot.kinematics.fk import tool_poses


@dataclass
class Leg:
    """A motion: its primitive, its path as a function of s, which gives poses (k, 4, 4) or joints (k, n), and
    its law on a grid of segments.
    """

    motion: object
    path: Callable
    segments: int
    law: np.ndarray | None = None

    @property
    def control(self) -> np.ndarray:
        return grid_law(self.segments) if self.law is None else self.law


@dataclass
class Chain:
    """A planned chain: its control points (n + 3, axes), for each leg its first segment and the one after its
    last, and for each corner the number of segments in which the legs overlap.
    """

    control: np.ndarray
    spans: list[tuple[int, int]]
    overlaps: list[int]

    def sample(self, robot, first, last, per_segment=40, tool=FLANGE_FROM_TCP):
        """Sample the joints and poses of the segments `first` to `last` densely, without `last` itself."""
        f = self.control[first : last + 3]
        u = np.linspace(0, 1, per_segment + 1)[None, :, None]
        a, b, c, d = (f[i : len(f) - 3 + i, None, :] for i in range(4))
        x = (
            (1 - u) ** 3 * a
            + (3 * u**3 - 6 * u**2 + 4) * b
            + (-3 * u**3 + 3 * u**2 + 3 * u + 1) * c
            + u**3 * d
        ) / 6
        q = x.reshape(-1, f.shape[1])
        return q, tool_poses(robot.chain, q, tool)

    def overlap(self, corner):
        """Return the first segment of a blend, and the segment after its last one."""
        middle = self.spans[corner][1]
        return middle - self.overlaps[corner] // 2, middle + self.overlaps[corner] // 2

    def jobs(self, legs: Sequence[Leg], sets=()) -> list[Job]:
        """Return commands with their move lines. `sets` are (corner, step, line) of outputs that are set in
        the middle of a blend.
        """
        lines = self.control[3:-2]
        made = []
        for k, (leg, (first, last)) in enumerate(zip(legs, self.spans, strict=True)):
            end = k == len(legs) - 1
            points = lines[first : len(lines) if end else last]
            job = Job(leg.motion, points, "50", None if end else self.overlaps[k])
            for corner, step, line in sets:
                if corner == k - 1:
                    made.append(Job(step, None))
                    job.puts = (*job.puts, line)
            made.append(job)
        return made


def shares(legs, overlaps):
    """Return the share of each leg that is completed at each knot of the chain (legs, n + 1), and the legs'
    spans.
    """
    begins = np.cumsum([0, *(leg.segments - w for leg, w in zip(legs[:-1], overlaps, strict=True))])
    total = begins[-1] + legs[-1].segments
    done = np.zeros((len(legs), total + 1))
    for row, leg, begin in zip(done, legs, begins, strict=True):
        row[begin : begin + leg.segments + 1] = knots(leg.control)
        row[begin + leg.segments :] = 1.0
    halves = [0, *(w // 2 for w in overlaps), 0]
    spans = [
        (begin + halves[k], begin + leg.segments - halves[k + 1])
        for k, (leg, begin) in enumerate(zip(legs, begins, strict=True))
    ]
    return done, spans


def in_joints(legs, overlaps, start) -> Chain:
    """Return the chain of joint paths q(s) (k, n), whose displacements are added."""
    done, spans = shares(legs, overlaps)
    q = start + sum(leg.path(s) - leg.path(np.zeros(1)) for leg, s in zip(legs, done, strict=True))
    lines = inverted(q)
    return Chain(
        np.vstack([np.tile(start, (3, 1)), lines, np.tile(lines[-1], (2, 1))]), spans, list(overlaps)
    )


def of_poses(legs, overlaps, start) -> Chain:
    """Return the chain of paths of poses of {TCP}. The displacements of the legs are added, and their
    rotations multiplied, each from the corner where the leg begins.
    """
    done, spans = shares(legs, overlaps)
    first = legs[0].path(np.zeros(1))[0]
    points = np.tile(first[:3, 3], (done.shape[1], 1))
    turns = np.tile(first[:3, :3], (done.shape[1], 1, 1))
    for leg, s in zip(legs, done, strict=True):
        poses, begin = leg.path(s), leg.path(np.zeros(1))[0]
        points = points + poses[:, :3, 3] - begin[:3, 3]
        turns = poses[:, :3, :3] @ begin[:3, :3].T @ turns
    q = inverse(industrial6(), joined(points, turns), start)
    lines = inverted(q)
    return Chain(
        np.vstack([np.tile(start, (3, 1)), lines, np.tile(lines[-1], (2, 1))]), spans, list(overlaps)
    )


def exact_joints(legs, overlaps, start, ways) -> Chain:
    """Return the chain of straight joint motions, each by a row of `ways` (legs, n). The control points are
    added exactly.
    """
    _, spans = shares(legs, overlaps)
    total = spans[-1][1]
    control = np.tile(start, (total + 3, 1))
    begin = 0
    for leg, way, w in zip(legs, ways, [*overlaps, 0], strict=True):
        control[begin : begin + leg.segments + 3] += leg.control[:, None] * way
        control[begin + leg.segments + 3 :] += way
        begin += leg.segments - w
    return Chain(control, spans, list(overlaps))


def reading(length=None, angle=None) -> hir.Reading:
    return hir.Reading(length, angle)
