"""Limits that a program lowers for a motion: percentages (`[50%]`) and `ACC`."""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.certificate import Quantity
from yarclang.certify.kinematics.motors import counts_per_joint
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.limits import Excess, excess_of
from yarclang.certify.read.layout import Layout, Place
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot

ROUNDED = MappingProxyType({"velocity": 2e-4, "motor_velocity": 2e-4, "acceleration": 1e-3, "jerk": 1e-2})
"""Accepted excess over a lowered limit, as a fraction of the robot's limit, since the numbers in a text are
rounded. docs/language.md states these fractions.
"""
BESIDE = 2
"""Number of segments on either side of a blend in which the larger percentage of both motions applies too.

A segment depends on four control points. Near a corner, some of them belong to the other motion.
"""


@frozen(eq=False)
class Lowered:
    """Fractions of the robot's limits that the program allows in each of N segments.

    Attributes:
        speed: (N,) fraction of the limits of velocities and motor speeds.
        ramp: (N,) fraction of the limits of acceleration and jerk.
        jerk: (N,) True if the jerk is limited: neither the segment's motion nor its blend is without a limit.
    """

    speed: Array
    ramp: Array
    jerk: NDArray[np.bool_]


def find_lowered(layout: Layout) -> Lowered | None:
    """Return the fractions of the limits that the program allows; None if it lowers no limit."""
    moving = [place for place in layout.places if place.size]
    if all(place.motion.timing.share == place.motion.timing.ramp == 1.0 for place in moving):
        return None
    speed, ramp = np.ones(len(layout.at)), np.ones(len(layout.at))
    jerk = np.ones(len(layout.at), dtype=np.bool_)
    allowed = [_allowed(place) for place in moving]
    for place, (one_speed, one_ramp) in zip(moving, allowed, strict=True):
        speed[place.first : place.last], ramp[place.first : place.last] = one_speed, one_ramp
        if place.any_jerk:
            jerk[place.first : place.last] = False
    # In a blend the larger fraction of both motions applies.
    for number in range(1, len(moving)):
        one, other = moving[number - 1], moving[number]
        if other.before is None:
            continue
        blend = _around(one, other, other.before // 2)
        fastest, steepest = (max(pair) for pair in zip(*allowed[number - 1 : number + 1], strict=True))
        speed[blend], ramp[blend] = np.maximum(speed[blend], fastest), np.maximum(ramp[blend], steepest)
        if one.any_jerk or other.any_jerk:
            jerk[blend] = False
    return Lowered(speed, ramp, jerk)


def _allowed(place: Place) -> tuple[float, float]:
    timing = place.motion.timing
    return timing.share, timing.share * timing.ramp


def _around(one: Place, other: Place, half: int) -> slice:
    """Return the segments of a blend and `BESIDE` segments on either side, without those beyond a rest."""
    begin, stop = one.last - half - BESIDE, other.first + half + BESIDE
    if one.before is None:
        begin = max(begin, one.first)
    if other.behind is None:
        stop = min(stop, other.last)
    return slice(max(begin, 0), stop)


def above_lowered(
    layout: Layout, places: list[Place], cubics: Cubics, robot: Robot, lowered: Lowered
) -> Iterator[tuple[Place, Excess]]:
    """Yield, for each command and quantity, the largest excess over a limit that the program lowers.

    Args:
        layout: the segments of the controller text.
        places: consecutive commands, each with segments.
        cubics: all segments of these commands.
        robot: defines the limits.
        lowered: the fractions of the limits that the program allows in each segment of the layout.
    """
    base = places[0].first
    rows = slice(base, places[-1].last)
    speed, ramp, jerk = lowered.speed[rows], lowered.ramp[rows], lowered.jerk[rows]
    if min(speed.min(), ramp.min()) == 1.0:
        return
    limits = robot.limits
    motors = cubics.mapped(counts_per_joint(robot)).velocity_peaks()
    shares: dict[Quantity, tuple[Array, Array]] = {
        "velocity": (cubics.velocity_peaks() / limits.velocity, speed),
        "motor_velocity": (motors / robot.actuation.velocity, speed),
        "acceleration": (cubics.acceleration_peaks() / limits.acceleration, ramp),
        "jerk": (cubics.jerk_peaks() / limits.jerk, np.where(jerk, ramp, 1.0)),
    }
    for quantity, (share, allowed) in shares.items():
        above = (share > (allowed + ROUNDED[quantity])[:, None]) & (allowed < 1.0)[:, None]
        if not above.any():
            continue
        for place in places:
            own = slice(place.first - base, place.last - base)
            if above[own].any():
                # Report the largest share among those that exceed their fraction.
                most = np.where(above[own], share[own], 0.0)
                row = int(np.argmax(most.max(axis=1)))
                joints = np.asarray(above[own].any(axis=0))
                excess = excess_of(quantity, joints, most, robot, float(layout.time[place.first]))
                yield place, excess.with_allowed(float(allowed[own][row]))
