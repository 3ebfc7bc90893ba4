"""Declare the names of a cell.toml: at the CELL line that names the file or, for the cell that the command
line or yarc.toml gives, before the program's first line.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.cell.model import Cell
from yarclang.diagnostics import Collector, Diagnostic, has_errors
from yarclang.findings import CATALOGUE
from yarclang.frozen import frozen
from yarclang.hir import FrameLink, Output, Signal
from yarclang.robot.model import Robot
from yarclang.semantics.context import Context, GivenCell
from yarclang.semantics.declared.meanings import declared_already
from yarclang.semantics.declared.variables import Signals
from yarclang.semantics.names.scope import (
    Frame,
    Input,
    JointPosition,
    Named,
    RackTool,
    Scope,
    Where,
)
from yarclang.semantics.parts import refuse_parts
from yarclang.source import Span
from yarclang.syntax.ast import Statement, Text
from yarclang.transforms import constant


@frozen
class CellName:
    """The path of a CELL line, and its place in the text."""

    path: str
    span: Span


class Cells:
    """The cell of a program and its modules: all of them must name the same cell."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._told: set[str] = set()
        self.cell: Cell | None = None
        self._unread = False
        self.broken = False
        """True if a cell has errors; the program must not be planned then."""

    def begin(self, scope: Scope, signals: Signals, findings: Collector) -> list[Output]:
        """Declare the names of the cell that the command line or yarc.toml names.

        Args:
            scope: names of the program; the names of the cell are added.
            signals: signals of the program and its modules; the signals of the cell are added.
            findings: findings of the program.

        Returns:
            The outputs of the cell; empty without a given cell.
        """
        given = self._context.cell
        if given is None:
            return []
        findings.found += given.findings
        self.broken |= has_errors(given.loaded.diagnostics)
        cell = given.loaded.value
        if cell is None:
            self.broken = self._unread = True
            return []
        self._told.add(cell.source.name)
        self.cell = cell
        outputs, clashes = declare_cell(cell, scope, self._context.robot, signals)
        findings.found += clashes
        self.broken |= has_errors(clashes)
        return outputs

    def read(
        self, statement: Statement, scope: Scope, signals: Signals, findings: Collector, is_program: bool
    ) -> list[Output]:
        """Carry out a CELL line of the program or of a module.

        Args:
            statement: the line.
            scope: names of its file; the names of the cell are added.
            signals: signals of the program and its modules; the signals of the cell are added.
            findings: findings of the file.
            is_program: True for the program, False for a module.

        Returns:
            The outputs that the cell adds to the program.
        """
        line = read_cell_line(statement, findings)
        load = self._context.load_cell
        if line is not None and load is None:
            findings.add(
                "Y1302",
                "a CELL can't be read here: this text is not a file",
                line.span,
                "give the program as a file",
            )
        if line is None or load is None:
            self.broken = self._unread = True
            return []
        loaded = load(line.path, None if is_program else findings.source)
        given = self._context.cell
        if given is not None and loaded is not given.loaded:
            self._refuse(line, given, findings)
            return []
        if given is not None and is_program:
            return []  # its names were declared before the first line
        cell = loaded.value
        if cell is not None and self.cell is not None and cell is not self.cell:
            message = f"two cells are named: {self.cell.source.name} and {cell.source.name}"
            findings.add(
                "Y1373", message, line.span, "name the same cell file in the program and its modules"
            )
            self.broken = True
        is_new = cell is None or cell.source.name not in self._told
        if is_new:
            found = loaded.diagnostics
            findings.found += [
                one if one.source is not None else replace(one, source=findings.source, span=line.span)
                for one in found
            ]
            self.broken |= has_errors(found)
        if cell is None:
            self._unread = True
            return []
        self._told.add(cell.source.name)
        self.cell = self.cell or cell
        outputs, clashes = declare_cell(cell, scope, self._context.robot, signals)
        findings.found += clashes
        self.broken |= has_errors(clashes)
        return outputs if is_new else []

    def _refuse(self, line: CellName, given: GivenCell, findings: Collector) -> None:
        """Add a finding about a CELL line that doesn't name the given cell's file."""
        message = f"two cells are named: {line.path} by the CELL line, {given.path} by {given.giver}"
        findings.add("Y1373", message, line.span, f"remove the CELL line, or {given.remedy}")
        self.broken = True

    def without_followers(self, findings: list[Diagnostic]) -> list[Diagnostic]:
        """Return the findings. If a cell can't be read, findings about unknown names are dropped, since the
        cell may declare these names.
        """
        return [one for one in findings if not self._unread or CATALOGUE[one.code].need != "name"]


def read_cell_line(statement: Statement, findings: Collector) -> CellName | None:
    """Read a line such as CELL "cell.toml"; None with a finding if the line is wrong."""
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    values = [value for waypoint in statement.waypoints for value in waypoint.values]
    if len(values) != 1 or not isinstance(text := values[0], Text):
        message = "CELL takes the path of a cell.toml in quotes"
        findings.add("Y0401", message, statement.whole_span, 'for example CELL "cell.toml"')
        return None
    return CellName(text.text.strip('"'), statement.span(text.place))


def declare_cell(
    cell: Cell, scope: Scope, robot: Robot, signals: Signals
) -> tuple[list[Output], list[Diagnostic]]:
    """Declare the names of a cell.

    Args:
        cell: the cell.
        scope: receives the names.
        robot: the robot.
        signals: signals of the program and its modules; the signals of the cell are added.

    Returns:
        The outputs of the cell, and findings about names that are declared already, at their places in the
        cell's file.
    """
    findings: list[Diagnostic] = []
    outputs: list[Output] = []
    _declare_frames(cell, scope, findings)
    for (table, name), span in cell.places.items():
        if table == "frames":
            continue
        where, found = Where(cell.source, span), scope.name(name)
        of_robot = isinstance(found, JointPosition) and found.q is robot.positions.get(name)
        if found is not None and not of_robot:
            _clash(declared_already(name, scope.where(name), cell.source), where, findings)
            continue
        if of_robot and table != "joints":
            message = f"{name} is a joint position of {robot.name}, which this cell hides under the same name"
            findings.append(Diagnostic("Y0214", message, cell.source, span, "choose another name"))
        meaning = _meaning(cell, table, name, robot)
        scope.declare(name, meaning, where)
        match meaning:
            case Input(signal) if signal.variable:
                findings += signals.add("input", signal, None, where)
            case Output(signal, safe) if signal.variable:
                findings += signals.add("output", signal, safe, where)
                outputs.append(meaning)
    return outputs, findings


def _meaning(cell: Cell, table: str, name: str, robot: Robot) -> Named:
    """Return the meaning of a name in a cell. An entry with an error gets a default meaning, so that uses of
    the name cause no further errors.
    """
    match table:
        case "joints":
            return JointPosition(cell.joints.get(name, robot.home))
        case "tools":
            lock, locks_at = next(
                (Signal(other, one.variable), one.grip.value)
                for other, one in cell.outputs.items()
                if one.grip is not None and one.grip.changes
            )
            return RackTool(name, lock, locks_at)
        case "inputs":
            return Input(Signal(name, cell.inputs.get(name, "")))
        case _:
            found = cell.outputs.get(name)
            return Output(Signal(name, found.variable if found else ""), found.safe if found else None)


def _declare_frames(cell: Cell, scope: Scope, findings: list[Diagnostic]) -> None:
    for name, frame in cell.frames.items():  # parents first
        span = cell.places["frames", name]
        if (other := scope.frame(name)) is not None:
            message = declared_already(f"{{{name}}}", scope.where_frame(name), cell.source)
            if other.link is None or other.link.source is None:
                message = f"{{{name}}} is a frame of the robot already"
            _clash(message, Where(cell.source, span), findings)
            continue
        parent = scope.frame(frame.parent)
        link = FrameLink(
            name, frame.parent_from_frame, parent.link if parent else None, cell.source, span, frame.told
        )
        scope.declare_frame(name, Frame(frame.mount.transform, frame.mount.on_flange, link))
    for table, name in cell.places:
        if table == "frames" and scope.frame(name) is None:
            scope.declare_frame(name, Frame(constant(np.eye(4)), on_flange=False))


def _clash(message: str, where: Where, findings: list[Diagnostic]) -> None:
    findings.append(Diagnostic("Y0206", message, where.source, where.span, "choose another name"))
