"""Declare frames, poses, joint positions and numbers, after a check of their names and values."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from yarclang.commands.registry import actions, commands
from yarclang.commands.spec import Values
from yarclang.diagnostics import Collector
from yarclang.hir import Array, FrameLink
from yarclang.robot.model import Robot
from yarclang.semantics.context import Defaults
from yarclang.semantics.files import values_of
from yarclang.semantics.names.frames import base_axes
from yarclang.semantics.names.scope import (
    BASE,
    Frame,
    JointPosition,
    Pose,
    Scope,
    Where,
)
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.values.amounts import Amount, AmountError, missing_unit
from yarclang.semantics.values.evaluate import EvaluationError, evaluate
from yarclang.semantics.values.poses import check_limits, rotation_of
from yarclang.semantics.values.units import amount, joint_kinds, number_fault, resolve_units
from yarclang.source import SourceFile
from yarclang.subjects import LeftOut
from yarclang.syntax.ast import FrameName, Statement, Value, Word
from yarclang.syntax.leaves import from_to
from yarclang.syntax.words import RESERVED
from yarclang.transforms import constant
from yarclang.units import Kind, Unit

FIXED_FRAMES = (BASE, "FLANGE", "TCP")
"""Frames that come from the robot and can't be declared."""

_INDEX = re.compile(r"P[0-9]+")


def is_word(name: str, *, of_pose: bool = False) -> bool:
    """Return True if a name can't be declared because it is a word of the language or looks like an index.

    Args:
        name: the name in upper case.
        of_pose: True for the name of a pose, which may look like an index.
    """
    action = actions().get(name)
    if name in RESERVED or name in commands() or (action is not None and not action.may_be_a_name):
        return True
    return not of_pose and _INDEX.fullmatch(name) is not None


def may_be_declared(
    statement: Statement,
    word: Word,
    scope: Scope,
    robot: Robot,
    findings: Collector,
    *,
    may_hide: bool = False,
    of_pose: bool = False,
) -> bool:
    """Return True if a name can be declared here; otherwise add a finding.

    Args:
        statement: the declaration.
        word: the name.
        scope: the names in scope at this line.
        robot: the robot.
        findings: receives the finding.
        may_hide: True to allow the name of one of the robot's joint positions without a warning.
        of_pose: True to allow P and digits.
    """
    span, name = statement.span(word.place), word.name
    if is_word(name, of_pose=of_pose):
        findings.add("Y0211", f"{word.text} is a word of the language", span, "choose another name")
        return False
    if "." in name:
        findings.add(
            "Y0211", f"{word.text}: a declared name can't contain a point", span, "choose another name"
        )
        return False
    found = scope.name(name)
    of_robot = isinstance(found, JointPosition) and found.q is robot.positions.get(name)
    if found is not None and not of_robot:
        message = declared_already(name, scope.where(name), findings.source)
        findings.add("Y0206", message, span, _another_name(word.text, scope.where(name)))
        return False
    if of_robot and not may_hide:
        message = f"{name} is a joint position of {robot.name}, which this line hides under the same name"
        findings.add("Y0214", message, span, "choose another name")
    return True


def declared_already(name: str, where: Where | None, source: SourceFile) -> str:
    """Return the message that a name is declared already.

    Args:
        name: the name.
        where: place of the previous declaration; None if the name comes from the robot.
        source: the file with the new declaration.
    """
    return f"{name} is declared already" + (f", in {where.seen_from(source)}" if where else "")


def _another_name(text: str, where: Where | None) -> str:
    """Return the remedy for a name that is declared already.

    Args:
        text: the name as written now.
        where: place of the previous declaration; None if the name comes from the robot.
    """
    is_respelled = where is not None and text.strip("{} ") not in where.source.line(where.span.line)
    return "choose another name" + (": upper and lower case don't make names differ" if is_respelled else "")


def frame_may_be_declared(statement: Statement, frame: FrameName, scope: Scope, findings: Collector) -> bool:
    """Return True if a frame's name can be declared here; otherwise add a finding."""
    name, span = frame.name, statement.span(frame.place)
    if name in FIXED_FRAMES:
        message = f"{{{name}}} comes from the robot and can't be declared"
        findings.add("Y0211", message, span, "choose another name")
    elif scope.frame(name) is not None:
        message = declared_already(f"{{{name}}}", scope.where_frame(name), findings.source)
        findings.add("Y0206", message, span, _another_name(frame.text, scope.where_frame(name)))
    elif re.fullmatch(r"[A-Z_][A-Z0-9_]*", name) is None:
        help_ = "names have letters, digits and _"
        findings.add("Y0211", f"{frame.text} is no valid name of a frame", span, help_)
    else:
        return True
    return False


def declare_frame(
    statement: Statement, scope: Scope, defaults: Defaults, robot: Robot, findings: Collector
) -> None:
    """Declare a frame, such as FRAME {TABLE} 800 200 300 0 0 90 {B}, or by FRAME_QUAT."""
    refuse_parts(statement, ("a motion time", "options"), findings)
    example = "for example FRAME {TABLE} 800 200 300 0 0 90 (mm,deg) {B}"
    if statement.moving is None:
        findings.add(
            "Y0302",
            f"{statement.name.name} needs the frame that it declares",
            statement.head_span,
            example,
            subject=LeftOut("the frame that it declares"),
        )
        return
    name = statement.moving.name
    if not frame_may_be_declared(statement, statement.moving, scope, findings):
        return
    values = Values.POSE_QUAT if statement.name.name == "FRAME_QUAT" else Values.POSE_RPY
    numbers = numbers_of_line(
        statement, values, tuple(values_of(statement)), scope, defaults, robot, findings
    )
    base = base_of_line(statement, scope, defaults, findings)
    # The name is declared below even if there are errors, so that its uses cause no further errors.
    transform, on_flange, link = np.eye(4), False, None
    if base is not None:
        on_flange = base.on_flange
        if numbers is not None:
            rotation = rotation_of(values, numbers[3:], findings, lambda: statement.whole_span)
            if rotation is not None:
                transform[:3, :3], transform[:3, 3] = rotation, numbers[:3]
            place = findings.source, statement.whole_span
            link = FrameLink(name, constant(transform), base.link, *place, constant(numbers))
        transform = base.transform @ transform
    scope.declare_frame(name, Frame(constant(transform), on_flange, link))


def base_of_line(
    statement: Statement, scope: Scope, defaults: Defaults, findings: Collector, *, may_move: bool = True
) -> Frame | None:
    """Return the frame in which the values of a declaration are given: the frame in the line, or else the
    frame in DEFAULT.

    Args:
        statement: the declaration.
        scope: the names in scope at this line.
        defaults: the values of the DEFAULT line of its file.
        findings: receives the finding.
        may_move: True if a frame on the flange is allowed.

    Returns:
        None with a finding if the frame is missing or wrong.
    """
    if statement.base is not None:
        return base_axes(statement, statement.base, scope, may_move, findings)
    if defaults.base is not None and defaults.statement is not None:
        return base_axes(defaults.statement, defaults.base, defaults.scope, may_move, findings)
    word = statement.name.name
    help_ = "write it after the units, as {B}" + (", or {FLANGE} for a tool" if may_move else "")
    message, subject = (
        f"{'FRAME' if may_move else word} needs a base frame",
        LeftOut("the frame in which it is given"),
    )
    findings.add("Y0302", message, statement.head_span, help_, subject=subject)
    return None


def declare_joints(
    statement: Statement, scope: Scope, defaults: Defaults, robot: Robot, findings: Collector
) -> None:
    """Declare a joint position, such as JOINTS HOME 0 0 0 0 0 0 (deg)."""
    refuse_parts(statement, ("a moving frame", "a motion time", "a base frame", "options"), findings)
    values = values_of(statement)
    if not values or not isinstance(word := values[0], Word):
        help_ = "for example JOINTS PARK 0 0 0 0 0 0 (deg)"
        findings.add("Y0401", "JOINTS needs a name and joint values", statement.whole_span, help_)
        return
    if not may_be_declared(statement, word, scope, robot, findings, may_hide=True):
        return
    numbers = numbers_of_line(statement, Values.JOINTS, tuple(values[1:]), scope, defaults, robot, findings)
    if numbers is not None:
        check_limits(robot, numbers, findings, statement.whole_span)
    position = JointPosition(robot.home if numbers is None else constant(numbers))
    scope.declare(word.name, position, Where(findings.source, statement.span(word.place)))


def declare_pose(
    statement: Statement, scope: Scope, defaults: Defaults, robot: Robot, findings: Collector
) -> None:
    """Declare a pose, such as POSE PICK 120 40 0 0 0 90 (mm,deg) {TABLE}."""
    refuse_parts(statement, ("a moving frame", "a motion time", "options"), findings)
    values = values_of(statement)
    if not values or not isinstance(word := values[0], Word):
        help_ = "for example POSE PICK 120 40 0 0 0 90 (mm,deg) {TABLE}"
        message = "POSE needs a name and x y z roll pitch yaw"
        findings.add("Y0401", message, statement.whole_span, help_)
        return
    if not may_be_declared(statement, word, scope, robot, findings, of_pose=True):
        return
    numbers = numbers_of_line(statement, Values.POSE_RPY, tuple(values[1:]), scope, defaults, robot, findings)
    base = base_of_line(statement, scope, defaults, findings, may_move=False)
    # The name is declared even if the pose has errors, so that its uses cause no further errors.
    pose = pose_of(statement, numbers, base, findings)
    scope.declare(word.name, pose, Where(findings.source, statement.span(word.place)))


def joint_values(
    statement: Statement,
    values: tuple[Value, ...],
    scope: Scope,
    defaults: Defaults,
    robot: Robot,
    findings: Collector,
) -> Array | None:
    """Return the joint values of a declaration (n,) [rad or m]; None with a finding if they have an error."""
    return numbers_of_line(statement, Values.JOINTS, values, scope, defaults, robot, findings)


def declare_number(statement: Statement, scope: Scope, robot: Robot, findings: Collector) -> None:
    """Declare a number, such as LET PITCH = 60 (mm)."""
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    (word,) = values_of(statement)
    assert isinstance(word, Word)
    assert statement.expression is not None
    allowed = may_be_declared(statement, word, scope, robot, findings)
    try:
        found = evaluate(statement.expression, scope)
    except EvaluationError as error:
        findings.add_error(error, statement.span(error.place))
        found = Amount(1.0)
    if allowed:
        scope.declare(word.name, found, Where(findings.source, statement.span(word.place)))


def pose_of(statement: Statement, numbers: Array | None, base: Frame | None, findings: Collector) -> Pose:
    """Return a pose computed from its numbers; the identity if the numbers or the frame have errors.

    Args:
        statement: the declaration.
        numbers: (6,) x y z roll pitch yaw [m, rad].
        base: the frame in which they are given.
        findings: receives the findings.
    """
    transform = np.eye(4)
    if base is not None and numbers is not None:
        rotation = rotation_of(Values.POSE_RPY, numbers[3:], findings, lambda: statement.whole_span)
        if rotation is not None:
            transform[:3, :3], transform[:3, 3] = rotation, numbers[:3]
        transform = base.transform @ transform
    told = None if numbers is None else constant(numbers)
    return Pose(constant(transform), base.link if base is not None else None, told)


def numbers_of_line(
    statement: Statement,
    values: Values,
    given: tuple[Value, ...],
    scope: Scope,
    defaults: Defaults,
    robot: Robot,
    findings: Collector,
) -> Array | None:
    """Return the values of a declaration in SI; None with a finding if they have an error.

    Args:
        statement: the declaration.
        values: the kind of values that the declaration needs.
        given: the values in the text.
        scope: the names in scope at this line.
        defaults: the values of the DEFAULT line of its file.
        robot: the robot.
        findings: receives the finding.
    """
    units = resolve_units(statement, statement.units, findings)
    if units is None:
        return None
    units = {**defaults.units, **units}
    labels = values.labels(robot.joint_names)
    for value in given:
        fault = number_fault(value)
        if fault is not None:
            findings.add(fault[0], fault[1], statement.span(value.place), fault[2])
            return None
    if len(given) != len(labels):
        verb = "is" if len(given) == 1 else "are"
        message = (
            f"{statement.name.name} takes {len(labels)} values ({' '.join(labels)}), {len(given)} {verb} "
            "given"
        )
        missing = labels[len(given) :]
        help_ = f"write {' '.join(missing)} after them" if given else "write one for each after the name"
        if not missing:
            help_ = f"remove the last {len(given) - len(labels)}"
        where = from_to(given[0].place, given[-1].place) if given else None
        findings.add("Y0401", message, statement.span(where) if where else statement.whole_span, help_)
        return None
    numbers = np.empty(len(labels))
    for place, (value, kind) in enumerate(zip(given, values.kinds(joint_kinds(robot)), strict=True)):
        found = amount(value, scope, statement, findings)
        if found is None:
            return None
        try:
            numbers[place] = _in_si(found, kind, units)
        except AmountError as error:
            findings.add_error(error, statement.span(value.place))
            return None
    return numbers


def _in_si(found: Amount, kind: Kind | None, units: Mapping[Kind, Unit]) -> float:
    if kind is None:
        return found.plain("a part of a quaternion")
    unit = units.get(kind) or found.unit
    if unit is None:
        raise missing_unit(kind, f"the {kind}s")
    if found.unit is not None and found.unit.kind != kind:
        raise AmountError("Y0307", f"{found} is of the wrong kind: this value needs a unit of {kind}")
    return found.in_unit(unit) * unit.factor
