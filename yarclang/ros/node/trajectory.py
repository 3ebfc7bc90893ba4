"""Goals of FollowJointTrajectory: their checks, their programs, and their paths over time. No I/O, no clock.

In a `Track` the joints are in the robot's order; a `Goal` has its own order.
"""

from __future__ import annotations

import bisect
import collections
import math
from dataclasses import dataclass, replace
from typing import Sequence, Tuple

Values = Tuple[float, ...]

SUCCESSFUL = 0
INVALID_GOAL = -1
INVALID_JOINTS = -2
OLD_HEADER_TIMESTAMP = -3
PATH_TOLERANCE_VIOLATED = -4
GOAL_TOLERANCE_VIOLATED = -5

MOST_POINTS = 20_000
"""Largest number of waypoints of one goal."""

MOST_TEXT = (1 << 22) - 4096
"""Longest text of a program as JSON [bytes]. The coordinator reads lines of up to 4 MiB."""

MOST_VALUE = 1e6
"""Largest position, velocity, acceleration or time that is accepted [rad, m, s]."""

LEAST_STEP = 1e-6
"""Shortest time between two points [s]. Times in the program's text are rounded to nanoseconds."""

LATE = 1.0
"""Age of a goal's stamp above which the goal is refused [s]."""

START_WITHIN = 0.01
"""If a goal's first waypoint has time 0: largest distance of a joint from its position in this waypoint at
which the robot counts as being at this waypoint [rad or m]. MoveIt's check has the same limit.
"""

_SAME = 1e-6
"""Largest distance of a joint from its position in a waypoint at which no motion is needed [rad or m]."""

_RESTS = 1e-6
"""Largest velocity that counts as zero [rad/s or m/s]."""

_PER_UNIT = {"deg": 180.0 / math.pi, "mm": 1000.0}
"""Number of the language's units per rad or m."""

_NEXT = ";\n"
"""Separator of waypoints. Each waypoint is on a line of its own, because the length of lines is limited."""


@dataclass(frozen=True)
class Joint:
    """A joint of the robot.

    Attributes:
        name: name of the joint in robot.toml and the URDF.
        unit: unit of the joint's positions in messages of the coordinator, "deg" or "mm".
    """

    name: str
    unit: str

    @property
    def scale(self) -> float:
        """Number of the coordinator's units per rad or m."""
        return _PER_UNIT[self.unit]


@dataclass(frozen=True)
class Point:
    """A waypoint of a goal, with the joints in the order of the goal's joint names.

    Attributes:
        positions: positions [rad or m].
        time_from_start: time since the start of the goal [s].
        velocities: velocities [rad/s or m/s]; empty if none are given.
        accelerations: accelerations [rad/s² or m/s²]; empty if none are given.
    """

    positions: Values
    time_from_start: float
    velocities: Values = ()
    accelerations: Values = ()


@dataclass(frozen=True)
class Tolerance:
    """Tolerances of one joint, as in control_msgs/JointTolerance: 0 means the default, a negative value means
    no tolerance.

    Attributes:
        name: name of the joint.
        position: tolerance of the position [rad or m].
        velocity: tolerance of the velocity [rad/s or m/s].
        acceleration: tolerance of the acceleration [rad/s² or m/s²].
    """

    name: str
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0


@dataclass(frozen=True)
class Goal:
    """A goal as received.

    Attributes:
        joint_names: names of all joints of the robot, in any order.
        points: the waypoints.
        starts_in: time until the goal begins, by the stamp of its header [s]; 0 to begin at once (also
            without a stamp).
        path_tolerance: tolerance of the joints along the path.
        goal_tolerance: tolerance of the joints at the last point.
        goal_time_tolerance: time in which the joints must arrive after the end of the program [s]; 0 for the
            default, negative for no limit.
    """

    joint_names: tuple[str, ...]
    points: tuple[Point, ...]
    starts_in: float = 0.0
    path_tolerance: tuple[Tolerance, ...] = ()
    goal_tolerance: tuple[Tolerance, ...] = ()
    goal_time_tolerance: float = 0.0


@dataclass(frozen=True)
class Result:
    """Result that the client gets at the end of a goal.

    Attributes:
        error_code: one of the constants of control_msgs/FollowJointTrajectoryResult.
        error_string: the reason, or a note; may be empty.
    """

    error_code: int
    error_string: str = ""


@dataclass(frozen=True)
class Moment:
    """State of the joints at one time.

    Attributes:
        positions: positions [rad or m].
        velocities: velocities [rad/s or m/s].
        accelerations: accelerations [rad/s² or m/s²]; empty if unknown.
        time: time since the goal's start [s]; negative on the way to the goal's first point.
    """

    positions: Values
    velocities: Values = ()
    accelerations: Values = ()
    time: float = 0.0


# checks


def fault_of(goal: Goal, joints: Sequence[Joint]) -> Result | None:
    """Return the reason why a goal is rejected; None if it can be planned. Limits are checked by the planner,
    not here.

    Args:
        goal: goal as received.
        joints: joints of the robot.
    """
    wrong = _wrong_names(goal.joint_names, [one.name for one in joints])
    if wrong is not None:
        return Result(INVALID_JOINTS, wrong)
    wrong = _wrong_times(goal) or _wrong_points(goal) or _wrong_ends(goal) or _wrong_tolerances(goal)
    if wrong is not None:
        return Result(INVALID_GOAL, wrong)
    if goal.starts_in < -LATE:
        late = f"the stamp of the goal is {-goal.starts_in:.3f} s in the past, more than {LATE:g} s"
        return Result(OLD_HEADER_TIMESTAMP, f"{late}: stamp it with the time of its start, or with 0")
    return None


def _wrong_names(names: Sequence[str], robots: Sequence[str]) -> str | None:
    doubled = sorted(name for name, count in collections.Counter(names).items() if count > 1)
    unknown = [name for name in names if name not in robots]
    missing = [name for name in robots if name not in names]
    for found, what in ((unknown, "unknown"), (doubled, "doubled"), (missing, "missing")):
        if found:
            return f"joint names: {_listed(found)} {what}; the robot has {_listed(list(robots))}"
    return None


def _listed(names: list[str], most: int = 12) -> str:
    shown = ", ".join(name[:64] for name in names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def _wrong_times(goal: Goal) -> str | None:
    points = goal.points
    if not points:
        return "the goal has no points: it needs at least one"
    if len(points) > MOST_POINTS:
        return f"the goal has {len(points)} points, at most {MOST_POINTS} are taken: divide it, or thin it"
    if not (math.isfinite(goal.starts_in) and math.isfinite(goal.goal_time_tolerance)):
        return "the stamp or goal_time_tolerance is no finite number"
    before = -1.0
    for number, point in enumerate(points):
        time = point.time_from_start
        if not 0.0 <= time <= MOST_VALUE:
            return (
                f"point {number}: time_from_start is {time:g} s: it must be a number from 0 to {MOST_VALUE:g}"
            )
        if 0.0 < time < max(before, 0.0) + LEAST_STEP or time <= before:
            last = f"{before:.9g} s at the point before" if number else "the motion begins at 0 s"
            return (
                f"point {number}: time_from_start is {time:.9g} s, and {last}: times must grow by "
                f"{LEAST_STEP:g} s or more"
            )
        before = time
    return None


def _wrong_points(goal: Goal) -> str | None:
    first, size = goal.points[0], len(goal.joint_names)
    if first.accelerations and not first.velocities:
        return "point 0 has accelerations and no velocities: give both, or leave the accelerations out"
    for number, point in enumerate(goal.points):
        for what, values, given in (
            ("positions", point.positions, True),
            ("velocities", point.velocities, bool(first.velocities)),
            ("accelerations", point.accelerations, bool(first.accelerations)),
        ):
            if bool(values) != given:
                has, others = ("has", "has none") if values else ("has no", "has them")
                return f"point {number} {has} {what}, point 0 {others}: all points have them, or none"
            if values and len(values) != size:
                return f"point {number} has {len(values)} {what} for {size} joints"
            for name, value in zip(goal.joint_names, values):
                if not abs(value) <= MOST_VALUE:
                    return (
                        f"point {number}: {what} of {name} has {value:g}: it must be a number within "
                        f"{MOST_VALUE:g} [rad, m, s]"
                    )
    return None


def _wrong_ends(goal: Goal) -> str | None:
    first, last = goal.points[0], goal.points[-1]
    ends = [(last, "the last point", "the motion ends at rest")]
    if first.time_from_start == 0.0:
        ends.append((first, "the first point, at time 0,", "the motion begins at rest"))
    for point, where, why in ends:
        for name, value in zip(goal.joint_names, point.velocities):
            if abs(value) > _RESTS:
                return f"{name} has the velocity {value:.6g} at {where}: {why}, it must be 0"
    return None


def _wrong_tolerances(goal: Goal) -> str | None:
    for what, tolerances in (("path", goal.path_tolerance), ("goal", goal.goal_tolerance)):
        for one in tolerances:
            if one.name not in goal.joint_names:
                return f"{what}_tolerance names {one.name[:64]}, which the goal doesn't move"
            if not all(map(math.isfinite, (one.position, one.velocity, one.acceleration))):
                return f"{what}_tolerance of {one.name} has a value that is no finite number"
            if what == "path" and (one.velocity > 0.0 or one.acceleration > 0.0):
                return (
                    f"path_tolerance of {one.name} limits the velocity or the acceleration: only "
                    f"positions are watched on the way, since the "
                    "operator may change the pace; set these to 0"
                )
    return None


# the path


@dataclass(frozen=True)
class Track:
    """A path over time, with the joints in the robot's order.

    Attributes:
        times: (k,) times of the waypoints [s], increasing, from 0.
        positions: (k, n) positions [rad or m].
        velocities: (k, n) velocities [rad/s or m/s].
        accelerations: (k, n) accelerations [rad/s² or m/s²]. If empty, the path between two waypoints is a
            cubic polynomial, otherwise a quintic one.
    """

    times: Values
    positions: tuple[Values, ...]
    velocities: tuple[Values, ...]
    accelerations: tuple[Values, ...] = ()

    @property
    def duration(self) -> float:
        """Time of the last point [s]."""
        return self.times[-1]

    def at(self, time: float) -> Moment:
        """Return the state of the joints at a time on the path [s]. Before the start and after the end of the
        path the robot rests.
        """
        last = len(self.times) - 1
        if time <= 0.0 or time >= self.times[last]:
            end = 0 if time <= 0.0 else last
            rest = (0.0,) * len(self.positions[end])
            return Moment(self.positions[end], rest, rest, time)
        piece = bisect.bisect_right(self.times, time) - 1
        width = self.times[piece + 1] - self.times[piece]
        since = time - self.times[piece]
        values = [
            _values(self._coefficients(piece, joint, width), since) for joint in range(len(self.positions[0]))
        ]
        return Moment(
            tuple(one[0] for one in values),
            tuple(one[1] for one in values),
            tuple(one[2] for one in values),
            time,
        )

    def nearest(self, positions: Values, first: float, last: float) -> Moment:
        """Find the time between `first` and `last` [s] at which the path is nearest to given joint positions
        (n,) [rad or m]. Return the state of the joints on the path at this time.
        """
        first, last = max(0.0, first), min(self.duration, last)
        best = self.at(first)
        if last <= first:
            return best
        width = last - first
        middle = first + width / 2.0
        for _ in range(_ROUNDS):
            times = [middle + width * (share / _TRIED - 0.5) for share in range(_TRIED + 1)]
            tried = [self.at(min(max(time, first), last)) for time in times]
            best = min((best, *tried), key=lambda one: math.dist(one.positions, positions))
            middle, width = best.time, 2.0 * width / _TRIED
        return best

    def _coefficients(self, piece: int, joint: int, width: float) -> Values:
        q0, q1 = self.positions[piece][joint], self.positions[piece + 1][joint]
        v0, v1 = self.velocities[piece][joint], self.velocities[piece + 1][joint]
        rise = (q1 - q0) / width
        if not self.accelerations:
            return (q0, v0, (3.0 * rise - 2.0 * v0 - v1) / width, (v0 + v1 - 2.0 * rise) / width**2)
        a0, a1 = self.accelerations[piece][joint], self.accelerations[piece + 1][joint]
        # The powers 0 to 2 follow from position, velocity and acceleration at the first point. With these
        # powers alone, the polynomial would miss the second point by `off` in position, `slower` in velocity
        # and `bend` in acceleration; the powers 3 to 5 correct this.
        off = (rise - v0 - a0 * width / 2.0) / width**2
        slower = (v1 - v0 - a0 * width) / width**2
        bend = (a1 - a0) / width
        third = 10.0 * off - 4.0 * slower + bend / 2.0
        fourth = (-15.0 * off + 7.0 * slower - bend) / width
        fifth = (6.0 * off - 3.0 * slower + bend / 2.0) / width**2
        return (q0, v0, a0 / 2.0, third, fourth, fifth)


_ROUNDS, _TRIED = 4, 6
"""Rounds of the search for the time at which the path is nearest, and samples in each round: together they
reduce an interval of 100 ms to 0.6 ms.
"""


def _values(coefficients: Values, since: float) -> tuple[float, float, float]:
    """Return the value of a polynomial and its first two derivatives."""
    value = slope = bend = 0.0
    for one in reversed(coefficients):
        bend = bend * since + 2.0 * slope
        slope = slope * since + value
        value = value * since + one
    return value, slope, bend


def track_of(goal: Goal, joints: Sequence[Joint], stands: Values) -> Track:
    """Return the path over time of a checked goal, as MOVEJ_TIMED defines it.

    Args:
        goal: goal with its joints in any order.
        joints: joints of the robot.
        stands: (n,) start of the motion, in the robot's order [rad or m]. It replaces a first waypoint at
            time 0.
    """
    points = in_robots_order(goal, joints)
    if points[0].time_from_start == 0.0:
        points = points[1:]
    rest = (0.0,) * len(stands)
    times = (0.0, *(one.time_from_start for one in points))
    positions = (tuple(stands), *(one.positions for one in points))
    if not points or not points[0].velocities:
        return Track(times, positions, _clamped(times, positions))
    velocities = (rest, *(one.velocities for one in points[:-1]), rest)
    accelerations = (rest, *(one.accelerations for one in points)) if points[0].accelerations else ()
    return Track(times, positions, velocities, accelerations)


def in_robots_order(goal: Goal, joints: Sequence[Joint]) -> tuple[Point, ...]:
    """Return the points of a goal with their joints in the order of the robot."""
    order = [goal.joint_names.index(joint.name) for joint in joints]

    def ordered(values: Values) -> Values:
        return tuple(values[place] for place in order) if values else ()

    return tuple(
        replace(
            joint,
            positions=ordered(joint.positions),
            velocities=ordered(joint.velocities),
            accelerations=ordered(joint.accelerations),
        )
        for joint in goal.points
    )


def _clamped(times: Values, positions: tuple[Values, ...]) -> tuple[Values, ...]:
    """Return the velocities (k, n) at the waypoints for a cubic spline with continuous acceleration that
    begins and ends at rest. A tridiagonal system is solved for each joint.
    """
    count, size = len(times), len(positions[0])
    if count <= 2:
        return ((0.0,) * size,) * count
    inverse = [1.0 / (after - before) for before, after in zip(times, times[1:])]
    columns = [_solved(inverse, [row[joint] for row in positions]) for joint in range(size)]
    return tuple(zip(*columns))


def _solved(inverse: list[float], q: list[float]) -> list[float]:
    """Solve the tridiagonal system for the inner velocities v of a cubic spline, by the Thomas algorithm:

    v_{i-1} / h_{i-1} + 2 (1 / h_{i-1} + 1 / h_i) v_i + v_{i+1} / h_i = 3 (d_{i-1} / h_{i-1} + d_i / h_i),
    where h_i is the duration of interval i between two waypoints and d_i the mean velocity in it. The first
    and the last velocity are 0.

    Args:
        inverse: 1 / h_i of each interval [1/s].
        q: positions at the waypoints.
    """
    last = len(q) - 1
    pull = [3.0 * (q[at + 1] - q[at]) * inverse[at] ** 2 for at in range(last)]
    upper, right = [0.0] * last, [0.0] * last
    for at in range(1, last):
        pivot = 2.0 * (inverse[at - 1] + inverse[at]) - inverse[at - 1] * upper[at - 1]
        upper[at] = inverse[at] / pivot
        right[at] = (pull[at - 1] + pull[at] - inverse[at - 1] * right[at - 1]) / pivot
    found = [0.0] * (last + 1)
    for at in range(last - 1, 0, -1):
        found[at] = right[at] - upper[at] * found[at + 1]
    return found


# the program


@dataclass(frozen=True)
class Planned:
    """The program that carries out a goal.

    Attributes:
        text: text of the program; empty if the robot is at the goal's end and need not move.
        track: planned path, from the robot's position at time 0 of the goal.
        has_lead: True if the first command of the program moves to the goal's first waypoint.
    """

    text: str
    track: Track
    has_lead: bool


def program_of(goal: Goal, joints: Sequence[Joint], stands: Values) -> Planned:
    """Return the program that carries out a checked goal.

    If the first waypoint has time 0 and the robot is within `START_WITHIN` of it, the motion begins at the
    robot's position. If the robot is farther away, a MOVEJ with half of all limits moves to this waypoint
    first. If the first waypoint has a later time, the robot moves from its present position and reaches the
    waypoint at this time.

    Args:
        goal: goal with its joints in any order.
        joints: joints of the robot.
        stands: (n,) commanded position of the robot, in the robot's order [rad or m].
    """
    points = in_robots_order(goal, joints)
    first = points[0]
    away = max(abs(goes - stands[at]) for at, goes in enumerate(first.positions))
    at_once = first.time_from_start == 0.0
    only = len(points) == 1
    has_lead = at_once and away > (_SAME if only else START_WITHIN)
    begins = first.positions if has_lead else stands
    track = track_of(goal, joints, begins)
    scales = [one.scale for one in joints]
    lines = []
    if has_lead:
        lines.append(f"P0010 MOVEJ {_numbers(first.positions, scales, 9)} [50%] (mm,deg)")
    rows = points[1:] if at_once else points
    moves = any(abs(value - begins[at]) > _SAME for row in rows for at, value in enumerate(row.positions))
    moves = moves or any(abs(value) > _RESTS for row in rows for value in row.velocities)
    if rows and (moves or has_lead):
        table = _NEXT.join(_row(row, scales, is_last=row is rows[-1]) for row in rows)
        lines.append(f"P0020 MOVEJ_TIMED {table} (mm,deg,s)")
    return Planned("".join(line + "\n" for line in lines), track, has_lead)


def too_long(planned: Planned) -> str | None:
    """Return the reason why the program of a goal can't be sent; None if it can."""
    length = len(planned.text) + planned.text.count("\n")  # JSON writes a line break as two characters
    if length <= MOST_TEXT:
        return None
    return (
        f"the goal with its {len(planned.track.times)} points is a text of {length / 2**20:.2f} MiB, "
        f"and {MOST_TEXT / 2**20:.2f} MiB are taken: "
        "thin it, divide it, or leave accelerations out"
    )


def _row(point: Point, scales: Sequence[float], *, is_last: bool) -> str:
    text = f"{_numbers(point.positions, scales, 9)} [{_number(point.time_from_start, 9)}]"
    if point.velocities:
        velocities = (0.0,) * len(scales) if is_last else point.velocities
        text += f" VEL {_numbers(velocities, scales, 7)}"
    if point.accelerations:
        text += f" ACC {_numbers(point.accelerations, scales, 6)}"
    return text


def _numbers(values: Values, scales: Sequence[float], digits: int) -> str:
    return " ".join(_number(value * scale, digits) for value, scale in zip(values, scales))


def _number(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
