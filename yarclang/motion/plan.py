"""The motion plan: what the robot does, as a function of time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array, Program
from yarclang.motion.curve import Curve
from yarclang.motion.path import Path
from yarclang.motion.profile import load_profile
from yarclang.robot.model import Robot


@frozen(eq=False)
class PlannedMotion:
    """One motion: step number `step` of the program.

    `waypoints` (k, n) [rad or m] are the joint positions that were chosen for its way-points, without the start.
    `curve` goes from rest to rest, or, where it flows into its neighbours, from the middle of one overlap to that of the
    next; `overlap` are the segments of the one at its end, 0 where it ends at rest. `law` are the control values of the share of the
    way over its own time from rest to rest, half an overlap longer at either side. `kept` is the share of a speed asked for that is reached.
    """

    step: int
    path: Path
    profile: str
    curve: Curve
    waypoints: Array
    law: Array
    overlap: int = 0
    kept: float = 1.0


@dataclass(frozen=True)
class MotionPlan:
    """All motions of a program, one after the other, each of them a curve that the controller can execute exactly."""

    program: Program
    robot: Robot
    motions: tuple[PlannedMotion, ...]

    @cached_property
    def starts(self) -> Array:
        """The time [s] at which each motion begins, and that at which the last one ends (m + 1,)."""
        return np.concatenate(([0.0], np.cumsum([motion.curve.duration for motion in self.motions])))

    @cached_property
    def any_jerk(self) -> frozenset[int]:
        """The steps of the motions whose law has no limit of the jerk."""
        return frozenset(
            motion.step for motion in self.motions if not load_profile(motion.profile).has_jerk_limit
        )

    @property
    def duration(self) -> float:
        """The time that all motions take [s]."""
        return float(self.starts[-1])

    def sample(self, times: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration of the joints, each (N, n), at `times` (N,) [s], in SI."""
        q = np.tile(self.program.start, (len(times), 1))
        v, a = np.zeros_like(q), np.zeros_like(q)
        if not self.motions:
            return q, v, a
        number = np.searchsorted(self.starts, times, side="right") - 1
        number = np.clip(number, 0, len(self.motions) - 1)
        order = np.argsort(number, kind="stable")
        asked, first = np.unique(number[order], return_index=True)
        for motion, here in zip(asked, np.split(order, first[1:]), strict=True):
            q[here], v[here], a[here] = self.motions[motion].curve.sample(times[here] - self.starts[motion])
        return q, v, a
