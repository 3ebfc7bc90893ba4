"""Convert the waypoints of a motion command to goals: joint positions, poses and increments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.commands.spec import Values
from yarclang.hir import Array, JointDelta, JointGoal, PoseDelta, PoseGoal, Told
from yarclang.semantics.motions.line import Line
from yarclang.semantics.motions.moved import meaning_of, named_poses, takes_names
from yarclang.semantics.names.commands import ResolvedName
from yarclang.semantics.names.scope import KINDS, Frame, JointPosition, Pose, Taught
from yarclang.semantics.values.evaluate import EvaluationError, place_named
from yarclang.semantics.values.numbers import numbers_of
from yarclang.semantics.values.poses import check_limits, rotation_of
from yarclang.subjects import unknown
from yarclang.syntax.ast import Computed, WayPoint, Word
from yarclang.syntax.leaves import from_to
from yarclang.transforms import constant


def goals_of(line: Line, frames: tuple[Frame, Frame] | None) -> tuple[object, ...]:
    """Return the goals of all waypoints of a command; waypoints with findings may be left out.

    Args:
        line: the command.
        frames: the command's moving frame, and the frame of its values; None if they aren't needed or have
            errors.
    """
    statement, name = line.statement, line.name
    near = _near(line)
    least, most = name.spec.waypoints
    given = len(statement.waypoints)
    if given < least or (most is not None and given > most):
        if given == 0:
            labels = line.values.labels(line.robot.joint_names)
            message = f"{name.spec.name} takes {len(labels)} values ({' '.join(labels)}), none is given"
            line.findings.add("Y0401", message, statement.head_span, _example(name))
            return ()
        wanted = "one waypoint" if most == 1 else f"{least} or more waypoints"
        place = statement.waypoints[min(given, most or given) - 1 if given < least else least].place
        message = f"{name.spec.name} takes {wanted}, {given} {'is' if given == 1 else 'are'} given"
        line.findings.add("Y0405", message, statement.span(place), _example(name))
    goals: list[object] = []
    for number, waypoint in enumerate(statement.waypoints, 1):
        values = _values(line, number)
        goal = _named_goal(line, waypoint, values, frames)
        if goal is None:
            if _is_strange(line, waypoint, values):
                continue
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
    """Return the joint position (n,) [rad or m] of the option NEAR, which selects an inverse kinematics
    solution; None without NEAR.
    """
    for option in line.statement.options:
        if option.word.name != "NEAR":
            continue
        span = line.statement.span((option.argument or option.word).place)
        of_joints = line.values.of_joints and not named_poses(line)
        if of_joints or line.name.spec.targets.get("") is not Values.JOINTS:
            message = "NEAR is allowed only with a pose as target: MOVEJ_RPY, MOVEJ_QUAT and their profiles"
            line.findings.add("Y0412", message, span, "remove it")
        elif not isinstance(word := option.argument, Word):
            line.findings.add(
                "Y0412", "NEAR needs the name of a joint position", span, "for example NEAR HOME"
            )
        else:
            found = _joint_position(line, word)
            return None if found is None else found.q
    return None


def _named_goal(
    line: Line, waypoint: WayPoint, values: Values, frames: tuple[Frame, Frame] | None
) -> object | None:
    """Return the goal of a waypoint that is a name or an element of a table; None for any other waypoint.

    A command such as MOVEJ_RPY, whose values are poses, also accepts names of joint positions, because MOVEJ
    accepts joint values.

    Args:
        line: the command.
        waypoint: the waypoint.
        values: the kind of the waypoint's values.
        frames: the moving frame, and the frame of the values.
    """
    if (word := _one_word(waypoint)) is None and (place := _of_table(waypoint, line)) is None:
        return None
    found = line.scope.name(word.name) if word is not None else place
    if isinstance(found, Pose) and not values.is_delta and not line.name.spec.is_timed:
        if values is Values.POSITION:
            return constant(found.transform[:3, 3])
        # Without frames the command has an error, so this goal is never used.
        if frames is None:
            return PoseGoal(found.transform, _UNMOVED)
        moving, told = frames[0].link, None
        if found.told is not None and found.link is not None and moving is not None:
            told = Told(found.told, found.link, moving)
        return PoseGoal(found.transform, frames[0].transform, told=told)
    if word is None:
        span = line.statement.span(waypoint.place)
        if not isinstance(found, JointPosition) or not takes_names(line.name):
            message = f"{waypoint.values[0].text} is {KINDS[type(found)]}, and {line.name.full} takes none"
            line.findings.add("Y0209", message, span, _TAUGHT if isinstance(found, Taught) else "")
            return JointGoal(line.robot.home)
        return JointGoal(found.q)
    if not takes_names(line.name):
        return None
    position = _joint_position(line, word)
    return JointGoal(line.robot.home if position is None else position.q)


def _one_word(waypoint: WayPoint) -> Word | None:
    """Return the name if a waypoint is a single name; None for any other waypoint."""
    if len(waypoint.values) != 1 or not isinstance(word := waypoint.values[0], Word):
        return None
    return None if word.name in {"NAN", "INF", "INFINITY"} else word


def _of_table(waypoint: WayPoint, line: Line) -> Pose | JointPosition | None:
    """Return the pose or joint position of a waypoint that is a single table element, such as `SPOTS[2]`;
    None for any other waypoint.

    With a wrong index, add a finding and return the table's first element.
    """
    if len(waypoint.values) != 1 or not isinstance(value := waypoint.values[0], Computed):
        return None
    try:
        return place_named(value.expression, line.scope)
    except EvaluationError as error:
        line.findings.add_error(error, line.statement.span(error.place))
        found = meaning_of(value, line.scope)
        return found if isinstance(found, Pose | JointPosition) else None


def _is_strange(line: Line, waypoint: WayPoint, values: Values) -> bool:
    """Return True, and add a finding, if a waypoint of a Cartesian motion is an unknown name."""
    word = _one_word(waypoint)
    if word is None or values.is_delta or line.name.spec.is_timed or line.scope.name(word.name) is not None:
        return False
    known = sorted(set(line.scope.names(Pose)))
    subject = unknown(word.text, known)
    help_ = subject.question or (f"there are {', '.join(known)}" if known else "declare it by POSE")
    span = line.statement.span(word.place)
    line.findings.add("Y0205", f"no pose is named {word.text}", span, help_, subject=subject)
    return True


def _joint_position(line: Line, word: Word) -> JointPosition | None:
    found = line.scope.name(word.name)
    if isinstance(found, JointPosition):
        return found
    span = line.statement.span(word.place)
    if found is not None:
        message = f"{word.text} is {KINDS[type(found)]}, not a joint position"
        line.findings.add("Y0209", message, span, _TAUGHT if isinstance(found, Taught) else "")
        return None
    known = sorted(set(line.scope.names(JointPosition, Pose)))
    subject = unknown(word.text, known)
    help_ = f"{subject.question} there are {', '.join(known)}".lstrip()
    line.findings.add("Y0205", f"no joint position is named {word.text}", span, help_, subject=subject)
    return None


def _values(line: Line, number: int) -> Values:
    """Return the kind of values of a waypoint; waypoints are counted from 1."""
    leading = line.name.spec.leading
    return leading[number - 1] if number <= len(leading) else line.values


def _goal(
    line: Line, waypoint: WayPoint, numbers: Array, values: Values, frames: tuple[Frame, Frame] | None
) -> object | None:
    """Return the goal of a waypoint. Return None with a finding if the waypoint has an error, and None if
    the frames that it needs are missing.

    Args:
        line: the command.
        waypoint: the waypoint.
        numbers: the waypoint's values in SI.
        values: the kind of these values.
        frames: the moving frame, and the frame of the values.
    """
    statement, findings = line.statement, line.findings
    if values is Values.JOINTS:
        check_limits(line.robot, numbers, findings, statement.span(waypoint.place))
        return JointGoal(constant(numbers))
    if values is Values.JOINT_DELTAS:
        return JointDelta(constant(numbers))
    if values is Values.POSITION:
        return None if frames is None else constant((frames[1].transform @ np.append(numbers, 1.0))[:3])
    rotation = rotation_of(
        values,
        numbers[3:],
        findings,
        lambda: statement.span(from_to(waypoint.values[3].place, waypoint.values[-1].place)),
    )
    if rotation is None or frames is None:
        return None
    flange_from_moving, axes = frames[0].transform, frames[1]
    if values.is_delta:
        turned = np.abs(numbers[3:]).max() if not values.is_quaternion else 0.0
        cosine = (rotation.trace() - 1.0) / 2.0
        if turned >= np.pi - 1e-9 or cosine <= -1.0 + 1e-12:
            message = "an increment of half a turn or more has no shortest direction"
            findings.add("Y0409", message, statement.span(waypoint.place), "write two commands")
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
    """Return the numbers of a goal pose as written, and its frames; None if a frame isn't known."""
    moving, base = frames[0].link, frames[1].link
    return None if moving is None or base is None else Told(constant(numbers), base, moving)


_UNMOVED = np.eye(4)


def _example(name: ResolvedName) -> str:
    return f"for example: {name.spec.examples[0].splitlines()[0]}"


_TAUGHT = (
    "run the program, then write the line that `yarc registers` prints above the first command: motions "
    "are proved before they run"
)
