"""On-line commands: what a line asks of the machine, one command after the other (TSRM 259-424).

A line may hold several commands without anything between them. While a buffer is open on the port, what can
be stored there is stored. The first error ends the line; what was done before it stays done.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from yarclang.pmac.defaults import MOTORS, SYSTEMS, VARIABLES
from yarclang.pmac.errors import BUSY_PROGRAM, DATA, MOVE_IN_PROGRESS, NEEDS_BUFFER, OPEN_LOOP
from yarclang.simulator.axes import axis_definition
from yarclang.simulator.expressions import Reader, value_of
from yarclang.simulator.motors import Motor
from yarclang.simulator.questions import LEGAL, LONGEST_LINE, REPORTS
from yarclang.simulator.registers import Definition, definition, printed
from yarclang.simulator.reply import Refusal
from yarclang.simulator.words import Statement, cleaned, numbers_listed, read_statement, simple_move

if TYPE_CHECKING:
    from yarclang.simulator.machine import Machine

_ILLEGAL = 4
_UP_TO = re.compile(r"\.\.(\d{1,5})")
_VARIABLE = re.compile(r"([IPQM])(?=\d|\()")
_DEFINITION = re.compile(r"->(\*|(?:DP|[XYDFL]):\$?[0-9A-F]+(?:,(?:\d+|[SU])){0,3})?")
_AXIS_DEFINITION = re.compile(r"#(\d+)->((?:I(?!\d)|[0-9.+\-A-CU-Z]+)?)")
_LONE = r"(?![A-Z\d(.$+\-=])"
"""Behind a single letter that isn't the start of a longer word."""


@dataclass(slots=True)
class Port:
    """What a port addresses, and the buffer that it has opened: `rotary`, `prog`, `plc` or none."""

    motor: int = 1
    system: int = 1
    open: str = ""
    number: int = 0


class OnLine:
    """One line from one port."""

    def __init__(self, machine: Machine, port: Port) -> None:
        self.machine = machine
        self.port = port
        self.items: list[str] = []
        self.reader = Reader("")

    def execute(self, line: str) -> None:
        """Execute or store a line; what it answers is in `items`.

        Raises:
            Refusal: with the number of the error.
        """
        if len(line) > LONGEST_LINE:
            raise Refusal(DATA)
        if not LEGAL(line):
            raise Refusal(_ILLEGAL)
        text = cleaned(line)
        if self.port.open in ("rotary", "prog") and (move := simple_move(text)):
            self.machine.buffers.store(self.port, text, (move,))
            return
        self.reader = Reader(text)
        while not self.reader.ended:
            if not self._stored():
                self._command()

    def _stored(self) -> bool:
        """Store what comes next in the open buffer; False where nothing that comes next belongs there."""
        reader, port = self.reader, self.port
        at = reader.at
        if not port.open:
            return False
        statements: list[Statement] = []
        while not reader.ended and not (reader.rest[0] == "C" and _CLOSING.match(reader.rest)):
            statement = read_statement(reader, port.open == "plc")
            if statement is None:
                break
            statements.append(statement)
        if not statements:
            return False
        if not reader.ended and not self._begins_command():
            raise Refusal(DATA)
        self.machine.buffers.store(port, reader.text[at : reader.at], tuple(statements))
        return True

    def _begins_command(self) -> bool:
        text, at = self.reader.text, self.reader.at
        return any(pattern.match(text, at) for pattern, _ in _BY_FIRST.get(text[at], ()))

    def _command(self) -> None:
        reader = self.reader
        for pattern, action in _BY_FIRST.get(reader.text[reader.at], ()):
            if found := reader.match(pattern):
                action(self, found)
                return
        at = reader.at
        statement = read_statement(reader, False)
        reader.at = at
        raise Refusal(DATA if statement is None or self.port.open else NEEDS_BUFFER)

    # what is addressed

    @property
    def _motor(self) -> Motor:
        return self.machine.motors[self.port.motor]

    def _free_motor(self) -> Motor:
        """The addressed motor, if no program runs in its coordinate system (a hold lets it be jogged)."""
        motor = self._motor
        system = self.machine.system_of(motor)
        if system is not None and system.busy and system.held_at is None:
            raise Refusal(BUSY_PROGRAM)
        return motor

    def motor_address(self, found: re.Match[str]) -> None:
        """#n, ##n, or # alone."""
        if not found[1]:
            self.items.append(str(self.port.motor))
            return
        if not 1 <= int(found[1]) <= MOTORS:
            raise Refusal(DATA)
        self.port.motor = int(found[1])

    def system_address(self, found: re.Match[str]) -> None:
        """&n, or & alone."""
        if not found[1]:
            self.items.append(str(self.port.system))
            return
        if not 1 <= int(found[1]) <= SYSTEMS:
            raise Refusal(DATA)
        self.port.system = int(found[1])

    def axes(self, found: re.Match[str]) -> None:
        """#n->: define, take away with 0, or report."""
        number = int(found[1])
        if not 1 <= number <= MOTORS:
            raise Refusal(DATA)
        motor = self.machine.motors[number]
        owner = self.machine.system_of(motor)
        if not found[2]:
            self.items.append(owner.definitions[number].text if owner else "0")
            return
        wanted = axis_definition(found[2])
        system = self.machine.systems[self.port.system]
        if wanted is None:
            if owner is not None:
                owner.define(motor, None)
            return
        if owner is not None and owner is not system:
            raise Refusal(DATA)
        if motor.jogging:
            raise Refusal(MOVE_IN_PROGRESS)
        system.define(motor, wanted)

    def undefine(self, found: re.Match[str]) -> None:
        """UNDEFINE of this coordinate system, or of ALL."""
        systems = self.machine.systems.values() if found[1] else [self.machine.systems[self.port.system]]
        for system in systems:
            for motor in list(system.motors):
                system.define(motor, None)

    # variables

    def variable(self, found: re.Match[str]) -> None:
        """Report, assign, or define a variable; a range with `..`."""
        reader, variables = self.reader, self.machine.variables
        letter, scope = found[1], variables.scope(self.port.system)
        first = int(value_of(reader.index(), scope))
        last = first
        if ranged := reader.match(_UP_TO):
            last = int(ranged[1])
        if not 0 <= first <= last < VARIABLES:
            raise Refusal(DATA)
        if letter == "M" and (pointed := reader.match(_DEFINITION)):
            self._point(first, last, pointed[1])
        elif reader.takes("="):
            if reader.takes("*"):
                values = self.machine.default_of(letter, first, last)
            else:
                value = reader.expression()(scope)
                values = [value] * (last - first + 1)
            for index, value in zip(range(first, last + 1), values, strict=True):
                scope.write(letter, index, value)
        else:
            for index in range(first, last + 1):
                text = variables.shown(letter, index, scope.read(letter, index))
                long = int(variables.i[9]) & 1
                self.items.append(f"{letter}{index}={text}" if long else text)

    def _point(self, first: int, last: int, text: str | None) -> None:
        definitions = self.machine.variables.m
        for index in range(first, last + 1):
            if text is None:
                self.items.append(definitions.get(index, Definition()).text)
            else:
                definitions[index] = definition(text)

    # buffers

    def open(self, found: re.Match[str]) -> None:
        """OPEN PROG n, OPEN PLC n, OPEN ROT."""
        kind = {"PRO": "prog", "PLC": "plc", "ROT": "rotary"}[found[1][:3]]
        number = 0 if kind == "rotary" else self.reader.whole()
        self.machine.buffers.open(self.port, kind, number)

    def close(self, found: re.Match[str]) -> None:
        """CLOSE, or CLOSE ALL."""
        self.machine.buffers.close(None if found[1] else self.port)

    def clear(self, found: re.Match[str]) -> None:
        """CLEAR the open buffer; CLEAR ALL and CLEAR PLC n."""
        if found[1]:
            self.machine.buffers.clear_plcs(numbers_listed(self.reader, 31) if found[1] != "ALL" else None)
        elif not self.port.open:
            raise Refusal(NEEDS_BUFFER)
        else:
            self.machine.buffers.clear(self.port)

    def define(self, found: re.Match[str]) -> None:
        """DEFINE ROT n; other buffers are sizes that mean nothing here."""
        if found[1].startswith("ROT"):
            self.machine.buffers.define_rotary(self.port.system, self.reader.whole())
            return
        while self.reader.has_data() or self.reader.takes(","):
            if self.reader.has_data():
                self.reader.constant()
        self.machine.gathering = self.machine.gathering or found[1].startswith("GAT")

    def delete(self, found: re.Match[str]) -> None:
        """DELETE ROT, and of other buffers, which is nothing here."""
        if found[1].startswith("ROT"):
            self.machine.buffers.delete_rotary(self.port.system)
        elif found[1].startswith("GAT"):
            self.machine.gathering = False

    def listing(self, found: re.Match[str]) -> None:
        """LIST PROG n, LIST PLC n, LIST PC, LIST PE, LIST ROT."""
        machine = self.machine
        match found[1]:
            case "PC" | "PE":
                self.program_counter(found)
            case "PLC":
                number = self.reader.whole()
                if number not in machine.plcs:
                    raise Refusal(DATA)
                self._list([line.text for line in machine.plcs[number].program.lines])
            case "PROG" | "PRO":
                number = self.reader.whole()
                if number not in machine.programs:
                    raise Refusal(DATA)
                lines = [line.text for line in machine.programs[number].lines]
                first = self.reader.whole() if self.reader.takes(",") and self.reader.has_data() else 0
                count = self.reader.whole() if self.reader.takes(",") and self.reader.has_data() else None
                self._list(lines[first : None if count is None else first + count])
            case _:
                rotary = machine.systems[self.port.system].calculation.rotary
                if rotary is None:
                    raise Refusal(DATA)
                self._list([line.text for line in list(rotary.lines)])

    def _list(self, lines: list[str]) -> None:
        self.items += [*lines, "RETURN"]

    def program_counter(self, found: re.Match[str]) -> None:
        """PC and PE: program and line that come next (the format is assumed)."""
        del found
        program, at = self.machine.systems[self.port.system].calculation.place
        number = self.machine.systems[self.port.system].calculation.number
        text = program.lines[at].text if program and at < len(program.lines) else ""
        self.items.append(f"P{number or 0}:{at}:{text}")

    # coordinate systems

    def point(self, found: re.Match[str]) -> None:
        """B: point to a program and a label."""
        number, _, label = found[1].partition(".")
        system = self.machine.systems[self.port.system]
        if system.busy:
            raise Refusal(BUSY_PROGRAM)
        if int(number or 0) > 32767:
            raise Refusal(DATA)
        system.steps.clear()
        system.calculation.point_to(int(number or 0), int((label or "0").ljust(5, "0")[:5]))

    def run(self, found: re.Match[str]) -> None:
        """R and S."""
        self.machine.run(self.port.system, single_step=found[0] == "S")

    def system_order(self, found: re.Match[str]) -> None:
        r"""Q, H, A, / and \\."""
        system = self.machine.systems[self.port.system]
        {"Q": system.quit, "H": system.hold, "A": system.abort, "/": system.end_of_move, "\\": system.hold}[
            found[0]
        ]()

    def override(self, found: re.Match[str]) -> None:
        """%: set or report the override."""
        del found
        system = self.machine.systems[self.port.system]
        if not self.reader.has_data():
            self.items.append(printed(system.map.rate(self.machine.now) * 100.0))
            return
        percent = self.reader.constant()
        if not 0.0 <= percent <= 225.88:
            raise Refusal(DATA)
        system.override(percent)

    def match_positions(self, found: re.Match[str]) -> None:
        """PMATCH."""
        del found
        system = self.machine.systems[self.port.system]
        if system.busy:
            raise Refusal(BUSY_PROGRAM)
        system.pmatch()

    def lines_ahead(self, found: re.Match[str]) -> None:
        """PR."""
        del found
        self.items.append(str(self.machine.systems[self.port.system].calculation.lines_ahead))

    def queued(self, found: re.Match[str]) -> None:
        """PQ: moves that are calculated and not begun (assumed)."""
        del found
        self.items.append(str(len(self.machine.systems[self.port.system].steps)))

    # motors

    def report(self, found: re.Match[str]) -> None:
        """P (counts), V (counts per servo cycle), F (counts)."""
        if text := REPORTS[found[0]](self.machine, self.port):
            self.items.append(text)

    def jog(self, found: re.Match[str]) -> None:
        """J and what follows it."""
        machine, now = self.machine, self.machine.now
        motor = self._free_motor()
        if not motor.activated:
            raise Refusal(DATA)
        kind = found[1]
        if kind == "/":
            if motor.amplifier_fault:
                raise Refusal(OPEN_LOOP)
            if motor.closed:
                motor.jog_stop(now)
            else:
                motor.close(now)
            machine.changed([motor])
            return
        target = self._jog_target(motor, kind)
        if not motor.closed:
            raise Refusal(OPEN_LOOP)
        if not motor.jogging:
            motor.before_jog = motor.place(now)[0]
        if kind in "+-":
            motor.jog(now, 1 if kind == "+" else -1)
        else:
            motor.jog_to(now, target)
        machine.changed([motor])

    def _jog_target(self, motor: Motor, kind: str) -> float:
        if kind in "+-":
            return 0.0
        reader, machine = self.reader, self.machine
        if reader.has_data():
            value = value_of(reader.data(), machine.variables.scope(self.port.system))
        elif kind == "=":
            return motor.before_jog
        else:
            raise Refusal(DATA)
        base = {"=": 0.0, "^": motor.actual(machine.now), ":": motor.place(machine.now)[0]}[kind]
        return base + value

    def home(self, found: re.Match[str]) -> None:
        """HM and HMZ."""
        motor = self._free_motor()
        if not motor.activated:
            raise Refusal(DATA)
        if found[0].endswith("Z"):
            motor.zero(self.machine.now)
        else:
            if not motor.closed:
                raise Refusal(OPEN_LOOP)
            motor.home(self.machine.now)
        self.machine.changed([motor])

    def kill(self, found: re.Match[str]) -> None:
        """K."""
        del found
        motor = self._free_motor()
        motor.kill(self.machine.now)
        self.machine.changed([motor])

    def open_loop(self, found: re.Match[str]) -> None:
        """O: output in percent, open loop; the motor stands all the same (assumed)."""
        del found
        motor = self._free_motor()
        self.reader.constant()
        motor.kill(self.machine.now)
        motor.enabled = True
        self.machine.changed([motor])

    # the controller

    def status(self, found: re.Match[str]) -> None:
        """?, ?? and ???."""
        self.items.append(self.machine.status(len(found[0]), self.port.motor, self.port.system))

    def fixed(self, found: re.Match[str]) -> None:
        """VER, TYPE, CID, VID, SID, DATE, CHKS: always the same."""
        self.items.append(_ANSWERS[found[0]])

    def time(self, found: re.Match[str]) -> None:
        """TIME: since it was switched on."""
        del found
        seconds = int(self.machine.now) % 86400
        self.items.append(f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}")

    def plcs(self, found: re.Match[str]) -> None:
        """ENABLE, DISABLE, PAUSE, RESUME of PLCs."""
        name = found[1].replace("ENA", "ENABLE").replace("DIS", "DISABLE")
        name = {"ENABLEBLE": "ENABLE", "DISABLEABLE": "DISABLE"}.get(name, name)
        numbers = numbers_listed(self.reader, 31)
        if not found[2]:
            self.machine.switch_plcs(name, numbers)

    def message(self, found: re.Match[str]) -> None:
        """SEND and CMD as on-line commands."""
        if found[1] == "SEND":
            self.items.append(found[2])

    def read_memory(self, found: re.Match[str]) -> None:
        """R: the content of an address, in hexadecimal after RH."""
        at = Definition(found[2], int(found[3], 16))
        value = self.machine.variables.memory.read(at)
        self.items.append(f"{int(value) & (1 << 48) - 1:X}" if found[1] else printed(value))

    def write_memory(self, found: re.Match[str]) -> None:
        """W: give an address a value."""
        at = Definition(found[1], int(found[2], 16))
        self.machine.variables.memory.write(at, self.reader.constant())

    def reset(self, found: re.Match[str]) -> None:
        """$$$ and $$$***."""
        if found[1]:
            self.machine.initialise()
        else:
            self.machine.reset()

    def save(self, found: re.Match[str]) -> None:
        """SAVE."""
        del found
        self.machine.save()

    def nothing(self, found: re.Match[str]) -> None:
        """A command without an effect here."""


_CLOSING = re.compile(r"CLOSE|CLEAR|CLR|CLS")
_ANSWERS = {
    "VERSION": "1.945",
    "VER": "1.945",
    "TYPE": "TURBO2, X4",
    "CID": "602413",
    "VID": "1",
    "SID": "0",
    "CPU": "DSP56311",
    "DATE": "07/17/2008",
    "CHKS": "0",
    "CHECKSUM": "0",
}

Action = Callable[[OnLine, "re.Match[str]"], None]
_COMMANDS: tuple[tuple[str, re.Pattern[str], Action], ...] = tuple(
    (firsts, re.compile(pattern), action)
    for firsts, pattern, action in (
        ("#", _AXIS_DEFINITION.pattern, OnLine.axes),
        ("#", r"##?(\d{0,3})", OnLine.motor_address),
        ("&", r"&(\d{0,3})", OnLine.system_address),
        ("$", r"\$\$\$(\*\*\*)?", OnLine.reset),
        ("O", r"OPEN(PROG?|PLC|ROT(?:ARY)?)", OnLine.open),
        ("C", r"CLOSE(ALL)?|CLS(?!\w)", OnLine.close),
        ("C", r"(?:CLEAR|CLR)(ALL|PLC)?", OnLine.clear),
        (
            "D",
            r"DEF(?:INE)?(ROT(?:ARY)?|GAT(?:HER)?|LOOK(?:AHEAD)?|BLCOMP|TCOMP|COMP|TBUF|UBUF|CCBUF(?:FER)?)",
            OnLine.define,
        ),
        (
            "D",
            r"DEL(?:ETE)?(ROT(?:ARY)?|GAT(?:HER)?|LOOK(?:AHEAD)?|BLCOMP|TCOMP|COMP|TBUF|UBUF|TRACE|PLCC?|CCBUF(?:FER)?)\d*",
            OnLine.delete,
        ),
        ("EG", r"END(?:GAT(?:HER)?|G)|GAT(?:HER)?(?:TRIGGER)?", OnLine.nothing),
        ("L", r"LIST(PROG?|PLC|PC|PE|ROT(?:ARY)?)", OnLine.listing),
        ("U", r"UNDEF(?:INE)?(ALL)?", OnLine.undefine),
        ("EDPR", r"(ENA(?:BLE)?|DIS(?:ABLE)?|PAUSE|RESUME)PLC(C)?", OnLine.plcs),
        ("P", r"PMATCH", OnLine.match_positions),
        ("P", r"PR(?!O)", OnLine.lines_ahead),
        ("P", r"PQ(?!\d|\()", OnLine.queued),
        ("P", r"P[CE](?![A-Z])", OnLine.program_counter),
        ("VTCSD", r"VER(?:SION)?|TYPE|CID|VID|SID|DATE|CPU|CHKS|CHECKSUM", OnLine.fixed),
        ("T", r"TIME", OnLine.time),
        ("S", r"SAVE", OnLine.save),
        ("SC", r'(SEND|CMD)[SPRA]?"([^"]*)"?', OnLine.message),
        ("LSIP", r"LEARN|STN(?:=\d+)?|IDC|PASSWORD=\S*|LOCK|SIZE", OnLine.nothing),
        ("IPQM", _VARIABLE.pattern, OnLine.variable),
        ("?", r"\?{1,3}", OnLine.status),
        ("%", r"%", OnLine.override),
        ("B", r"B(\d{1,5}(?:\.\d{1,5})?|(?![A-Z(+\-$.]))", OnLine.point),
        ("J", r"J([+\-/=^:])", OnLine.jog),
        ("H", r"(?:HOME|HM)Z?", OnLine.home),
        ("O", r"O(?=[\d+\-.])", OnLine.open_loop),
        ("K", rf"K{_LONE}", OnLine.kill),
        ("R", r"R(H?)([XYDFL]):?\$?([0-9A-F]{1,6})", OnLine.read_memory),
        ("W", r"W([XYDFL]):?\$?([0-9A-F]{1,6}),", OnLine.write_memory),
        ("RS", rf"[RS]{_LONE}", OnLine.run),
        ("QHA/\\", rf"[QHA]{_LONE}|/|\\", OnLine.system_order),
        ("PVF", rf"[PVF](?=[PVF]*{_LONE})", OnLine.report),
    )
)
"""The characters that a command can begin with, its form, and what it does; the first that fits counts."""

_BY_FIRST: dict[str, tuple[tuple[re.Pattern[str], Action], ...]] = {
    first: tuple((pattern, action) for firsts, pattern, action in _COMMANDS if first in firsts)
    for first in sorted({first for firsts, _, _ in _COMMANDS for first in firsts})
}
