"""Lines that only contain questions, such as `P1`, `#1P#2P` or `&1?`. Clients repeat such lines, so the
parsed lines are cached.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache

from yarclang.pmac.defaults import MOTORS, SYSTEMS, VARIABLES
from yarclang.simulator.language.words import cleaned
from yarclang.simulator.network.ports import Port
from yarclang.simulator.network.reply import Reply
from yarclang.simulator.online.line import LEGAL, LONGEST
from yarclang.simulator.state import status
from yarclang.simulator.state.registers import printed
from yarclang.simulator.state.wiring import Shown

Question = Callable[[Shown, Port], str | None]
"""Function that executes one part of a line. It returns the answer, or None if the part only addresses a
motor or a coordinate system.
"""

_REMEMBERED = 1024
_PART = re.compile(
    r"#(?P<motor>[0-9]{1,2})(?![0-9])|&(?P<system>[0-9]{1,2})(?![0-9])"
    r"|([IPQM])(?P<variable>[0-9]{1,4})(?![0-9])|(?P<report>[PVF])(?=[PVF]*(?:[#&?]|\Z))|(?P<status>\?{1,3})"
)


@lru_cache(_REMEMBERED)
def questions(line: str) -> tuple[Question, ...]:
    """Return a function for each part of a line that only asks and addresses. The result is empty for any
    other line, and for a line that would be refused.
    """
    if len(line) > LONGEST or not LEGAL(line):
        return ()
    text = cleaned(line)
    asked_for: list[Question] = []
    at = 0
    while at < len(text):
        part = _PART.match(text, at)
        question = _question(part) if part else None
        if part is None or question is None:
            return ()
        asked_for.append(question)
        at = part.end()
    return tuple(asked_for)


def answered(machine: Shown, port: Port, line_questions: tuple[Question, ...]) -> Reply:
    """Return the reply to a line that only contains questions. Such a line is never refused."""
    items: tuple[str, ...] = ()
    for question in line_questions:
        if (item := question(machine, port)) is not None:
            items += (item,)
    return Reply(items)


def _question(part: re.Match[str]) -> Question | None:
    """Return the function for one part of a line. The result is None if its motor, coordinate system or
    variable doesn't exist.
    """
    match part.lastgroup:
        case "motor":
            return _motor(int(part[1])) if 1 <= int(part[1]) <= MOTORS else None
        case "system":
            return _system(int(part[2])) if 1 <= int(part[2]) <= SYSTEMS else None
        case "variable":
            return _variable(part[3], int(part[4])) if int(part[4]) < VARIABLES else None
        case "report":
            return REPORTS[part[0]]
        case _:
            marks = len(part[0])
            return lambda machine, port: status.digits(machine, marks, port.motor, port.system)


def _motor(number: int) -> Question:
    def address(_: Shown, port: Port) -> None:
        port.motor = number

    return address


def _system(number: int) -> Question:
    def address(_: Shown, port: Port) -> None:
        port.system = number

    return address


def _variable(letter: str, index: int) -> Question:
    name = f"{letter}{index}="

    def value(machine: Shown, port: Port) -> str:
        variables = machine.variables
        text = variables.shown(letter, index, variables.read(letter, index, port.system))
        return name + text if int(variables.i[9]) & 1 else text

    return value


def _position(machine: Shown, port: Port) -> str:
    return printed(machine.motors[port.motor].actual(machine.now), 1)


def _velocity(machine: Shown, port: Port) -> str:
    return printed(machine.motors[port.motor].place(machine.now)[1] * machine.servo_period, 3)


def _following_error(machine: Shown, port: Port) -> str:
    return printed(machine.motors[port.motor].following_error(machine.now), 1)


REPORTS: dict[str, Question] = {"P": _position, "V": _velocity, "F": _following_error}
"""Reports of the addressed motor: P (counts), V (counts per servo cycle), F (counts)."""
