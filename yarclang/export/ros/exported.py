"""A certified program as trajectories: the way through this folder."""

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
from yarclang.hir import Assign, Program, SetOutput, WaitInput, WaitUntil, When, searches_of
from yarclang.pipeline.line_map import map_lines
from yarclang.pipeline.stages import Compiled
from yarclang.progress import tell
from yarclang.robot.model import Array, Robot

_LISTED = 5
"""So many things between trajectories are listed in the warning; the file has all."""


_SHARES = 1.0, 0.98, 0.9, 0.5
"""Way-points are chosen for such a share of the tolerance: the next one is only tried if the proof of those before was not tight enough."""


@frozen(eq=False)
class Wishes:
    """What is wanted: the `tolerance` of each joint [rad or m]; `straight` to keep it by straight lines between way-points as well."""

    tolerance: float
    straight: bool = False

    @property
    def kinds(self) -> tuple[Interpolation, ...]:
        """The interpolations that keep the tolerance. Way-points with accelerations make ros_control interpolate by quintics."""
        return ("linear", "cubic", "quintic") if self.straight else ("cubic", "quintic")


@frozen(eq=False)
class Exported:
    """A program's motion as trajectories.

    Attributes:
        program: the name of its file.
        fingerprint: SHA-256 of what the program does, as its controller text says.
        seal: SHA-256 of the controller text.
        robot: whom it is for.
        wishes: the tolerance and the interpolations.
        points: the way-points of all trajectories, one after the other.
        starts: when each trajectory begins [s] if no wait takes time.
        placed: what lies between them, by the number of trajectories that end before it.
        proved: of each interpolation, how far each joint (n,) is from the executed path at most [rad or m].
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
        """The number of trajectories."""
        return len(self.starts)

    @property
    def worst(self) -> float:
        """The largest deviation of any joint by any of the interpolations [rad or m]."""
        return max((float(one.max()) for one in self.proved.values()), default=0.0)

    def trajectory(self, number: int) -> Points:
        """Return the way-points of one trajectory, from 0."""
        first, last = np.searchsorted(self.points.stretch, [number, number + 1])
        return self.points.take(np.arange(first, last))

    def before(self, number: int) -> tuple[Between, ...]:
        """Return what happens before trajectory `number`, from 0, begins and after the one before has ended; the last number: after all."""
        return tuple(one for one in self.placed.get(number, ()) if one.time is None)

    def during(self, number: int) -> tuple[Between, ...]:
        """Return what happens during a trajectory."""
        return tuple(one for one in self.placed.get(number, ()) if one.time is not None)


def exported(compiled: Compiled, wishes: Wishes) -> Result[Exported]:
    """Make trajectories of a certified program.

    Returns:
        The trajectories, with a warning if something lies between them; None if the program moves nothing.
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
        raise AssertionError(f"no way-points were found that are within {wishes.tolerance:g} of the path")
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
    """What lies between trajectories, by the number of those that end before."""
    return {number: tuple(few) for number, few in groupby(between, lambda one: one.before)}


def _watched(program: Program) -> list[Diagnostic]:
    """What nobody watches while a driver carries a trajectory out."""
    found = [one.name for one in program.watches] + [one.name for one in searches_of(program)]
    names = ", ".join(dict.fromkeys(found))
    if not names:
        return []
    message = f"a trajectory watches no input: nothing holds or ends it for {names}"
    return [Diagnostic("Y1532", message, help="whoever sends the trajectories has to hold the robot")]


def _told(course: Course) -> list[Diagnostic]:
    """What a trajectory cannot say, as one warning."""
    if not course.between:
        return []
    words = {
        "set": "output",
        "wait": "wait",
        "hold": "hold",
        "dwell": "stop for a time",
        "when": "WHEN",
        "loop": "loop",
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
    help_ = f"the file says what happens before, during and after each of its {parts}; whoever sends them has to do it"
    return [Diagnostic("Y1532", message, help=help_)]
