"""On-line commands for the addressed coordinate system: axis definitions, programs, the override."""

from __future__ import annotations

import re

from yarclang.pmac.defaults import MOTORS, SYSTEMS
from yarclang.pmac.errors import BUSY_PROGRAM, DATA, MOVE_IN_PROGRESS
from yarclang.simulator.motion.axes import axis_definition
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.online.line import Line
from yarclang.simulator.state.registers import printed

_LAST_PROGRAM = 32767
_MOST_PERCENT = 225.88


def address(line: Line, match: re.Match[str]) -> None:
    """Execute &n, or answer & alone."""
    if not match[1]:
        line.items.append(str(line.port.system))
        return
    if not 1 <= int(match[1]) <= SYSTEMS:
        raise Refusal(DATA)
    line.port.system = int(match[1])


def axes(line: Line, match: re.Match[str]) -> None:
    """Execute #n->: define the axes of a motor, remove the definition (0), or report it."""
    number = int(match[1])
    if not 1 <= number <= MOTORS:
        raise Refusal(DATA)
    motor = line.machine.motors[number]
    owner = line.machine.system_of(motor)
    if not match[2]:
        line.items.append(owner.definitions[number].text if owner else "0")
        return
    definition = axis_definition(match[2])
    if definition is None:
        if owner is not None:
            owner.define(motor, None)
        return
    if owner is not None and owner is not line.system:
        raise Refusal(DATA)
    if motor.jogging:
        raise Refusal(MOVE_IN_PROGRESS)
    line.system.define(motor, definition)


def undefine(line: Line, match: re.Match[str]) -> None:
    """Execute UNDEFINE: remove the axis definitions of the addressed coordinate system; or UNDEFINE ALL:
    remove those of all coordinate systems.
    """
    for system in line.machine.systems.values() if match[1] else [line.system]:
        for motor in list(system.motors):
            system.define(motor, None)


def point(line: Line, match: re.Match[str]) -> None:
    """Execute B: select a program and a label in it."""
    number, _, label = match[1].partition(".")
    system = line.system
    if system.busy:
        raise Refusal(BUSY_PROGRAM)
    if int(number or 0) > _LAST_PROGRAM:
        raise Refusal(DATA)
    system.ahead.steps.clear()
    system.calculation.point_to(int(number or 0), int((label or "0").ljust(5, "0")[:5]))


def run(line: Line, match: re.Match[str]) -> None:
    """Execute R or S."""
    line.machine.run(line.port.system, single_step=match[0] == "S")


def order(line: Line, match: re.Match[str]) -> None:
    r"""Execute Q, H, A, / or \\."""
    system = line.system
    match match[0]:
        case "Q":
            system.quit()
        case "A":
            system.abort()
        case "/":
            system.end_of_move()
        case _:
            system.drive.hold()


def override(line: Line, _: re.Match[str]) -> None:
    """Execute %: set or report the override."""
    drive = line.system.drive
    if not line.reader.has_data():
        line.items.append(printed(drive.map.rate(line.machine.now) * 100.0))
        return
    percent = line.reader.constant()
    if not 0.0 <= percent <= _MOST_PERCENT:
        raise Refusal(DATA)
    drive.override(percent)


def match_positions(line: Line, _: re.Match[str]) -> None:
    """Execute PMATCH."""
    if line.system.busy:
        raise Refusal(BUSY_PROGRAM)
    line.system.pmatch()


def lines_ahead(line: Line, _: re.Match[str]) -> None:
    """Answer PR: the number of lines of the rotary that aren't calculated yet."""
    line.items.append(str(line.system.calculation.lines_ahead))


def queued(line: Line, _: re.Match[str]) -> None:
    """Answer PQ: the number of moves that are calculated but not begun (assumed)."""
    line.items.append(str(len(line.system.ahead.steps)))


def program_counter(line: Line, _: re.Match[str]) -> None:
    """Answer PC or PE: the program and its next line, in an assumed format."""
    calculation = line.system.calculation
    program, at = calculation.place
    text = program.lines[at].text if program and at < len(program.lines) else ""
    line.items.append(f"P{calculation.number or 0}:{at}:{text}")
