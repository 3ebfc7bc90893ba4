"""The cell, the inputs and the outputs of a robot, as its coordinator knows them: from the last program, and
from the declarations of the session. No I/O.
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
    """The path of the cell's file (`cell`; None if there is no cell), and the controller variables of inputs
    and outputs.

    `inputs` and `outputs` map the name of each signal to its variable.
    """

    cell: str | None
    inputs: Mapping[str, str]
    outputs: Mapping[str, str]


class Around:
    """Stores the cell, the inputs and the outputs of the last program and of the session.

    If both declare the same name, the program's declaration counts.

    Args:
        names: names that the session declares.
        lines: lines of the session. Their revision grows with each change of the declarations.
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
        """Return True if the session's lines haven't changed since the last call of `look`."""
        return self._revision == self._lines.revision

    def know(self, program: Program | None, cell: Cell | None) -> None:
        """Store the cell, the inputs and the outputs of a program that is about to run.

        Args:
            program: program that declares the inputs and outputs; None if only its controller text is known.
            cell: cell of the program.
        """
        self._known = known_in(program, cell)
        self._cell = _file(cell)
        self._program_cell = None if cell is None else replace(cell, present=None)

    @property
    def cells(self) -> tuple[Cell | None, Cell | None]:
        """Return the cell of the last program and the cell of the session, each None if there is none.

        The parts are in the places that the cells' files give, which may differ from their present places.
        The session's cell is None before the first call of `look`.
        """
        return self._program_cell, self._session_cell

    def look(self) -> Seen:
        """Return the cell, the inputs and the outputs of the last program and of the session.

        The session's lines are read again if they have changed since the last call.
        """
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
            # If the cell's file can't be read now, motions still respect the cell that was read before.
            if program is not None:
                self._session_cell = program.cell
            cell = _file(self._session_cell)
            self._session = Seen(cell, inputs, outputs)
            self._revision = revision
        own, known = self._session, self._known
        return Seen(self._cell or own.cell, {**own.inputs, **known.inputs}, {**own.outputs, **known.outputs})


def _file(cell: Cell | None) -> str | None:
    return None if cell is None else str(Path(cell.source.name).absolute())
