"""Limits of joints and motors, against the control points of a curve."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from typing import Literal

import numpy as np

from yarclang.collision.zones.workspace import Watch
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.curve import FEWEST_SEGMENTS
from yarclang.motion.zones import HEADROOM as ZONE_HEADROOM
from yarclang.motion.zones import SlowZones
from yarclang.robot.actuation import counts_per_joint
from yarclang.robot.model import Robot

LimitKind = Literal["velocity", "motor speed", "acceleration", "jerk", "zone speed"]

# What printing the control points with finitely many decimals may add, as shares of the limits:
# the backend chooses the decimals so that this is enough.
HEADROOM: dict[LimitKind, float] = {
    "velocity": 2e-4,
    "motor speed": 2e-4,
    "acceleration": 1e-3,
    "jerk": 1e-2,
    "zone speed": ZONE_HEADROOM,
}


@frozen
class Demand:
    """What a limit asks of the segment time: `segment` [s] is the least at which control points keep it.

    `row` is the joint, or the motor for `motor speed`; `at` is the first control point of the
    difference that asks most. A `zone speed` has what is watched in the slow zone, `watch`, and no row.
    """

    kind: LimitKind
    segment: float
    row: int
    at: int
    watch: Watch | None = None


@frozen(eq=False)
class Bounds:
    """The limits of a robot, less the headroom.

    Joint limits (n,) in rad (m) per s, s^2, s^3; `motor_velocity` (n,) in counts/s, for the motors
    of `counts` (n, n) counts per rad (m). `zones` are the slow zones of the cell, whose speeds are never reduced.
    """

    velocity: Array
    acceleration: Array
    jerk: Array
    counts: Array
    motor_velocity: Array
    zones: SlowZones | None = None

    @property
    def key(self) -> Hashable:
        """All of it, by value."""
        arrays = (self.velocity, self.acceleration, self.jerk, self.motor_velocity)
        return *(one.tobytes() for one in arrays), None if self.zones is None else self.zones.key

    def reduced(self, share: float, ramp: float) -> Bounds:
        """A share of all limits, and a further one of acceleration and jerk."""
        if share == ramp == 1.0:
            return self
        return Bounds(
            self.velocity * share,
            self.acceleration * (share * ramp),
            self.jerk * (share * ramp),
            self.counts,
            self.motor_velocity * share,
            self.zones,
        )

    def without_jerk(self) -> Bounds:
        """The same with no limit of jerk."""
        return replace(self, jerk=np.full_like(self.jerk, np.inf))

    def demands(self, points: Array) -> tuple[Demand, ...]:
        """What each kind of limit asks for control points (N, n), by the convex hull property; slow zones are the last, and only where they ask most."""
        first = np.diff(points, axis=0)
        second = np.diff(first, axis=0)
        third = np.diff(second, axis=0)
        demands = (
            _demand("velocity", first, self.velocity, 1),
            _demand("motor speed", first @ self.counts.T, self.motor_velocity, 1),
            _demand("acceleration", second, self.acceleration, 2),
            _demand("jerk", third, self.jerk, 3),
        )
        if self.zones is None:
            return demands
        most = max(demand.segment for demand in demands)
        asked = max(self.zones.asked(points, most), key=lambda one: one[0], default=None)
        if asked is None:
            return demands
        segment, at, watch = asked
        return (*demands, Demand("zone speed", segment, 0, at, watch))

    def are_kept(self, points: Array, segment: float) -> bool:
        """Whether control points (N, n) keep all limits at a segment time [s]."""
        rest = replace(self, zones=None)
        if max(demand.segment for demand in rest.demands(points)) > segment:
            return False
        return self.zones is None or not any(self.zones.asked(points, segment, stops=True))


def _demand(kind: LimitKind, differences: Array, limit: Array, order: int) -> Demand:
    shares = np.abs(differences) / limit
    at, row = divmod(int(np.argmax(shares)), shares.shape[1])
    return Demand(kind, float(shares[at, row] ** (1.0 / order)), row, at)


def bounds_of(robot: Robot) -> Bounds:
    """The limits that a plan for this robot has to keep."""
    limits = robot.limits
    return Bounds(
        velocity=limits.velocity * (1.0 - HEADROOM["velocity"]),
        acceleration=limits.acceleration * (1.0 - HEADROOM["acceleration"]),
        jerk=limits.jerk * (1.0 - HEADROOM["jerk"]),
        counts=counts_per_joint(robot),
        motor_velocity=robot.actuation.velocity * (1.0 - HEADROOM["motor speed"]),
    )


@frozen
class Grid:
    """The segment times that the controller takes [s]: from `smallest` to `largest` in steps of `quantum`."""

    smallest: float
    largest: float
    quantum: float

    def fewest(self, duration: float) -> int:
        """The fewest segments, none longer than the largest, of a motion of `duration` [s]."""
        return max(FEWEST_SEGMENTS, int(np.ceil(duration / self.largest - 1e-9)))

    def nearest(self, segment: float) -> float:
        """The nearest segment time that the controller keeps [s]."""
        return round(segment / self.quantum) * self.quantum

    def not_below(self, segment: float) -> float:
        """The least segment time that the controller keeps and that isn't below `segment` or the smallest [s]."""
        steps = np.ceil(max(segment, self.smallest) / self.quantum - 1e-6)
        return float(steps * self.quantum)
