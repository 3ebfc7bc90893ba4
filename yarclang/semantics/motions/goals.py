"""The way-points of a motion command to goals: positions, poses and increments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.commands.spec import Values
from yarclang.hir import Array, JointDelta, JointGoal, PoseDelta, PoseGoal, Told
from yarclang.semantics.motions.line import Line
from yarclang.semantics.motions.moved import takes_names
from yarclang.semantics.names.commands import ResolvedName
from yarclang.semantics.names.scope import KINDS, Frame, JointPosition
from yarclang.semantics.values.numbers import numbers_of
from yarclang.semantics.values.poses import check_limits, rotation_of
from yarclang.subjects import unknown
from yarclang.syntax.ast import WayPoint, Word
from yarclang.transforms import constant


def goals_of(line: Line, frames: tuple[Frame, Frame] | None) -> tuple[object, ...]:
    """The goals of all way-points, or what could be made of them beside the findings.

    Args:
        line: the command.
        frames: the frame on the flange that it moves, and that of its values; None where they aren't needed, or aren't known.
    """
    statement, name = line.statement, line.name
    near = _near(line)
    least, most = name.spec.waypoints
    given = len(statement.waypoints)
    if given < least or (most is not None and given > most):
        if given == 0:
            labels = line.values.labels(line.robot.joint_names)
            message = f"{name.spec.name} wants {len(labels)} values ({' '.join(labels)}), 0 are given"
            line.findings.add("Y0401", message, statement.head_span, _example(name))
            return ()
        wanted = "one way-point" if most == 1 else f"{least} or more way-points"
        place = statement.waypoints[min(given, most or given) - 1 if given < least else least].place
        message = f"{name.spec.name} takes {wanted}, {given} {'is' if given == 1 else 'are'} given"
        line.findings.add("Y0405", message, statement.span(place), _example(name))
    goals: list[object] = []
    for number, waypoint in enumerate(statement.waypoints, 1):
        goal = _named_goal(line, waypoint)
        if goal is None:
            values = _values(line, number)
            numbers = numbers_of(line, waypoint, number, values)
            if numbers is None:
                continue
            goal = _goal(line, waypoint, numbers, values, frames)
        if isinstance(goal, PoseGoal) and near is not None:
            goal = replace(goal, near=near)
        if goal is not None:
            goals.append(goal)
    return tuple(goals)


def _near(line: Line) -> Array | None:
    """NEAR name: the joint position to which the solution shall be near."""
    for option in line.statement.options:
        if option.word.name != "NEAR":
            continue
        span = line.statement.span((option.argument or option.word).place)
        if line.values.of_joints or line.name.spec.targets.get("") is not Values.JOINTS:
            message = "NEAR chooses among joint positions of a pose: only MOVEJ and its kin with _RPY or _QUAT take it"
            line.findings.add("Y0412", message, span, "take it away")
        elif not isinstance(word := option.argument, Word):
            line.findings.add(
                "Y0412", "NEAR takes the name of a joint position", span, "for example NEAR HOME"
            )
        else:
            found = _joint_position(line, word)
            return None if found is None else found.q
    return None


def _named_goal(line: Line, waypoint: WayPoint) -> object | None:
    """A way-point that is one name of a joint position: for commands that take joint values, whatever the target."""
    if len(waypoint.values) != 1 or not isinstance(word := waypoint.values[0], Word):
        return None
    if not takes_names(line.name) or word.name in {"NAN", "INF", "INFINITY"}:
        return None
    found = _joint_position(line, word)
    # without one there is an error, and the goal is never used
    return JointGoal(line.robot.home if found is None else found.q)


def _joint_position(line: Line, word: Word) -> JointPosition | None:
    found = line.scope.name(word.name)
    if isinstance(found, JointPosition):
        return found
    span = line.statement.span(word.place)
    if found is not None:
        line.findings.add("Y0209", f"{word.text} is {KINDS[type(found)]}, not a joint position", span)
        return None
    known = sorted(set(line.scope.names(JointPosition)))
    subject = unknown(word.text, known)
    help_ = f"{subject.question} there are {', '.join(known)}".lstrip()
    line.findings.add("Y0205", f"no joint position is named {word.text}", span, help_, subject=subject)
    return None


def _values(line: Line, number: int) -> Values:
    """What the values of a way-point (from 1) mean."""
    leading = line.name.spec.leading
    return leading[number - 1] if number <= len(leading) else line.values


def _goal(
    line: Line, waypoint: WayPoint, numbers: Array, values: Values, frames: tuple[Frame, Frame] | None
) -> object | None:
    """One goal from values in SI."""
    statement, findings = line.statement, line.findings
    if values is Values.JOINTS:
        check_limits(line.robot, numbers, findings, statement.span(waypoint.place))
        return JointGoal(constant(numbers))
    if values is Values.JOINT_DELTAS:
        return JointDelta(constant(numbers))
    if values is Values.POSITION:
        return None if frames is None else constant((frames[1].transform @ np.append(numbers, 1.0))[:3])
    rotation = rotation_of(values, numbers[3:], findings, lambda: statement.span(waypoint.place))
    if rotation is None or frames is None:
        return None
    flange_from_moving, axes = frames[0].transform, frames[1]
    if values.is_delta:
        turned = np.abs(numbers[3:]).max() if not values.is_quaternion else 0.0
        cosine = (rotation.trace() - 1.0) / 2.0
        if turned >= np.pi - 1e-9 or cosine <= -1.0 + 1e-12:
            message = "an increment of half a turn or more has no short way"
            findings.add("Y0409", message, statement.span(waypoint.place), "make two commands of it")
            return None
        return PoseDelta(
            constant(numbers[:3]),
            constant(rotation),
            constant(axes.transform[:3, :3]),
            axes.on_flange,
            flange_from_moving,
            _told(numbers, frames),
        )
    pose = _UNMOVED.copy()
    pose[:3, :3] = rotation
    pose[:3, 3] = numbers[:3]
    return PoseGoal(constant(axes.transform @ pose), flange_from_moving, told=_told(numbers, frames))


def _told(numbers: Array, frames: tuple[Frame, Frame]) -> Told | None:
    """Return a pose as it was written; None if a frame of it isn't known."""
    moving, base = frames[0].link, frames[1].link
    return None if moving is None or base is None else Told(constant(numbers), base, moving)


_UNMOVED = np.eye(4)


def _example(name: ResolvedName) -> str:
    return f"for example: {name.spec.examples[0].splitlines()[0]}"
