"""Where on its path a robot rests: which command was running, also where the last that was heard of it is old."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.hir import Gap
from yarclang.motion.plan import MotionPlan
from yarclang.robot.model import Array
from yarclang.runtime.job import Job, JobCommand

_STEP = 4e-3
"""Of the first search [s]."""

_FINER = 64
_ROUNDS = 2

_ON_PATH = 5e-3
"""How far from the path, in axis units [deg or mm], a robot at rest on it may be: its text has rounded numbers."""

_AS_NEAR = 1e-4
"""Places whose distances differ by less are equally near [deg or mm]."""

_EARLIER = 2.0
"""How far what was heard may be ahead of the robot [segments]."""


@dataclass(frozen=True, slots=True)
class Resting:
    """In which command of a program, and how far into the program [s]."""

    command: JobCommand
    done: float


def resting_place(plan: MotionPlan, program: Job, joints: Array, done: float) -> Resting | None:
    """Find a robot on its path, where it was heard of last or behind.

    Args:
        plan: of the program.
        program: the whole of it.
        joints: (n,) where the robot stands [rad or m].
        done: how far the program was when that was heard [s].

    Returns:
        None where it isn't on the part of the path that it can have reached.
    """
    command = program.command_at(done)
    if command is None or len(program.commands) != len(plan.motions):
        return None
    number = program.commands.index(command)
    since = float(plan.begins[number]) + min(max(done - command.begins, 0.0), command.ends - command.begins)
    segment = max((motion.curve.segment for motion in plan.motions), default=program.segment)
    first = max(0.0, since - _EARLIER * segment)
    stands = sum(seconds for _, seconds in program.dwells)
    last = min(plan.duration, since + (program.capacity + _EARLIER) * segment + stands)
    times = np.linspace(first, last, max(3, int((last - first) / _STEP)))
    off = np.pad(_off(plan, times, joints), 1, constant_values=np.inf)
    found: list[tuple[float, float]] = []
    for near in np.flatnonzero((off[1:-1] <= off[:-2]) & (off[1:-1] <= off[2:])):
        time, step = float(times[near]), float(times[1] - times[0])
        for _ in range(_ROUNDS):
            tried = np.clip(np.linspace(time - step, time + step, _FINER), first, last)
            distances = _off(plan, tried, joints)
            time, step = float(tried[np.argmin(distances)]), 2.0 * step / _FINER
        found.append((float(distances.min()), time))
    best = min(found)[0]
    if best > _ON_PATH:
        return None
    # a path may come by twice: the first time counts
    time = min(one for distance, one in found if distance < best + _AS_NEAR)
    at = min(int(np.searchsorted(plan.begins, time, side="right")), len(plan.motions)) - 1
    there = program.commands[at]
    return Resting(there, there.begins + time - float(plan.begins[at]))


def motion_before(plan: MotionPlan, place: str) -> str:
    """The place of the last motion in front of a step at a place, such as a WAIT; empty where there is none."""
    places = {
        number: step.origin.label
        for number, step in enumerate(plan.program.steps)
        if not isinstance(step, Gap)
    }
    at = next((number for number, name in places.items() if name == place), 0)
    return next((places[one.step] for one in reversed(plan.motions) if one.step < at), "")


def _off(plan: MotionPlan, times: Array, joints: Array) -> Array:
    """How far from joints (n,) [rad or m] a plan is at times (M,): its worst joint [deg or mm]."""
    distances: Array = (np.abs(plan.sample(times)[0] - joints) / plan.robot.axis_units).max(axis=1)
    return distances
