"""Search for the place on a planned path at which a robot rests. This place shows which command was being
executed. The robot's last report of its progress doesn't, because the robot may have moved on since.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.hir import Gap
from yarclang.motion.plan import MotionPlan
from yarclang.robot.model import Array
from yarclang.runtime.job import Job, JobCommand

_STEP = 4e-3
"""Interval of the times at which the path is first compared with the robot's position [s]. Around the best of
these times, the search continues with smaller intervals.
"""

_FINER = 64
_ROUNDS = 2

_ON_PATH = 5e-3
"""Largest distance between a robot and its planned path at which the robot counts as being on the path [deg
or mm]. It isn't zero, because the numbers in a controller text are rounded.
"""

_AS_NEAR = 1e-4
"""Largest difference of two distances from the robot that count as equal [deg or mm]."""

_EARLIER = 2.0
"""Largest time by which the reported progress may be ahead of the robot [segment times]."""


@dataclass(frozen=True, slots=True)
class Resting:
    """The place on a planned path at which a robot rests: the command, and the progress of the program at
    this place [s].
    """

    command: JobCommand
    done: float


def resting_place(plan: MotionPlan, program: Job, joints: Array, progress: float) -> Resting | None:
    """Find the place on a planned path at which a robot rests. This place isn't before that of the last
    report.

    Args:
        plan: plan of the program.
        program: job of the whole program.
        joints: (n,) position of the robot [rad or m].
        progress: progress of the program at the last report [s].

    Returns:
        The command and the progress of the program at this place. None if the robot isn't on the part of the
        path that it can have reached since the last report.
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
    # The path may pass the same place several times. The earliest time counts.
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
    """Compute the distance between a position and the points of a planned path, as the largest difference of
    a joint [deg or mm].

    Args:
        plan: the plan.
        times: (M,) times of the plan [s].
        joints: (n,) the position [rad or m].

    Returns:
        The distance from the path's point at each of the times (M,).
    """
    distances: Array = (np.abs(plan.sample(times)[0] - joints) / plan.robot.axis_units).max(axis=1)
    return distances
