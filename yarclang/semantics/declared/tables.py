"""Carry out TABLE: declare a name for several numbers, poses or joint positions."""

from __future__ import annotations

from yarclang.commands.spec import Values
from yarclang.diagnostics import Collector
from yarclang.robot.model import Robot
from yarclang.semantics.context import Defaults
from yarclang.semantics.declared.meanings import base_of_line, may_be_declared, numbers_of_line, pose_of
from yarclang.semantics.names.scope import (
    JointPosition,
    Places,
    Scope,
    Table,
    Where,
)
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.values.amounts import Amount, AmountError
from yarclang.semantics.values.poses import check_limits
from yarclang.semantics.values.units import amount, number_fault, resolve_units
from yarclang.syntax.ast import Statement, Value, Word
from yarclang.syntax.leaves import from_to
from yarclang.transforms import constant
from yarclang.units import Unit


def declare_table(
    statement: Statement, scope: Scope, defaults: Defaults, robot: Robot, findings: Collector
) -> None:
    """Declare a table of numbers, such as TABLE HEIGHTS 10 20 30 (mm), or with several rows
    TABLE SPOTS 0 0; 60 0; 60 40 (mm).
    """
    rows = [waypoint.values for waypoint in statement.waypoints]
    word = rows[0][0] if rows else None
    kind = rows[0][1] if rows and len(rows[0]) > 1 else None
    if isinstance(word, Word) and isinstance(kind, Word) and kind.name in ("POSE", "JOINTS"):
        _declare_places(statement, word, kind.name, scope, defaults, robot, findings)
        return
    refuse_parts(statement, ("a moving frame", "a motion time", "a base frame", "options"), findings)
    if not isinstance(word, Word) or len(rows[0]) == 1:
        help_ = "write all numbers in this line, for example TABLE HEIGHTS 10 20 30 (mm)"
        findings.add("Y0401", "TABLE needs a name and numbers", statement.whole_span, help_)
        return
    if not may_be_declared(statement, word, scope, robot, findings):
        return
    rows[0] = rows[0][1:]
    # The name is declared even if the numbers have errors, so that its uses cause no further errors.
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
    """Declare a table of poses or joint positions.

    Examples are TABLE SPOTS POSE 60 40 150 0 0 0; 120 40 150 0 0 0 (mm,deg) {B} and
    TABLE STANDS JOINTS 0 0 0 0 0 0; 0 10 0 0 0 0 (deg).
    """
    of_joints = kind == "JOINTS"
    refused = ("a moving frame", "a motion time", "options", *(("a base frame",) if of_joints else ()))
    refuse_parts(statement, refused, findings)
    if not may_be_declared(statement, word, scope, robot, findings):
        return
    values = Values.JOINTS if of_joints else Values.POSE_RPY
    base = None if of_joints else base_of_line(statement, scope, defaults, findings, may_move=False)
    rows = [waypoint.values for waypoint in statement.waypoints]
    rows[0] = rows[0][2:]
    # The name is declared below even if there are errors, so that its uses cause no further errors.
    positions, poses = [], []
    for row in rows:
        numbers = numbers_of_line(statement, values, tuple(row), scope, defaults, robot, findings)
        if of_joints:
            if numbers is not None:
                check_limits(robot, numbers, findings, statement.span(from_to(row[0].place, row[-1].place)))
            positions.append(JointPosition(robot.home if numbers is None else constant(numbers)))
        else:
            poses.append(pose_of(statement, numbers, base, findings))
    where = Where(findings.source, statement.span(word.place))
    scope.declare(word.name, Places(tuple(positions) if of_joints else tuple(poses)), where)


def _rows_of(
    statement: Statement, rows: list[tuple[Value, ...]], scope: Scope, findings: Collector
) -> tuple[tuple[Amount, ...], ...]:
    """Return the numbers of a table; a wrong number is replaced by 1, with a finding."""
    units = list((resolve_units(statement, statement.units, findings) or {}).values())
    if len(units) > 1 and statement.units is not None:
        message = f"a table has one unit, {' and '.join(unit.name for unit in units)} are given"
        findings.add("Y0306", message, statement.span(statement.units.place), "write two tables")
    unit = units[0] if len(units) == 1 else None
    width = len(rows[0])
    for number, row in enumerate(rows):
        if len(row) != width:
            message = (
                f"row {number} of the table has {len(row)} value{'s' * (len(row) > 1)}, row 0 has {width}"
            )
            span = statement.span(from_to(row[0].place, row[-1].place))
            findings.add(
                "Y0458",
                message,
                span,
                "give all rows the same number of values; a semicolon begins a new row",
            )
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
