"""Compute the shortest segment times with which the control points of a curve keep the limits of joints and
motors.
"""

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

# Shares of the limits that are held in reserve, since control points are printed with finitely many decimals.
# The backend chooses the decimals so that these reserves suffice.
HEADROOM: dict[LimitKind, float] = {
    "velocity": 2e-4,
    "motor speed": 2e-4,
    "acceleration": 1e-3,
    "jerk": 1e-2,
    "zone speed": ZONE_HEADROOM,
}


@frozen
class Demand:
    """The shortest segment time with which control points keep one limit, and the place that determines it.

    `segment` [s] is this time. `row` is the index of the joint, or of the motor for `motor speed`. `at` is
    the first control point of the largest difference. For a `zone speed`, `watch` is the watched item of the
    slow zone, and `row` is meaningless.
    """

    kind: LimitKind
    segment: float
    row: int
    at: int
    watch: Watch | None = None


@frozen(eq=False)
class Bounds:
    """The limits of a robot's joints and motors, reduced by the headroom, and the slow zones of its cell.

    Joint limits (n,) are in rad (m) per s, s^2, s^3. `motor_velocity` (n,) is in counts/s, and `counts` (n,
    n) are the motors' counts per rad (m). The speed limits of `zones` are never reduced.
    """

    velocity: Array
    acceleration: Array
    jerk: Array
    counts: Array
    motor_velocity: Array
    zones: SlowZones | None = None

    @property
    def key(self) -> Hashable:
        """A hashable key that contains the values of all limits."""
        arrays = (self.velocity, self.acceleration, self.jerk, self.motor_velocity)
        return *(one.tobytes() for one in arrays), None if self.zones is None else self.zones.key

    def reduced(self, share: float, ramp: float) -> Bounds:
        """Return the limits multiplied by `share`; the limits of acceleration and jerk are also multiplied
        by `ramp`.
        """
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
        """Return the same limits without the limit on jerk."""
        return replace(self, jerk=np.full_like(self.jerk, np.inf))

    def demands(self, points: Array) -> tuple[Demand, ...]:
        """Return, for each kind of limit, the shortest segment time with which control points (N, n) keep the
        limit, by the convex hull property.

        The last item is for slow zones. It is included only if the zones need longer segments than all other
        limits.
        """
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
        """Return True if the curve of control points (N, n) keeps all limits with a segment time [s]."""
        rest = replace(self, zones=None)
        if max(demand.segment for demand in rest.demands(points)) > segment:
            return False
        return self.zones is None or not any(self.zones.asked(points, segment, stops=True))


def _demand(kind: LimitKind, differences: Array, limit: Array, order: int) -> Demand:
    shares = np.abs(differences) / limit
    at, row = divmod(int(np.argmax(shares)), shares.shape[1])
    # Of joints whose shares differ only by rounding, name the first, so that all processors name the same
    # joint.
    row = int(np.argmax(shares[at] >= shares[at, row] * (1.0 - 1e-9)))
    # The derivative is a difference of order k, divided by h^k. The least h is therefore the k-th root of
    # difference over limit.
    return Demand(kind, float(shares[at].max() ** (1.0 / order)), row, at)


def bounds_of(robot: Robot) -> Bounds:
    """Return the limits that a plan for this robot has to keep."""
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
    """The segment times that the controller accepts [s]: from `smallest` to `largest` in steps of
    `quantum`.
    """

    smallest: float
    largest: float
    quantum: float

    def fewest(self, duration: float) -> int:
        """Return the fewest segments for a motion of `duration` [s] with which no segment is longer than
        `largest`.
        """
        return max(FEWEST_SEGMENTS, int(np.ceil(duration / self.largest - 1e-9)))

    def nearest(self, segment: float) -> float:
        """Return the nearest segment time that the controller can represent [s]."""
        return round(segment / self.quantum) * self.quantum

    def not_below(self, segment: float) -> float:
        """Return the shortest segment time [s] that the controller accepts and that is at least `segment`
        [s].
        """
        steps = np.ceil(max(segment, self.smallest) / self.quantum - 1e-6)
        return float(steps * self.quantum)
