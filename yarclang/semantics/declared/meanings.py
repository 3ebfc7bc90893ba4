"""Giving names a meaning: what may be declared, and values of declarations."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from yarclang.commands.registry import actions, commands
from yarclang.commands.spec import Values
from yarclang.decisions import DECIMALS, MOST_BITS, group_of, is_group, is_printed, largest_of
from yarclang.diagnostics import Collector
from yarclang.hir import Array, FrameLink, Output, Signal
from yarclang.robot.model import Robot
from yarclang.semantics.context import Defaults
from yarclang.semantics.declared.variables import Signals
from yarclang.semantics.files import values_of
from yarclang.semantics.names.frames import base_axes
from yarclang.semantics.names.scope import (
    BASE,
    Frame,
    Input,
    JointPosition,
    Places,
    Pose,
    Scope,
    Table,
    Where,
)
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.values.amounts import Amount, AmountError, missing_unit
from yarclang.semantics.values.evaluate import EvaluationError, evaluate
from yarclang.semantics.values.poses import check_limits, rotation_of
from yarclang.semantics.values.steps import steps_of
from yarclang.semantics.values.units import amount, joint_kinds, number_fault, resolve_units
from yarclang.source import SourceFile
from yarclang.subjects import LeftOut
from yarclang.syntax.ast import FrameName, Statement, Value, Word
from yarclang.syntax.leaves import from_to
from yarclang.syntax.words import RESERVED
from yarclang.transforms import constant
from yarclang.units import Kind, Unit

FIXED_FRAMES = (BASE, "FLANGE", "TCP")
"""They come from the robot."""

_INDEX = re.compile(r"P[0-9]+")
_GROUP = re.compile(r"([A-Z]+)([0-9]{1,6})\.\.([A-Z]+)([0-9]{1,6})")


def is_word(name: str, *, of_pose: bool = False) -> bool:
    """Return True if a name in upper case has its meaning in the language already; that of a pose may look like an index."""
    if name in RESERVED or name in commands() or name in actions():
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
    """Whether a name can be given a meaning here; a finding says why it can't.

    With `may_hide` it may be that of a joint position of the robot without a warning, with `of_pose` P and digits.
    """
    span, name = statement.span(word.place), word.name
    if is_word(name, of_pose=of_pose):
        findings.add("Y0211", f"{word.text} is a word of the language", span, "choose another name")
        return False
    if "." in name:
        findings.add("Y0211", f"{word.text}: a name has no point in it", span, "choose another name")
        return False
    found = scope.name(name)
    of_robot = isinstance(found, JointPosition) and found.q is robot.positions.get(name)
    if found is not None and not of_robot:
        message = declared_already(name, scope.where(name), findings.source)
        findings.add("Y0206", message, span, "choose another name")
        return False
    if of_robot and not may_hide:
        message = f"{name} is a joint position of {robot.name}, and means something else from here on"
        findings.add("Y0214", message, span, "choose another name")
    return True


def declared_already(name: str, where: Where | None, source: SourceFile) -> str:
    """What is said, in `source`, of a name that has a meaning."""
    return f"{name} is declared already" + (f", in {where.seen_from(source)}" if where else "")


def frame_may_be_declared(statement: Statement, frame: FrameName, scope: Scope, findings: Collector) -> bool:
    """Whether a frame's name can be given a meaning here; a finding says why it can't."""
    name, span = frame.name, statement.span(frame.place)
    if name in FIXED_FRAMES:
        message = f"{{{name}}} comes from the robot and can't be declared"
        findings.add("Y0211", message, span, "choose another name")
    elif scope.frame(name) is not None:
        message = declared_already(f"{{{name}}}", scope.where_frame(name), findings.source)
        findings.add("Y0206", message, span, "choose another name")
    elif re.fullmatch(r"[A-Z_][A-Z0-9_]*", name) is None:
        help_ = "names have letters, digits and _"
        findings.add("Y0211", f"{frame.text} is no name of a frame", span, help_)
    else:
        return True
    return False


def declare_frame(
    statement: Statement, scope: Scope, defaults: Defaults, robot: Robot, findings: Collector
) -> None:
    """FRAME {TABLE} 800 200 300 0 0 90 {B}, and FRAME_QUAT."""
    refuse_parts(statement, ("a motion time", "options"), findings)
    example = "for example FRAME {TABLE} 800 200 300 0 0 90 (mm,deg) {B}"
    if statement.moving is None:
        findings.add(
            "Y0302",
            f"{statement.name.name} doesn't say which frame it declares",
            statement.head_span,
            example,
            subject=LeftOut("the frame that it declares"),
        )
        return
    name = statement.moving.name
    if not frame_may_be_declared(statement, statement.moving, scope, findings):
        return
    values = Values.POSE_QUAT if statement.name.name == "FRAME_QUAT" else Values.POSE_RPY
    numbers = _numbers(statement, values, tuple(values_of(statement)), scope, defaults, robot, findings)
    base = _base(statement, scope, defaults, findings)
    # whatever is wrong with it, the name is known: what uses it isn't wrong as well
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


def _base(
    statement: Statement, scope: Scope, defaults: Defaults, findings: Collector, *, may_move: bool = True
) -> Frame | None:
    if statement.base is not None:
        return base_axes(statement, statement.base, scope, may_move, findings)
    if defaults.base is not None and defaults.statement is not None:
        return base_axes(defaults.statement, defaults.base, defaults.scope, may_move, findings)
    word = statement.name.name
    help_ = "write it behind the units, as {B}" + (", or {FLANGE} for a tool" if may_move else "")
    message, subject = (
        f"{'FRAME' if may_move else word} doesn't say in which frame it is given",
        LeftOut("the frame in which it is given"),
    )
    findings.add("Y0302", message, statement.head_span, help_, subject=subject)
    return None


def declare_joints(
    statement: Statement, scope: Scope, defaults: Defaults, robot: Robot, findings: Collector
) -> None:
    """JOINTS HOME 0 0 0 0 0 0 (deg)."""
    refuse_parts(statement, ("a moving frame", "a motion time", "a base frame", "options"), findings)
    values = values_of(statement)
    if not values or not isinstance(word := values[0], Word):
        help_ = "for example JOINTS PARK 0 0 0 0 0 0 (deg)"
        findings.add("Y0401", "JOINTS wants a name and joint values", statement.whole_span, help_)
        return
    if not may_be_declared(statement, word, scope, robot, findings, may_hide=True):
        return
    numbers = _numbers(statement, Values.JOINTS, tuple(values[1:]), scope, defaults, robot, findings)
    if numbers is not None:
        check_limits(robot, numbers, findings, statement.whole_span)
    position = JointPosition(robot.home if numbers is None else constant(numbers))
    scope.declare(word.name, position, Where(findings.source, statement.span(word.place)))


def declare_pose(
    statement: Statement, scope: Scope, defaults: Defaults, robot: Robot, findings: Collector
) -> None:
    """POSE PICK 120 40 0 0 0 90 (mm,deg) {TABLE}."""
    refuse_parts(statement, ("a moving frame", "a motion time", "options"), findings)
    values = values_of(statement)
    if not values or not isinstance(word := values[0], Word):
        help_ = "for example POSE PICK 120 40 0 0 0 90 (mm,deg) {TABLE}"
        message = "POSE wants a name and x y z roll pitch yaw"
        findings.add("Y0401", message, statement.whole_span, help_)
        return
    if not may_be_declared(statement, word, scope, robot, findings, of_pose=True):
        return
    numbers = _numbers(statement, Values.POSE_RPY, tuple(values[1:]), scope, defaults, robot, findings)
    base = _base(statement, scope, defaults, findings, may_move=False)
    # whatever is wrong with it, the name is known: what uses it isn't wrong as well
    pose = _pose_of(statement, numbers, base, findings)
    scope.declare(word.name, pose, Where(findings.source, statement.span(word.place)))


def joint_values(
    statement: Statement,
    values: tuple[Value, ...],
    scope: Scope,
    defaults: Defaults,
    robot: Robot,
    findings: Collector,
) -> Array | None:
    """Joint values of a declaration as a joint position (n,) [rad or m]."""
    return _numbers(statement, Values.JOINTS, values, scope, defaults, robot, findings)


def declare_number(statement: Statement, scope: Scope, robot: Robot, findings: Collector) -> None:
    """LET PITCH = 60 (mm)."""
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


def declare_table(
    statement: Statement, scope: Scope, defaults: Defaults, robot: Robot, findings: Collector
) -> None:
    """TABLE HEIGHTS 10 20 30 (mm), and TABLE SPOTS 0 0; 60 0; 60 40 (mm)."""
    rows = [waypoint.values for waypoint in statement.waypoints]
    word = rows[0][0] if rows else None
    kind = rows[0][1] if rows and len(rows[0]) > 1 else None
    if isinstance(word, Word) and isinstance(kind, Word) and kind.name in ("POSE", "JOINTS"):
        _declare_places(statement, word, kind.name, scope, defaults, robot, findings)
        return
    refuse_parts(statement, ("a moving frame", "a motion time", "a base frame", "options"), findings)
    if not isinstance(word, Word) or len(rows[0]) == 1:
        help_ = "for example TABLE HEIGHTS 10 20 30 (mm)"
        findings.add("Y0401", "TABLE wants a name and numbers", statement.whole_span, help_)
        return
    if not may_be_declared(statement, word, scope, robot, findings):
        return
    rows[0] = rows[0][1:]
    # whatever is wrong with it, the name is known: what uses it isn't wrong as well
    numbers = _rows_of(statement, rows, scope, findings)
    scope.declare(word.name, Table(numbers), Where(findings.source, statement.span(word.place)))


def _declare_places(
    statement: Statement,
    word: Word,
    kind: str,
    scope: Scope,
    defaults: Defaults,
    robot: Robot,
    findings: Collector,
) -> None:
    """TABLE SPOTS POSE 60 40 150 0 0 0; 120 40 150 0 0 0 (mm,deg) {B}, and TABLE STANDS JOINTS 0 0 0 0 0 0; 0 10 0 0 0 0 (deg)."""
    of_joints = kind == "JOINTS"
    refused = ("a moving frame", "a motion time", "options", *(("a base frame",) if of_joints else ()))
    refuse_parts(statement, refused, findings)
    if not may_be_declared(statement, word, scope, robot, findings):
        return
    values = Values.JOINTS if of_joints else Values.POSE_RPY
    base = None if of_joints else _base(statement, scope, defaults, findings, may_move=False)
    rows = [waypoint.values for waypoint in statement.waypoints]
    rows[0] = rows[0][2:]
    # whatever is wrong with it, the name is known: what uses it isn't wrong as well
    positions, poses = [], []
    for row in rows:
        numbers = _numbers(statement, values, tuple(row), scope, defaults, robot, findings)
        if of_joints:
            if numbers is not None:
                check_limits(robot, numbers, findings, statement.span(from_to(row[0].place, row[-1].place)))
            positions.append(JointPosition(robot.home if numbers is None else constant(numbers)))
        else:
            poses.append(_pose_of(statement, numbers, base, findings))
    where = Where(findings.source, statement.span(word.place))
    scope.declare(word.name, Places(tuple(positions) if of_joints else tuple(poses)), where)


def _pose_of(statement: Statement, numbers: Array | None, base: Frame | None, findings: Collector) -> Pose:
    """A pose of x y z roll pitch yaw (6,) in a frame; the unit pose where one of both isn't known."""
    transform = np.eye(4)
    if base is not None and numbers is not None:
        rotation = rotation_of(Values.POSE_RPY, numbers[3:], findings, lambda: statement.whole_span)
        if rotation is not None:
            transform[:3, :3], transform[:3, 3] = rotation, numbers[:3]
        transform = base.transform @ transform
    told = None if numbers is None else constant(numbers)
    return Pose(constant(transform), base.link if base is not None else None, told)


def _rows_of(
    statement: Statement, rows: list[tuple[Value, ...]], scope: Scope, findings: Collector
) -> tuple[tuple[Amount, ...], ...]:
    """The numbers of a table; 1 stands for each that is wrong."""
    units = list((resolve_units(statement, statement.units, findings) or {}).values())
    if len(units) > 1 and statement.units is not None:
        message = f"a table has one unit, {' and '.join(unit.name for unit in units)} are given"
        findings.add("Y0306", message, statement.span(statement.units.place), "make two tables of it")
    unit = units[0] if len(units) == 1 else None
    width = len(rows[0])
    for number, row in enumerate(rows):
        if len(row) != width:
            message = (
                f"row {number} of the table has {len(row)} value{'s' * (len(row) > 1)}, row 0 has {width}"
            )
            span = statement.span(from_to(row[0].place, row[-1].place))
            findings.add("Y0458", message, span, "give all rows as many; a semicolon begins a new row")
            return ((Amount(1.0, unit),) * width,) * len(rows)
    return tuple(
        tuple(_table_value(value, unit, scope, statement, findings) for value in row) for row in rows
    )


def _table_value(
    value: Value, unit: Unit | None, scope: Scope, statement: Statement, findings: Collector
) -> Amount:
    span = statement.span(value.place)
    if (fault := number_fault(value)) is not None:
        findings.add(fault[0], fault[1], span, fault[2])
        return Amount(1.0, unit)
    found = amount(value, scope, statement, findings)
    if found is None:
        return Amount(1.0, unit)
    if unit is None or found.unit is unit:
        return found
    try:
        return Amount(found.in_unit(unit), unit)
    except AmountError as error:
        findings.add_error(error, span)
        return Amount(1.0, unit)


def declare_signal(
    statement: Statement, scope: Scope, robot: Robot, signals: Signals, findings: Collector
) -> tuple[Output, ...]:
    """INPUT DOOR M11, OUTPUT GLUE M1 OFF, INPUT JOB M70..M77; outputs are given back, of a group each bit."""
    kind = statement.name.name
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    values = values_of(statement)
    step, values = _step(values, scope, statement, findings)
    most = 3 if kind == "OUTPUT" else 2
    words = values[:2]
    if not 2 <= len(values) <= most or not all(isinstance(value, Word) for value in words):
        example = "INPUT DOOR M11" if kind == "INPUT" else "OUTPUT GLUE M1 OFF"
        message = f"{kind} wants a name and the controller's variable"
        findings.add("Y0401", message, statement.whole_span, f"for example {example}")
        return ()
    word, variable = words
    assert isinstance(word, Word)
    assert isinstance(variable, Word)
    if not may_be_declared(statement, word, scope, robot, findings):
        return ()
    found = _variables(variable, statement, robot, findings)
    if not found:
        return ()
    signal = Signal(word.name, group_of(found))
    where = Where(findings.source, statement.span(word.place))
    if step is not None and not is_group(signal.variable):
        message = f"{word.text} is a single bit, and has no steps"
        findings.add("Y0470", message, statement.span(variable.place), "name a group of bits, as M80..M91")
        step = None
    if kind == "INPUT":
        scope.declare(word.name, Input(signal, step), where)
        # of a group one bit that is another's says it all
        findings.found += [one for bit in signal.bits for one in signals.add("input", bit, None, where)][:1]
        return ()
    safe = state_value(values[2], scope, statement, findings) if len(values) == 3 else None
    if safe is not None and step is not None:
        try:
            safe = steps_of(safe, step, word.text)
        except AmountError as error:
            findings.add_error(error, statement.span(values[2].place))
            safe = None
    if safe is not None and (fault := group_fault(signal, safe)):
        findings.add("Y0470", fault, statement.span(values[2].place), "check the number, or the bits")
        safe = None
    scope.declare(word.name, Output(signal, safe, step), where)
    outputs = tuple(
        Output(bit, safe if not is_group(signal.variable) or safe is None else float(int(safe) >> place & 1))
        for place, bit in enumerate(signal.bits)
    )
    findings.found += [
        found for one in outputs for found in signals.add("output", one.signal, one.safe, where)
    ][:1]
    return outputs


def _step(
    values: list[Value], scope: Scope, statement: Statement, findings: Collector
) -> tuple[float | None, list[Value]]:
    """Return what STEP says of an analogue signal, and the values without it."""
    place = next((at for at, one in enumerate(values) if isinstance(one, Word) and one.name == "STEP"), None)
    if place is None or place < 2:
        return None, values
    rest = [*values[:place], *values[place + 2 :]]
    number = state_value(values[place + 1], scope, statement, findings) if place + 1 < len(values) else None
    if number is None or number <= 0.0:
        message = "STEP wants how much one step is, above 0"
        findings.add(
            "Y0472",
            message,
            statement.span(values[place].place),
            "for example INPUT PRESSURE M80..M91 STEP 0.01",
        )
        return None, rest
    return number, rest


def group_fault(signal: Signal, number: float) -> str:
    """Return why a group can't be a number; empty if it can, or if it is a single signal."""
    if not is_group(signal.variable):
        return ""
    largest = largest_of(signal.variable)
    if number.is_integer() and 0 <= number <= largest:
        return ""
    return f"{signal.name} has {len(signal.bits)} bits: it is an integer from 0 to {largest}, and never {number:.15g}"


def _variables(word: Word, statement: Statement, robot: Robot, findings: Collector) -> tuple[str, ...]:
    """Return the controller's variables that a word names: M11, or M70..M77; none with a finding if it names none."""
    span = statement.span(word.place)
    names = [word.name]
    if ".." in word.name:
        group = _GROUP.fullmatch(word.name)
        first, last = (int(group[2]), int(group[4])) if group is not None else (0, 0)
        if group is None or group[1] != group[3] or not first < last < first + MOST_BITS:
            message = f"{word.text} is no group: it has 2 to {MOST_BITS} variables of one letter, the lowest bit first"
            findings.add("Y0470", message, span, "for example INPUT JOB M70..M77")
            return ()
        names = [f"{group[1]}{number}" for number in range(first, last + 1)]
    found: list[str] = []
    for name in names:
        one = robot.controller.signal(name)
        if one.name is None:
            text = word.text if len(names) == 1 else f"{name} of {word.text}"
            findings.add("Y0413", f"{text} {one.fault}", span, one.remedy)
            return ()
        found.append(one.name)
    return tuple(found)


def state_value(value: Value, scope: Scope, statement: Statement, findings: Collector) -> float | None:
    """ON, OFF or a plain number."""
    if isinstance(value, Word) and value.name in ("ON", "OFF"):
        return float(value.name == "ON")
    span = statement.span(value.place)
    if (fault := number_fault(value)) is not None:
        findings.add("Y0402", f"`{value.text}` is neither ON nor OFF nor a number", span, fault[2])
        return None
    found = amount(value, scope, statement, findings)
    if found is None:
        return None
    try:
        number = found.plain("the value of an input or output")
    except AmountError as error:
        findings.add_error(error, span)
        return None
    if not is_printed(number):
        message = f"{number:.15g} has more than {DECIMALS} decimals, and a text has no more"
        findings.add("Y0434", message, span, f"round it: {round(number, DECIMALS):.15g}")
        return None
    return number


def _numbers(
    statement: Statement,
    values: Values,
    given: tuple[Value, ...],
    scope: Scope,
    defaults: Defaults,
    robot: Robot,
    findings: Collector,
) -> Array | None:
    """The values of a declaration in SI."""
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
        message = f"{statement.name.name} wants {len(labels)} values ({' '.join(labels)}), {len(given)} {verb} given"
        findings.add("Y0401", message, statement.whole_span)
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
        raise AmountError("Y0307", f"{found} is of the wrong kind: a unit of {kind} is wanted here")
    return found.in_unit(unit) * unit.factor
