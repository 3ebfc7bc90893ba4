"""Read ROS trajectories (trajectory_msgs/JointTrajectory, alone or in other messages) as motions to
convert.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from yarclang.convert.course import Content, Course, Wishes, in_axis_units
from yarclang.convert.table import LARGEST
from yarclang.diagnostics import Collector
from yarclang.robot.model import Robot
from yarclang.semantics.motions.trajectory_file import RATES

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_MULTI_DOF = "multi_dof_joint_trajectory"


def content_of_documents(
    documents: list[Any], robot: Robot, wishes: Wishes, findings: Collector
) -> Content | None:
    """Return all trajectories in YAML or JSON documents, in their order; None, with a finding, if there are
    none, or if one has mistakes.

    Args:
        documents: plain data.
        robot: the robot.
        wishes: the options.
        findings: collects findings.
    """
    messages = list(_trajectories(documents))
    if not messages:
        help_ = "give a file with joint_names and points, by themselves or inside of another message"
        findings.add("Y1509", "the file has no JointTrajectory", None, help_)
        return None
    courses: list[Course] = []
    for number, message in enumerate(messages, 1):
        where = f"trajectory {number}, " if len(messages) > 1 else ""
        course = _course(message, where, robot, wishes.joints or robot.joint_names, findings)
        if course is None:
            return None
        courses.append(course)
    points = sum(course.size for course in courses)
    kind = f"{len(courses)} trajectories of {points:,} points" if len(courses) > 1 else "a trajectory"
    if len(courses) == 1:
        kind += f" of {points:,} point{'s' * (points != 1)}"
    return Content(kind, tuple(courses))


def _trajectories(data: Any) -> Iterator[Mapping[str, Any]]:
    """Yield all messages that have joint_names and points, however deeply they are nested, in order."""
    waiting = [data]
    while waiting:
        one = waiting.pop()
        if isinstance(one, Mapping):
            if "joint_names" in one and "points" in one:
                yield one
                continue
            waiting += [
                value for key, value in reversed(list(one.items())) if not _is_empty_multi_dof(key, value)
            ]
        elif isinstance(one, list):
            waiting += [value for value in reversed(one) if isinstance(value, (Mapping, list))]


def _is_empty_multi_dof(key: str, value: Any) -> bool:
    """Return True for the empty multi-DOF trajectory that MoveIt adds to each message.

    A multi-DOF trajectory with points is a motion, which must not be lost.
    """
    return key == _MULTI_DOF and isinstance(value, Mapping) and not value.get("points")


def _course(
    message: Mapping[str, Any], where: str, robot: Robot, wanted: tuple[str, ...], findings: Collector
) -> Course | None:
    """Return one trajectory as a course (a motion to convert); None, with a finding, if it has mistakes.

    Args:
        message: the trajectory.
        where: text at the start of findings that names the trajectory.
        robot: the robot.
        wanted: names of the joints in the file, in the robot's order.
        findings: collects findings.
    """
    order = _order(message["joint_names"], where, robot, wanted, findings)
    if order is None:
        return None
    points = message["points"]
    if not isinstance(points, list) or not points:
        findings.add("Y1509", f"{where}there are no points", None, "check which file was given")
        return None
    q = np.empty((len(points), robot.size))
    rates: dict[str, list[list[float]]] = {name: [] for name in RATES[1:]}
    times = np.empty(len(points))
    for number, point in enumerate(points):
        place = f"{where}point {number + 1}"
        if not isinstance(point, Mapping):
            findings.add("Y1509", f"{place} isn't a message", None, "a point has positions, time_from_start")
            return None
        positions = point.get("positions")
        if not isinstance(positions, list):
            positions = []
        if "..." in positions:
            help_ = "print the whole message: ros2 topic echo --full-length"
            findings.add(
                "Y1509", f"{place}: the list of positions was cut off when it was printed", None, help_
            )
            return None
        if len(positions) != robot.size:
            message_ = (
                f"{place} has {len(positions)} position{'s' * (len(positions) != 1)}, but there are "
                f"{robot.size} joints"
            )
            findings.add("Y1509", message_, None, "give every point one position for each joint")
            return None
        for joint, at in enumerate(order):
            value = _number(positions[at])
            if value is None:
                shown = str(positions[at])[:40]
                message_ = (
                    f"{place}: the position of {wanted[joint]} is {shown!r}, which isn't a finite number"
                )
                findings.add("Y1505", message_, None, "positions are in rad, m for prismatic joints")
                return None
            q[number, joint] = value
        for name, rows in rates.items():
            row = _rates(point, name, place, order, wanted, findings)
            if row is None:
                return None
            rows.extend([row] if row else [])
        time = _time(point.get("time_from_start"))
        if time is None:
            message_ = f"{place}: time_from_start can't be read"
            findings.add("Y1509", message_, None, "it has sec and nanosec (ROS 2) or secs and nsecs (ROS 1)")
            return None
        times[number] = time
    values = in_axis_units(robot, q)
    if not times.any() and len(points) > 1:
        return Course("JOINTS", values, remarks=("The points have no times.",))
    late = np.diff(times) <= 0
    if late.any():
        number = int(np.argmax(late)) + 1
        message_ = (
            f"{where}point {number + 1}, at {times[number]:g} s, isn't later than the one before, at "
            f"{times[number - 1]:g} s"
        )
        findings.add("Y1509", message_, None, "make the times increase from point to point")
        return None
    velocities, accelerations = (
        in_axis_units(robot, np.array(rows)) if len(rows) == len(points) else None for rows in rates.values()
    )
    return Course(
        "JOINTS",
        values,
        times,
        remarks=tuple(_left_out(rates, len(points))),
        velocities=velocities,
        accelerations=None if velocities is None else accelerations,
    )


def _rates(
    point: Mapping[str, Any],
    name: str,
    place: str,
    order: list[int],
    wanted: tuple[str, ...],
    findings: Collector,
) -> list[float] | None:
    """Return the velocities or accelerations of a trajectory's point, in the robot's order; empty if it has
    none.

    Args:
        point: the point.
        name: "velocity" or "acceleration".
        place: text at the start of findings that names the point.
        order: for each joint of the robot, its index in the trajectory.
        wanted: names of the joints in the file, in the robot's order.
        findings: collects findings.

    Returns:
        The values; None, with a finding, if they have mistakes.
    """
    plural = _PLURALS[name]
    given = point.get(plural)
    if not isinstance(given, list) or not given:
        return []
    if len(given) != len(order):
        count = f"{len(given)} {name if len(given) == 1 else plural}"
        message = f"{place} has {count}, but there are {len(order)} joints"
        findings.add("Y1509", message, None, f"give a point the {plural} of all joints, or of none")
        return None
    row: list[float] = []
    for joint, at in enumerate(order):
        value = _number(given[at])
        if value is None:
            message = (
                f"{place}: the {name} of {wanted[joint]} is {str(given[at])[:40]!r}, which isn't a "
                "finite number"
            )
            findings.add("Y1505", message, None, "it is in rad per s, m per s for prismatic joints")
            return None
        row.append(value)
    return row


_PLURALS = {"velocity": "velocities", "acceleration": "accelerations"}


def _left_out(rates: Mapping[str, list[list[float]]], count: int) -> Iterator[str]:
    """Yield remarks about velocities and accelerations that are ignored because not all points of the
    trajectory have them.
    """
    for name, rows in rates.items():
        if 0 < len(rows) < count:
            yield (
                f"{_PLURALS[name].capitalize()} of only {len(rows):,} of {count:,} points are given, "
                f"and left out."
            )
    if len(rates["velocity"]) < count == len(rates["acceleration"]):
        yield "Accelerations without velocities are left out."


def _order(
    names: Any, where: str, robot: Robot, wanted: tuple[str, ...], findings: Collector
) -> list[int] | None:
    """Return, for each joint of the robot, its index in the trajectory's list of joint names; None, with a
    finding, if the list doesn't fit the robot.
    """
    listed = [str(name) for name in names] if isinstance(names, list) else []
    low = [name.lower() for name in listed]
    missing = [name for name in wanted if name.lower() not in low]
    extra = [name for name in listed if name.lower() not in {one.lower() for one in wanted}]
    twice = sorted({name for name in listed if low.count(name.lower()) > 1})
    if missing or extra or twice:
        parts = [
            f"{what} {', '.join(one[:40] for one in some[:20])}"
            for what, some in (("missing", missing), ("unknown", extra), ("twice", twice))
            if some
        ]
        message = f"{where}the joints aren't those of {robot.name}: {'; '.join(parts)}"
        help_ = (
            f"{robot.name} has {', '.join(robot.joint_names)}; if the file names them differently, give "
            "its names in this order by --joints"
        )
        findings.add("Y1511", message, None, help_)
        return None
    return [low.index(name.lower()) for name in wanted]


def _number(value: Any) -> float | None:
    """Return a finite number that is given as a number or as its text; None for anything else."""
    if isinstance(value, str) and _NUMBER.fullmatch(value):
        value = float(value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    return float(value) if abs(value) <= LARGEST else None


def _time(value: Any) -> float | None:
    """Return a time in seconds.

    Args:
        value: a duration as ROS 1 or ROS 2 writes it, or a number of seconds; None for a missing duration.

    Returns:
        The time [s]; 0 if the duration is missing, None if it is malformed.
    """
    if value is None:
        return 0.0
    if not isinstance(value, Mapping):
        seconds = _number(value)
        return seconds if seconds is None or seconds >= 0 else None
    for whole, part in (("sec", "nanosec"), ("secs", "nsecs")):
        if whole in value:
            seconds, rest = _number(value[whole]), _number(value.get(part, 0))
            if seconds is None or rest is None or seconds < 0 or rest < 0:
                return None
            return seconds + rest * 1e-9
    return None
