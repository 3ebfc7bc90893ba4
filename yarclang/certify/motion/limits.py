"""Limits at every instant: position, velocity, acceleration and jerk of joints, speed of motors.

The jerk is constant on a segment, so the extremes of each quantity are known in closed form; nothing is
sampled.
"""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.certificate import QUANTITIES, Loads, Peaks, Quantity
from yarclang.certify.kinematics.motors import counts_per_joint
from yarclang.certify.motion.bounds import Cubics, segment_max
from yarclang.certify.read.layout import Layout, Place
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot

RELATIVE = 1e-9
"""Excess over a limit that is accepted as rounding, as a fraction of the limit."""
POSITION_UNITS = 1e-9
"""Excess over a position limit that is accepted as rounding, in axis units (deg or mm)."""


@frozen
class Excess:
    """The largest excess of one command over one limit.

    Attributes:
        quantity: the limited quantity.
        name: name of the joint or motor.
        text: the excess in words.
        time: start of the worst segment, after the start of the command [s].
    """

    quantity: Quantity
    name: str
    text: str
    time: float

    def with_allowed(self, fraction: float) -> Excess:
        """Return this excess with a text that adds the fraction of the limit that the program allows."""
        return replace(self, text=f"{self.text}; the program allows {100.0 * fraction:.6g}% of it")


NO_LOADS = Loads(None, 0)


def check_limits(
    layout: Layout, places: list[Place], cubics: Cubics, robot: Robot
) -> list[tuple[Loads, tuple[Excess, ...]]]:
    """Return for each command its loads, as fractions of the limits, and the limits that it exceeds.

    Args:
        layout: the segments of the controller text.
        places: consecutive commands, each with segments.
        cubics: all segments of these commands.
        robot: defines the limits.
    """
    limits = robot.limits
    base = places[0].first
    first = np.array([place.first - base for place in places])
    speed = cubics.velocity_peaks()
    acceleration = cubics.acceleration_peaks()
    # Motor positions are linear in joint positions, so they are cubics as well.
    motors = cubics.mapped(counts_per_joint(robot)).velocity_peaks()
    lower, upper = cubics.position_range()
    with np.errstate(invalid="ignore"):  # a joint without limits gives infinity minus infinity
        middle, half = (limits.upper + limits.lower) / 2.0, (limits.upper - limits.lower) / 2.0
        # The used fraction of a position's limit is the distance from the middle of the range, relative to
        # half of the range.
        off = np.maximum(upper - middle, middle - lower)
        position = np.where(np.isfinite(half), off / half, 0.0)
    shares: dict[Quantity, Array] = {
        "position": position,
        "velocity": speed / limits.velocity,
        "acceleration": acceleration / limits.acceleration,
        "jerk": cubics.jerk_peaks() / limits.jerk,
        "motor_velocity": motors / robot.actuation.velocity,
    }
    # The quotient is rounded once: the next larger number is an upper bound.
    shares = {
        quantity: np.where(share > 0.0, np.nextafter(share, np.inf), 0.0)
        for quantity, share in shares.items()
    }
    # A hold stops the motion on its path within the hold time: it adds |v| / hold time to |a|.
    hold = (acceleration + speed / robot.controller.hold_time) / limits.stop_acceleration
    past = np.maximum(upper - limits.upper, limits.lower - lower) / robot.axis_units
    peaks = {quantity: segment_max(share, first) for quantity, share in shares.items()}
    holds, pasts = segment_max(hold, first), segment_max(past, first)

    broken = {quantity: peak > 1.0 + RELATIVE for quantity, peak in peaks.items()}
    broken["position"] = pasts > POSITION_UNITS
    measures = {**shares, "position": past}
    excesses: dict[int, tuple[Excess, ...]] = {}
    for row in np.flatnonzero(np.any([joints.any(axis=1) for joints in broken.values()], axis=0)).tolist():
        place = places[row]
        rows = slice(place.first - base, place.last - base)
        excesses[row] = tuple(
            excess_of(quantity, joints[row], measures[quantity][rows], robot, float(layout.time[place.first]))
            for quantity, joints in broken.items()
            if joints[row].any()
        )
    told = _largest({**peaks, "hold": holds}, robot)
    return [(Loads(told, row), excesses.get(row, ())) for row in range(len(places))]


def _names(quantity: Quantity, robot: Robot) -> tuple[str, ...]:
    if quantity == "motor_velocity":
        return tuple(f"motor {motor}" for motor in robot.controller.motors)
    return robot.joint_names


def _largest(shares: Mapping[Quantity, Array], robot: Robot) -> Peaks:
    """Return, for each command and quantity, the largest used fraction of a limit and its joint or motor.
    `shares` has arrays (N, n) for N commands and n joints or motors.
    """
    all_shares = np.array([shares[quantity] for quantity in QUANTITIES])
    joints = np.argmax(all_shares, axis=2)
    most = np.take_along_axis(all_shares, joints[:, :, None], axis=2)[:, :, 0]
    names = tuple(_names(quantity, robot) for quantity in QUANTITIES)
    return Peaks(names, array("h", joints.T.ravel().tolist()), array("d", most.T.ravel().tolist()))


def excess_of(
    quantity: Quantity, joints: NDArray[np.bool_], measure: Array, robot: Robot, segment_time: float
) -> Excess:
    """Return the joint or motor, the segment and the amount of the largest excess over a limit.

    Args:
        quantity: the limited quantity.
        joints: (n,) True for joints or motors that break the limit.
        measure: (segments, n) used fractions of the limit; for positions, axis units beyond the limit.
        robot: defines the limits.
        segment_time: duration of a segment [s].
    """
    segment, joint = np.unravel_index(int(np.argmax(np.where(joints, measure, -np.inf))), measure.shape)
    worst = float(measure[segment, joint])
    unit = robot.axis_unit_names[joint]
    if quantity == "position":
        text = f"exceeds its limit by {worst:.6g} {unit}"
    else:
        if quantity == "motor_velocity":
            limit, unit = float(robot.actuation.velocity[joint]), "counts/s"
        else:
            limit = float(getattr(robot.limits, quantity)[joint] / robot.axis_units[joint])
            unit += {"velocity": "/s", "acceleration": "/s2", "jerk": "/s3"}[quantity]
        word = "velocity" if quantity == "motor_velocity" else quantity
        text = (
            f"has a peak {word} of {worst * limit:.6g} {unit}, {worst:.2%} of its limit of {limit:.6g} {unit}"
        )
    return Excess(quantity, _names(quantity, robot)[joint], text, int(segment) * segment_time)
