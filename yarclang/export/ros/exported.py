"""Convert a certified program to trajectories, with the modules of this folder."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from itertools import groupby

import numpy as np

from yarclang.decisions import inputs_of
from yarclang.diagnostics import Diagnostic, Result
from yarclang.export.ros.course import Between, Course, course_of
from yarclang.export.ros.interpolation import Interpolation
from yarclang.export.ros.proof import deviation
from yarclang.export.ros.sampling import Points, sampled
from yarclang.frozen import frozen
from yarclang.hir import Assign, Program, SetOutput, WaitInput, WaitUntil, When, offsets_of, searches_of
from yarclang.pipeline.line_map import map_lines
from yarclang.pipeline.stages import Compiled
from yarclang.progress import tell
from yarclang.robot.model import Array, Robot

_LISTED = 5
"""Largest number of events that the warning about events between trajectories lists. The exported file has
all events.
"""


_SHARES = 1.0, 0.98, 0.9, 0.5
"""Fractions of the tolerance. Waypoints are chosen with the first fraction; if the proof then fails, they
are chosen with the next fraction.
"""


@frozen(eq=False)
class Wishes:
    """Options of the export of trajectories.

    Attributes:
        tolerance: largest deviation of each joint from the executed path [rad or m].
        straight: True if straight lines between waypoints must also keep the tolerance.
    """

    tolerance: float
    straight: bool = False

    @property
    def kinds(self) -> tuple[Interpolation, ...]:
        """The kinds of interpolation between waypoints that drivers may use. With each kind, the deviation
        stays within the tolerance.

        ros_control uses quintics, because the waypoints have accelerations.
        """
        return ("linear", "cubic", "quintic") if self.straight else ("cubic", "quintic")


@frozen(eq=False)
class Exported:
    """A program's motion as trajectories.

    Attributes:
        program: name of the program's file.
        fingerprint: SHA-256 of the program, from the header of its controller text.
        seal: SHA-256 of the controller text.
        robot: the robot of the program.
        wishes: the options.
        points: waypoints of all trajectories, one after the other.
        starts: time at which each trajectory begins if waits take no time [s].
        placed: events between and during the trajectories, by the number of trajectories that end before the
            event.
        proved: for each kind of interpolation, the largest deviation of each joint (n,) from the executed
            path [rad or m].
    """

    program: str
    fingerprint: str
    seal: str
    robot: Robot
    wishes: Wishes
    points: Points
    starts: tuple[float, ...]
    placed: Mapping[int, tuple[Between, ...]]
    proved: Mapping[Interpolation, Array]

    @property
    def size(self) -> int:
        """Number of trajectories."""
        return len(self.starts)

    @property
    def worst(self) -> float:
        """Largest deviation from the executed path, of any joint with any interpolation [rad or m]."""
        return max((float(one.max()) for one in self.proved.values()), default=0.0)

    def trajectory(self, number: int) -> Points:
        """Return the waypoints of a trajectory, by its number from 0."""
        first, last = np.searchsorted(self.points.stretch, [number, number + 1])
        return self.points.take(np.arange(first, last))

    def before(self, number: int) -> tuple[Between, ...]:
        """Return the events between a trajectory and the one before it; trajectories are numbered from 0.

        If `number` equals the number of trajectories, return the events after the last one.
        """
        return tuple(one for one in self.placed.get(number, ()) if one.time is None)

    def during(self, number: int) -> tuple[Between, ...]:
        """Return the events during a trajectory, by its number from 0."""
        return tuple(one for one in self.placed.get(number, ()) if one.time is not None)


def exported(compiled: Compiled, wishes: Wishes) -> Result[Exported]:
    """Convert a certified program to trajectories.

    Returns:
        The trajectories, with a warning if there are events between or during them; None, with an error, for
        a program without motion.
    """
    robot, content = compiled.plan.robot, compiled.certificate.text
    names = {output.signal.variable: output.signal.name for output in compiled.program.outputs}
    for step in compiled.program.steps:
        match step:
            case SetOutput(output=signal) | WaitInput(input=signal):
                names.setdefault(signal.variable, signal.name)
            case When(condition=value) | WaitUntil(condition=value) | Assign(value=value):
                for read in inputs_of(value):
                    names.setdefault(read.variable, read.name)
    course = course_of(content, map_lines(compiled.text), robot, names)
    if not course.size:
        message = f"{content.header.source} moves nothing: there is no trajectory in it"
        return Result(None, (Diagnostic("Y1531", message, help="export a program with motions"),))
    for share in _SHARES:
        points = sampled(course.path, wishes.tolerance * share, wishes.kinds)
        tell("proving the trajectories", 0)
        proved = {kind: deviation(course.path, points, kind) for kind in wishes.kinds}
        if max(float(one.max()) for one in proved.values()) <= wishes.tolerance:
            break
    else:
        raise AssertionError(f"no waypoints were found that are within {wishes.tolerance:g} of the path")
    made = Exported(
        content.header.source,
        content.header.program_fingerprint,
        hashlib.sha256(compiled.text.encode()).hexdigest(),
        robot,
        wishes,
        points,
        course.starts,
        _placed(course.between),
        proved,
    )
    return Result(made, (*_told(course), *_watched(compiled.program)))


def _placed(between: tuple[Between, ...]) -> dict[int, tuple[Between, ...]]:
    """Return the events, grouped by the number of trajectories that end before the event."""
    return {number: tuple(few) for number, few in groupby(between, lambda one: one.before)}


def _watched(program: Program) -> list[Diagnostic]:
    """Return warnings about features of the program that a trajectory doesn't have: inputs that end or hold a
    motion, and frames that are shifted while the program runs.
    """
    told = []
    for frame in dict.fromkeys(one.frame for one in offsets_of(program)):
        message = (
            f"{{{frame}}} is shifted when the program runs, and the trajectories are those without a shift"
        )
        help_ = (
            "leave the lines of the OFFSET out of what is sent, or send them only where nothing is shifted"
        )
        told.append(Diagnostic("Y1532", message, help=help_))
    found = [one.name for one in program.watches] + [one.name for one in searches_of(program)]
    names = ", ".join(dict.fromkeys(found))
    if not names:
        return told
    message = f"a trajectory watches no input: nothing holds or ends it for {names}"
    return [*told, Diagnostic("Y1532", message, help="whoever sends the trajectories has to hold the robot")]


def _told(course: Course) -> list[Diagnostic]:
    """Return one warning about all events that can't be part of a trajectory."""
    if not course.between:
        return []
    words = {
        "set": "output",
        "wait": "wait",
        "hold": "hold",
        "dwell": "stop for a time",
        "when": "WHEN",
        "loop": "loop",
        "say": "message",
        "abort": "ABORT",
    }
    kinds = [one.kind for one in course.between]
    counts = [
        f"{kinds.count(kind)} {word}{'s' * (kinds.count(kind) > 1 and kind != 'dwell')}"
        for kind, word in words.items()
        if kind in kinds
    ]
    some = "; ".join(one.text for one in course.between[:_LISTED])
    more = f"; and {len(course.between) - _LISTED} more" if len(course.between) > _LISTED else ""
    parts = f"{course.size} trajector{'ies' if course.size > 1 else 'y'}"
    message = f"{', '.join(counts)} can't be part of a trajectory: {some}{more}"
    help_ = (
        f"the file says what happens before, during and after each of its {parts}; whoever sends them "
        f"has to do it"
    )
    return [Diagnostic("Y1532", message, help=help_)]
