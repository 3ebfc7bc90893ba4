"""Search for the place on a planned path at which a robot rests, to find the command that was being executed.
The robot may have moved on since it last reported its progress.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.hir import Gap
from yarclang.motion.plan import MotionPlan
from yarclang.robot.model import Array
from yarclang.runtime.job import Job, JobCommand

_STEP = 4e-3
"""Step between the times at which the path is compared with the robot's position first [s]."""

_FINER = 64
_ROUNDS = 2

_ON_PATH = 5e-3
"""Largest distance between a robot and its planned path at which the robot counts as resting on the path, in
axis units [deg or mm]. The robot follows a controller text with rounded numbers.
"""

_AS_NEAR = 1e-4
"""Largest difference of two distances from the robot that count as equal [deg or mm]."""

_EARLIER = 2.0
"""Largest time by which a report may be ahead of the robot [segments]."""


@dataclass(frozen=True, slots=True)
class Resting:
    """The place on a planned path at which a robot rests: the command, and the progress of the program
    there [s].
    """

    command: JobCommand
    done: float


def resting_place(plan: MotionPlan, program: Job, joints: Array, progress: float) -> Resting | None:
    """Find the place on a planned path at which a robot rests: at or after the place of its last report.

    Args:
        plan: plan of the program.
        program: job of the whole program.
        joints: (n,) position of the robot [rad or m].
        progress: progress of the program at the last report [s].

    Returns:
        The command and the progress of the program at this place. None if the robot isn't on the part of the
        path that it can have reached since.
    """
    command = program.command_at(progress)
    if command is None or len(program.commands) != len(plan.motions):
        return None
    number = program.commands.index(command)
    since = float(plan.begins[number]) + min(
        max(progress - command.begins, 0.0), command.ends - command.begins
    )
    segment = max((motion.curve.segment for motion in plan.motions), default=program.segment)
    first = max(0.0, since - _EARLIER * segment)
    stands = sum(seconds for _, seconds in program.dwells)
    last = min(plan.duration, since + (program.capacity + _EARLIER) * segment + stands)
    times = np.linspace(first, last, max(3, int((last - first) / _STEP)))
    off = np.pad(_off(plan, times, joints), 1, constant_values=np.inf)
    places: list[tuple[float, float]] = []
    for near in np.flatnonzero((off[1:-1] <= off[:-2]) & (off[1:-1] <= off[2:])):
        time, step = float(times[near]), float(times[1] - times[0])
        for _ in range(_ROUNDS):
            tried = np.clip(np.linspace(time - step, time + step, _FINER), first, last)
            distances = _off(plan, tried, joints)
            time, step = float(tried[np.argmin(distances)]), 2.0 * step / _FINER
        places.append((float(distances.min()), time))
    best = min(places)[0]
    if best > _ON_PATH:
        return None
    # The path may pass the same place several times. The first of these times counts.
    time = min(one for distance, one in places if distance < best + _AS_NEAR)
    at = min(int(np.searchsorted(plan.begins, time, side="right")), len(plan.motions)) - 1
    there = program.commands[at]
    return Resting(there, there.begins + time - float(plan.begins[at]))


def motion_before(plan: MotionPlan, place: str) -> str:
    """Return the index of the last motion before a command that isn't a motion, such as a WAIT; empty if
    there is no such motion.
    """
    places = {
        number: step.origin.label
        for number, step in enumerate(plan.program.steps)
        if not isinstance(step, Gap)
    }
    at = next((number for number, name in places.items() if name == place), 0)
    return next((places[one.step] for one in reversed(plan.motions) if one.step < at), "")


def _off(plan: MotionPlan, times: Array, joints: Array) -> Array:
    """Compute the distance between a planned path and a position: the largest difference of a joint [deg or
    mm].

    Args:
        plan: the plan.
        times: (M,) times of the plan [s].
        joints: (n,) the position [rad or m].

    Returns:
        The distance at each of the times (M,).
    """
    distances: Array = (np.abs(plan.sample(times)[0] - joints) / plan.robot.axis_units).max(axis=1)
    return distances
