"""Joint values at their times as MOVEJ_TIMED: in lines, or in a file beside the program."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from yarclang.convert.columns import (
    DEFAULT_TIME,
    SAME_PLACE,
    STEP,
    comment_of,
    index_text,
    rows_of,
    seconds,
)
from yarclang.convert.course import Course
from yarclang.convert.thinning import path_in_time
from yarclang.diagnostics import Collector
from yarclang.hir import Array, Timetable
from yarclang.robot.model import Robot
from yarclang.semantics.motions.trajectory_file import write_table
from yarclang.units import DEG, MM

MOST_LINES = 20
"""Way-points that stand in the program; more go into a file."""

_SMALL_ANGLE, _SMALL_LENGTH = 1e-5 / DEG, 1e-5 / MM
"""A velocity at rest is noise if the way changes by no more than this [deg, mm] without it: a tenth of what a timed motion may be off."""

_SAMPLES = 8
"""Places of a leg at which two paths are compared."""


@dataclass(frozen=True, slots=True)
class Written:
    """A motion as lines of a program: the rows, the next index, remarks for the reader, the names and texts of files beside it."""

    rows: list[str]
    index: int
    remarks: tuple[str, ...]
    files: tuple[tuple[str, str], ...] = ()


def at_rest(
    course: Course, where: str, robot: Robot, findings: Collector
) -> tuple[Course, tuple[str, ...]] | None:
    """Return a course that stands at both ends, and remarks: noise in its velocities there becomes 0.

    Args:
        course: joint values with times.
        where: begins the finding: which course it is.
        robot: whose joints they are.
        findings: takes the finding about a course that begins or ends in motion.

    Returns:
        None if the course is in motion at an end where the robot has to stand.
    """
    velocities, times = course.velocities, course.times
    if velocities is None or times is None:
        return course, ()
    small = np.where(robot.chain.is_prismatic, _SMALL_LENGTH, _SMALL_ANGLE)
    velocities = velocities.copy()
    noise = 0.0
    for row, near, when in ((0, 1, "begins"), (-1, -2, "ends")):
        if row == 0 and not course.begins:
            continue
        speeds = np.abs(velocities[row])
        # a velocity v at the end of a leg of h moves its cubic polynomial by up to 4/27 h v
        excess = speeds * abs(times[near] - times[row]) * 4.0 / 27.0 / small
        joint = int(np.argmax(excess))
        if excess[joint] > 1.0:
            unit = robot.axis_unit_names[joint]
            message = (
                f"{where}it {when} in motion: {robot.joint_names[joint]} moves at {velocities[row, joint]:.6g} {unit}/s at "
                f"{times[row]:.6g} s"
            )
            help_ = "a program's motion begins and ends at rest: take the whole recording; or --as spline keeps the way without the times"
            findings.add("Y1513", message, None, help_)
            return None
        noise = max(noise, float(speeds.max()))
        velocities[row] = 0.0
    if not noise:
        return course, ()
    units = "/".join(dict.fromkeys(robot.axis_unit_names))
    remark = f"Velocities up to {noise:.2g} {units} per s at rest are taken as 0."
    return replace(course, velocities=velocities), (remark,)


def timed_motion(course: Course, index: int, here: Array | None, robot: Robot, file: str | None) -> Written:
    """Write a course that is passed at its times.

    A course that begins at time 0 is led to by a MOVEJ, unless the robot stands there. One leg from rest to rest is a MOVEJ in its time; a course that stays
    where it is is a WAIT.

    Args:
        course: two or more joint positions, at rest at both ends.
        index: the number of the first command's index.
        here: (n,) where the robot stands before it [deg, mm]; None: anywhere.
        robot: whose joints they are.
        file: the name of the file for long tables; None: all stands in the program.
    """
    assert course.times is not None
    rows: list[str] = []
    remarks: list[str] = []
    if course.begins and (here is None or np.abs(here - course.values[0]).max() > SAME_PLACE):
        first = rows_of(course.values[:1], "JOINTS")[0]
        rows.append(f"{index_text(index)} MOVEJ {first} [{DEFAULT_TIME}]{comment_of(course, 0, True)}")
        index += STEP
    if course.begins and np.abs(course.values - course.values[0]).max() <= SAME_PLACE:
        rows.append(f"{index_text(index)} WAIT [{seconds(course.times[-1])}]{comment_of(course, 1, True)}")
        return Written(rows, index + STEP, ("The arm doesn't move: it waits.",))
    if course.begins and course.size == 2 and _is_plain(course):
        last = rows_of(course.values[1:], "JOINTS")[0]
        rows.append(
            f"{index_text(index)} MOVEJ {last} [{seconds(course.times[1])}]{comment_of(course, 1, True)}"
        )
        return Written(rows, index + STEP, ())
    has_start_acceleration = (
        course.begins and course.accelerations is not None and bool(course.accelerations[0].any())
    )
    points = course.size - course.begins
    remarks += [f"The arm passes all points at their times; {_path(course)}"]
    if file is not None and (points > MOST_LINES or has_start_acceleration):
        rows.append(f'{index_text(index)} MOVEJ_TIMED "{file}"')
        return Written(
            rows, index + STEP, tuple(remarks), ((file, write_table(robot, _table(course, robot))),)
        )
    if has_start_acceleration:
        # in lines, nothing is said of time 0
        without = replace(course, accelerations=None)
        off = _difference(course, without)
        units = "/".join(dict.fromkeys(robot.axis_unit_names))
        remarks[-1] = f"The arm passes all points at their times; {_path(without)}"
        remarks.append(
            f"The accelerations aren't 0 at the start, and are left out: the path differs by up to {off:.2g} {units}."
        )
        course = without
    return Written([*rows, *_lines(course, index)], index + STEP, tuple(remarks))


def _is_plain(course: Course) -> bool:
    """Return True if nothing is said of how fast the joints go."""
    return not any(rates is not None and rates.any() for rates in (course.velocities, course.accelerations))


def _path(course: Course) -> str:
    """Say how the joints go between the points."""
    if course.velocities is None:
        return "between them each joint follows one cubic spline in time, with continuous acceleration."
    if course.accelerations is None:
        return "between them each joint follows a cubic polynomial with the velocities of both."
    return (
        "between them each joint follows a quintic polynomial with the velocities and accelerations of both."
    )


def _table(course: Course, robot: Robot) -> Timetable:
    """Return the course in SI."""
    assert course.times is not None
    rates = [
        None if some is None else some * robot.axis_units
        for some in (course.velocities, course.accelerations)
    ]
    return Timetable(course.times, course.values * robot.axis_units, *rates)


def _difference(one: Course, other: Course) -> float:
    """Return how far the paths of two courses with the same targets are apart [deg or mm]."""
    assert one.times is not None
    shares = np.arange(1, _SAMPLES) / _SAMPLES
    times = (one.times[:-1, None] + np.diff(one.times)[:, None] * shares).ravel()
    return float(np.abs(path_in_time(one, times) - path_in_time(other, times)).max())


def _lines(course: Course, index: int) -> list[str]:
    """Return MOVEJ_TIMED with its way-points, a line each."""
    assert course.times is not None
    begin = int(course.begins)
    times = [f"[{_to_nanoseconds(time)}]" for time in course.times[begin:]]
    widest = max(map(len, times))
    columns = [rows_of(course.values[begin:], "JOINTS"), [time.ljust(widest) for time in times]]
    for word, rates in (("VEL", course.velocities), ("ACC", course.accelerations)):
        if rates is not None:
            columns.append([f"{word} {row}" for row in rows_of(rates[begin:], "JOINTS")])
    cells = [" ".join(parts).rstrip() for parts in zip(*columns, strict=True)]
    head = f"{index_text(index)} MOVEJ_TIMED "
    rows = []
    for number, cell in enumerate(cells):
        end = "" if number == len(cells) - 1 else ";"
        rows.append(f"{head}{cell}{end}{comment_of(course, number + begin, True)}")
        head = " " * len(head)
    return rows


def _to_nanoseconds(time: float) -> str:
    return f"{time:.9f}".rstrip("0").rstrip(".")
