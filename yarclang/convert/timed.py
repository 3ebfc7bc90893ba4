"""Write joint values with times as the command MOVEJ_TIMED, with its waypoints in lines of the program or in
a file.
"""

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
"""Largest number of waypoints that are written into the program. If a motion has more, all its waypoints
are written into a file.
"""

_SMALL_ANGLE, _SMALL_LENGTH = 1e-5 / DEG, 1e-5 / MM
"""A velocity at an end of the course counts as noise if setting it to 0 changes the path by at most this
[deg, mm]. This value is a tenth of the allowed error.
"""

_SAMPLES = 8
"""Number of intervals into which the section between two waypoints is divided to compare two paths. The
paths are compared at the ends of these intervals.
"""


@dataclass(frozen=True, slots=True)
class Written:
    """A motion with times as lines of a program.

    Attributes:
        rows: the lines.
        index: number of the index for the command after these lines.
        remarks: sentences for the reader of the program.
        files: names and texts of the files that the lines refer to.
    """

    rows: list[str]
    index: int
    remarks: tuple[str, ...]
    files: tuple[tuple[str, str], ...] = ()


def at_rest(
    course: Course, where: str, robot: Robot, findings: Collector
) -> tuple[Course, tuple[str, ...]] | None:
    """Return a course (a motion) that is at rest at its end and, if it begins at time 0, also at its start.
    Velocities at these places that are only noise are set to 0. Also return remarks about this change.

    Args:
        course: joint values with times.
        where: text at the start of the finding that names the course.
        robot: the robot.
        findings: collects a finding about a course that begins or ends in motion.

    Returns:
        The course and the remarks; None, with a finding, if the course is in motion where the robot has to be
        at rest.
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
        # A velocity v at one end of an interval of duration h changes the interval's cubic polynomial by up
        # to 4/27 h v.
        excess = speeds * abs(times[near] - times[row]) * 4.0 / 27.0 / small
        joint = int(np.argmax(excess))
        if excess[joint] > 1.0:
            unit = robot.axis_unit_names[joint]
            message = (
                f"{where}it {when} in motion: {robot.joint_names[joint]} moves at "
                f"{velocities[row, joint]:.6g} {unit}/s at "
                f"{times[row]:.6g} s"
            )
            help_ = (
                "convert the whole recording, which begins and ends at rest; or use --as spline, which "
                "keeps the path without the times"
            )
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
    """Write the program lines of a course (a motion) whose targets are passed at their times.

    If the course begins at time 0, a MOVEJ leads to its start, unless the robot is there. A course from rest
    to rest with only two targets becomes a MOVEJ with its time, and a course without motion becomes a WAIT.

    Args:
        course: two or more joint positions, at rest at both ends.
        index: number of the first command's index.
        here: (n,) position of the robot before the course [deg, mm]; None if it isn't known.
        robot: the robot.
        file: name of the file for long tables; None to write everything into the program.
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
        # a program's lines have no entry for time 0, and so no acceleration at the start
        without = replace(course, accelerations=None)
        off = _difference(course, without)
        units = "/".join(dict.fromkeys(robot.axis_unit_names))
        remarks[-1] = f"The arm passes all points at their times; {_path(without)}"
        remarks.append(
            f"The accelerations aren't 0 at the start, and are left out: the path differs by up to "
            f"{off:.2g} {units}."
        )
        course = without
    return Written([*rows, *_lines(course, index)], index + STEP, tuple(remarks))


def _is_plain(course: Course) -> bool:
    """Return True if all velocities and accelerations of the course are 0 or missing."""
    return not any(rates is not None and rates.any() for rates in (course.velocities, course.accelerations))


def _path(course: Course) -> str:
    """Return the kind of interpolation between the waypoints, in words."""
    if course.velocities is None:
        return "between them each joint follows one cubic spline in time, with continuous acceleration."
    if course.accelerations is None:
        return "between them each joint follows a cubic polynomial with the velocities of both."
    return (
        "between them each joint follows a quintic polynomial with the velocities and accelerations of both."
    )


def _table(course: Course, robot: Robot) -> Timetable:
    """Return the course as a table of waypoints in SI units."""
    assert course.times is not None
    rates = [
        None if some is None else some * robot.axis_units
        for some in (course.velocities, course.accelerations)
    ]
    return Timetable(course.times, course.values * robot.axis_units, *rates)


def _difference(one: Course, other: Course) -> float:
    """Return the largest distance between the paths of two courses with equal targets [deg or mm]."""
    assert one.times is not None
    shares = np.arange(1, _SAMPLES) / _SAMPLES
    times = (one.times[:-1, None] + np.diff(one.times)[:, None] * shares).ravel()
    return float(np.abs(path_in_time(one, times) - path_in_time(other, times)).max())


def _lines(course: Course, index: int) -> list[str]:
    """Return the program lines of a MOVEJ_TIMED with its waypoints, one per line."""
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
