"""The buffers of the controller: what they contain, and which of them a port has open (TSRM 295, 381; TUM
337).
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence

from yarclang.pmac.errors import BUFFER_IN_USE, BUSY_PROGRAM, DATA, NO_ROOM, STRUCTURE
from yarclang.simulator.language.statements import LAST_PLC, Statement
from yarclang.simulator.motion.system import CoordinateSystem
from yarclang.simulator.network.ports import Port
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.programs.plc import Plc
from yarclang.simulator.programs.plcs import Plcs
from yarclang.simulator.programs.program import LARGEST_PROGRAM, Program, Rotary, line_of

_MOST_PROGRAMS = 224


class Buffers:
    """PROG, PLC and rotary buffers.

    Attributes:
        programs: PROG buffers by number.
        gathering: True if there is a gather buffer.
    """

    def __init__(
        self,
        systems: Mapping[int, CoordinateSystem],
        plcs: Plcs,
        ports: Mapping[int, Port],
        variables: list[float],
    ) -> None:
        self.programs: dict[int, Program] = {}
        self.gathering = False
        self._systems = systems
        self._plcs = plcs
        self._ports = ports
        self._variables = variables

    def forget(self) -> None:
        """Discard all programs and PLCs, as at power-up."""
        self.programs.clear()
        self._plcs.by_number.clear()
        self.gathering = False

    def open(self, port: Port, kind: str, number: int) -> None:
        """Execute OPEN (TSRM 381).

        Args:
            port: the port that opens the buffer.
            kind: "prog", "plc" or "rotary".
            number: number of the PROG or PLC.

        Raises:
            Refusal: ERR007 while another buffer is open; ERR001 for a PROG while a program runs; ERR003 for a
                number that isn't allowed, or if there is no rotary; ERR006 if there are too many programs.
        """
        if any(other.open for other in self._ports.values()):
            raise Refusal(BUFFER_IN_USE)
        match kind:
            case "prog":
                if any(system.busy for system in self._systems.values()):
                    raise Refusal(BUSY_PROGRAM)
                if not 1 <= number <= 32767:
                    raise Refusal(DATA)
                if number not in self.programs and len(self.programs) >= _MOST_PROGRAMS:
                    raise Refusal(NO_ROOM)
                self.programs.setdefault(number, Program())
            case "plc":
                if number > LAST_PLC:
                    raise Refusal(DATA)
                self._plcs.by_number.setdefault(number, Plc(number)).disable()
                self._plcs.changed()
            case _:
                if not any(system.calculation.rotary for system in self._systems.values()):
                    raise Refusal(DATA)
        port.open, port.number = kind, number

    def close(self, port: Port | None) -> None:
        """Execute CLOSE for one port, or for all ports (None).

        Raises:
            Refusal: ERR009 if the closed buffer has an IF or a WHILE without an end.
        """
        unfinished = False
        for each in [port] if port is not None else list(self._ports.values()):
            if program := self._open_program(each):
                unfinished = unfinished or bool(program.open_blocks)
            each.open = ""
        self._plcs.changed()
        if unfinished:
            raise Refusal(STRUCTURE)

    def release(self, port: Port) -> None:
        """Close the buffer that a port has open, without checking its structure."""
        with contextlib.suppress(Refusal):
            self.close(port)

    def clear(self, port: Port) -> None:
        """Execute CLEAR for the buffer that a port has open."""
        if program := self._open_program(port):
            program.clear()
            for system in self._systems.values():
                if port.open == "prog" and system.calculation.number == port.number:
                    system.calculation.point_to(port.number)
        elif rotary := self._systems[port.system].calculation.rotary:
            rotary.clear()
            self._systems[port.system].calculation.rotary_gone()

    def clear_plcs(self, numbers: Sequence[int] | None) -> None:
        """Execute CLEAR PLC n, or CLEAR ALL (None), which also clears all PROGs."""
        if numbers is None:
            if any(system.busy for system in self._systems.values()):
                raise Refusal(BUSY_PROGRAM)
            self.programs.clear()
        for number in list(self._plcs.by_number) if numbers is None else numbers:
            self._plcs.by_number.pop(number, None)
        for port in self._ports.values():
            port.open = "" if port.open in ("prog", "plc") else port.open
        self._plcs.changed()

    def store(self, port: Port, text: str, statements: tuple[Statement, ...]) -> None:
        """Store a line in the open buffer of a port.

        Args:
            port: the port.
            text: the line.
            statements: the statements of the line.

        Raises:
            Refusal: ERR006 without room; ERR009 for IFs and WHILEs that aren't nested correctly; ERR003 if
                the buffer doesn't exist any more, or for words that a rotary can't hold.
        """
        line = line_of(text, statements)
        if port.open == "rotary":
            system = self._systems[port.system]
            if system.calculation.rotary is None:
                raise Refusal(DATA)
            system.calculation.rotary.append(line)
            system.wake()
            return
        program = self._open_program(port)
        if program is None:
            raise Refusal(DATA)
        if line.words + self._words() > LARGEST_PROGRAM:
            raise Refusal(NO_ROOM)
        program.append(line)

    def _words(self) -> int:
        return sum(program.words + len(program.lines) for program in self.programs.values()) + sum(
            plc.program.words for plc in self._plcs.by_number.values()
        )

    def _open_program(self, port: Port) -> Program | None:
        if port.open == "prog":
            return self.programs.get(port.number)
        if port.open == "plc" and port.number in self._plcs.by_number:
            return self._plcs.by_number[port.number].program
        return None

    def define_rotary(self, number: int, words: int) -> None:
        """Execute DEFINE ROT: create the rotary buffer of a coordinate system.

        Args:
            number: number of the coordinate system.
            words: size of the buffer.

        Raises:
            Refusal: ERR003 if a gather buffer or the rotary of a lower coordinate system exists (assumed),
                or if `words` is 0; ERR001 while the program runs; ERR006 if the buffer is too large.
        """
        if self.gathering or any(
            system.calculation.rotary for n, system in self._systems.items() if n < number
        ):
            raise Refusal(DATA)
        system = self._systems[number]
        if system.busy:
            raise Refusal(BUSY_PROGRAM)
        if words < 1:
            raise Refusal(DATA)
        if words > LARGEST_PROGRAM // 10:
            raise Refusal(NO_ROOM)
        system.calculation.rotary = Rotary(words, self._variables)
        system.calculation.rotary_gone()

    def delete_rotary(self, number: int) -> None:
        """Execute DELETE ROT.

        Raises:
            Refusal: ERR001 while the program runs; ERR007 while a rotary is open.
        """
        system = self._systems[number]
        if system.busy:
            raise Refusal(BUSY_PROGRAM)
        if any(port.open == "rotary" for port in self._ports.values()):
            raise Refusal(BUFFER_IN_USE)
        system.calculation.rotary = None
        system.calculation.rotary_gone()
