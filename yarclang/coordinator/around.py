"""The surroundings of a robot as known to its coordinator: the cell, and inputs and outputs by name. No
I/O.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from yarclang.cell.model import Cell
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.names import Names
from yarclang.hir import Output, Program
from yarclang.semantics.names.scope import Input
from yarclang.simulated_cell.script import Known, known_in


@dataclass(frozen=True, slots=True)
class Seen:
    """File of the cell, and the controller's variables for inputs and outputs by their names."""

    cell: str | None
    inputs: Mapping[str, str]
    outputs: Mapping[str, str]


class Around:
    """Cell, inputs and outputs of the last program, together with those of the session.

    Args:
        names: names of the session.
        lines: lines of the session. Their revision changes when a name may have changed.
    """

    def __init__(self, names: Names, lines: Lines) -> None:
        self._names = names
        self._lines = lines
        self._session = Seen(None, {}, {})
        self._revision = -1
        self._known = Known({}, {})
        self._cell: str | None = None
        self._program_cell: Cell | None = None
        self._session_cell: Cell | None = None

    @property
    def is_current(self) -> bool:
        """Return True if nothing has changed since the last `look`."""
        return self._revision == self._lines.revision

    def know(self, program: Program | None, cell: Cell | None) -> None:
        """Store the surroundings of a program that is about to run.

        Args:
            program: the program with the names; None if only its text is known.
            cell: the cell of the program.
        """
        self._known = known_in(program, cell)
        self._cell = _file(cell)
        self._program_cell = None if cell is None else replace(cell, present=None)

    @property
    def cells(self) -> tuple[Cell | None, Cell | None]:
        """Return the cells of the last program and of the session, as they were read. None: there is no cell,
        or it isn't known before `look`.
        """
        return self._program_cell, self._session_cell

    def look(self) -> Seen:
        """Return the surroundings. The lines of the session are read again after a new declaration."""
        if not self.is_current:
            revision = self._lines.revision
            scope = self._names.scope()
            inputs: dict[str, str] = {}
            outputs: dict[str, str] = {}
            for name in scope.names(Input, Output):
                meaning = scope.name(name)
                if isinstance(meaning, Input):
                    inputs |= {bit.name: bit.variable for bit in meaning.signal.bits}
                elif isinstance(meaning, Output):
                    outputs |= {bit.name: bit.variable for bit in meaning.signal.bits}
            program = self._names.cell().value
            # If the cell can't be read any more, motions still respect the one that was read before.
            if program is not None:
                self._session_cell = program.cell
            cell = _file(self._session_cell)
            self._session = Seen(cell, inputs, outputs)
            self._revision = revision
        own, known = self._session, self._known
        return Seen(self._cell or own.cell, {**own.inputs, **known.inputs}, {**own.outputs, **known.outputs})


def _file(cell: Cell | None) -> str | None:
    return None if cell is None else str(Path(cell.source.name).absolute())
