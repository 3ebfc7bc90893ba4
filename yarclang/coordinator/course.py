"""The motion of a loaded program along its longest branches, and the values that were proved for it. Users
can look at it before the start.

The program's file is read; nothing moves.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from yarclang.coordinator.describing import takes
from yarclang.coordinator.messages import courses, replies
from yarclang.coordinator.programs import Loaded
from yarclang.diagnostics import has_errors
from yarclang.hir import Array, Dwell, Else, EndLoop, EndWhen, Exit, Finish, Loop, When
from yarclang.motion.curve import Sampler
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.pipeline.sources import read_source
from yarclang.runtime.job import Job

_TEXT_ALONE = "only the controller text is known, not its program"


@dataclass(slots=True)
class _Way:
    """Steps of a program that are executed one after the other, and the sum of their known durations [s]."""

    steps: list[int] = field(default_factory=list)
    time: float = 0.0
    ends: bool = False
    """True if the program ends at the end of this sequence."""
    exits: bool = False
    """True if this sequence leaves a loop."""


def course_described(loaded: Loaded, samples: int) -> courses.ProgramCourse:
    """Return the motion of a program along its longest branches. This takes a while for a long program: call
    it in a thread.

    Args:
        loaded: the program. If it begins at a command, or is run command by command, only the commands that
            will be run are considered.
        samples: number of joint positions in the reply.
    """
    job, plan = loaded.rest, loaded.plan or loaded.text_plan
    proved = json.loads(job.certificate) if job.certificate else {}
    first = loaded.spans[0][0] if loaded.spans else 0
    motions = () if plan is None else plan.motions[first:]
    chosen = _chosen(plan, motions) if plan is not None else []
    return courses.ProgramCourse(
        course=_course(job, chosen, samples) if plan is not None else replies.Course(times=(), joints=()),
        commands=tuple(_commands(loaded, chosen, first)),
        takes=takes(job.lasting),
        nearest=_nearest(job, proved.get("commands", [])),
        path=replies.PathBound(
            position_mm=proved.get("deviation", {}).get("position_mm") or 0.0,
            angle_deg=proved.get("deviation", {}).get("angle_deg") or 0.0,
        ),
        peaks=_peaks(proved) if proved.get("commands") else None,
        left_out=len(motions) - len(chosen),
        unknown="" if plan is not None else _TEXT_ALONE,
        sha256=hashlib.sha256(job.source.encode()).hexdigest() if job.source else "",
        changed=_changed(plan, job.source),
    )


def _chosen(plan: MotionPlan, motions: tuple[PlannedMotion, ...]) -> list[tuple[int, PlannedMotion, float]]:
    """Return the motions on the longest branches, in order. For each: its number in `motions`, the motion,
    and the program's time at which it begins [s].
    """
    longest = longest_way(plan)
    clocks = plan.schedule.clocks
    return [(at, one, clocks[one.step]) for at, one in enumerate(motions) if one.step in longest]


def longest_way(plan: MotionPlan) -> set[int]:
    """Return the numbers of the steps on the longest way through a program: each WHEN takes its longer branch
    (the first one if both are equally long), and each loop makes one pass, up to an EXIT in this pass.
    """
    durations = {motion.step: motion.curve.duration for motion in plan.motions}
    way, opened, loops = _Way(), list[tuple[_Way, _Way | None]](), list[_Way]()
    for number, step in enumerate(plan.program.steps):
        match step:
            case When():
                opened.append((way, None))
                way = _Way()
            case Else() if opened:
                before, _ = opened.pop()
                opened.append((before, way))
                way = _Way()
            case EndWhen() if opened:
                way = _met(*opened.pop(), way)
            case Dwell(duration=duration):
                way.time += float(duration)
            case Finish():
                way.ends = True
            case Exit() if loops:
                # Skip the rest of the loop: the program continues after it.
                way.exits = True
            case Loop():
                loops.append(way)
                way = _Way()
            case EndLoop() if loops:
                before, way = loops.pop(), replace(way, exits=False)
                way = _Way([*before.steps, *way.steps], before.time + way.time, way.ends)
            case _ if way.exits:
                pass
            case _:
                way.steps.append(number)
                way.time += durations.get(number, 0.0)
    while opened:
        way = _met(*opened.pop(), way)
    return set(way.steps)


def _met(before: _Way, first: _Way | None, last: _Way) -> _Way:
    """Append the longer of a WHEN's two branches to the steps before the WHEN, and return all these steps.

    If only one of the branches ends the program, the other one is appended, even if it is shorter.
    """
    if before.exits:
        return before
    longer = last if first is None or last.time > first.time else first
    if first is not None and first.ends != last.ends:
        longer = last if first.ends else first
    elif first is None and last.ends:
        longer = _Way()
    if first is not None and first.exits != last.exits and not (first.ends or last.ends):
        longer = first if first.exits else last
    elif first is None and last.exits:
        longer = last
    return _Way([*before.steps, *longer.steps], before.time + longer.time, longer.ends, longer.exits)


def _course(job: Job, chosen: list[tuple[int, PlannedMotion, float]], samples: int) -> replies.Course:
    """Return the joint positions at `samples` evenly spaced times of the program. Before, between and after
    the motions the robot stands.
    """
    if job.lasting.most <= 0.0:
        return replies.Course(times=(), joints=())
    times = job.clock + np.linspace(0.0, job.lasting.most, samples)
    joints: Array = np.tile(job.start, (samples, 1))
    if chosen:
        clocks = np.array([clock for _, _, clock in chosen])
        number = np.searchsorted(clocks, times, side="right") - 1
        moved = number >= 0
        # After a motion, the robot stands at its end until the next motion begins.
        since = times[moved] - clocks[number[moved]]
        joints[moved] = Sampler([motion.curve for _, motion, _ in chosen]).sample(number[moved], since)[0]
    values = np.round(joints / job.robot.axis_units, 4) + 0.0
    return replies.Course(times=tuple(np.round(times, 4).tolist()), joints=tuple(map(tuple, values.tolist())))


def _commands(
    loaded: Loaded, chosen: list[tuple[int, PlannedMotion, float]], first: int
) -> Iterator[courses.CourseCommand]:
    named, units = loaded.program.commands[first:], loaded.program.robot.axis_units
    chosen = [one for one in chosen if one[0] < len(named)]
    if not chosen:
        return
    durations = np.array([motion.curve.duration for _, motion, _ in chosen])
    sampler = Sampler([motion.curve for _, motion, _ in chosen])
    ends = np.round(sampler.sample(np.arange(len(chosen)), durations)[0] / units, 6) + 0.0
    for (at, motion, clock), end in zip(chosen, ends.tolist(), strict=True):
        yield courses.CourseCommand(
            title=named[at].title,
            index=named[at].index,
            line=named[at].source_line,
            begins_s=round(clock, 4),
            ends_s=round(clock + motion.curve.duration, 4),
            end=tuple(end),
        )


def _nearest(job: Job, proved: list[dict[str, Any]]) -> courses.NearestProved | None:
    """Return the smallest proved distance between bodies in the whole program. Of two equal distances, one
    whose bodies are named is preferred to a bound for all bodies.
    """
    nearest: list[tuple[bool, float, courses.NearestProved]] = []
    for row, command in zip(proved, job.commands, strict=False):
        for clearance in (row.get("clearance"), row.get("own_clearance")):
            if clearance is None or clearance["at_least_mm"] is None:
                continue
            bodies, at = clearance["bodies"], clearance.get("at_s")
            near = courses.NearestProved(
                distance_mm=clearance["at_least_mm"],
                first=bodies[0] if bodies else "",
                second=bodies[1] if bodies else "",
                title=command.title,
                line=command.source_line,
                at_s=None if at is None else round(job.clock + command.clock + at, 4),
            )
            nearest.append((not bodies, near.distance_mm, near))
    return min(nearest, key=lambda row: (row[1], row[0]))[2] if nearest else None


def _peaks(proved: dict[str, Any]) -> replies.Peaks:
    loads = proved["loads"]

    def peak(kind: str) -> replies.Peak:
        return replies.Peak(name=loads[kind]["name"], share=loads[kind]["share"] or 0.0)

    judged = any(one["jerk_judged"] for one in proved["commands"])
    return replies.Peaks(
        velocity=peak("velocity"),
        acceleration=peak("acceleration"),
        jerk=peak("jerk") if judged else None,
        motor_velocity=peak("motor_velocity"),
    )


def _changed(plan: MotionPlan | None, proved: str) -> bool | None:
    """Return True if the program's file no longer contains the proved text; None if the file can't be read or
    isn't known.
    """
    if plan is None or not proved:
        return None
    place = plan.program.source.name
    if not Path(place).is_absolute():
        return None
    read = read_source(place)
    if read.value is None or has_errors(read.diagnostics):
        return None
    return read.value.text != proved
