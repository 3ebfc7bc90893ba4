"""On-line commands for variables and memory."""

from __future__ import annotations

import re

from yarclang.pmac.defaults import VARIABLES, default_variables
from yarclang.pmac.errors import DATA
from yarclang.simulator.language.arithmetic import value_of
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.online.line import Line
from yarclang.simulator.state.registers import Definition, definition, printed

_UP_TO = re.compile(r"\.\.(\d{1,5})")
_DEFINITION = re.compile(r"->(\*|(?:DP|[XYDFL]):\$?[0-9A-F]+(?:,(?:\d+|[SU])){0,3})?")
_LONG_WORD = (1 << 48) - 1


def variable(line: Line, match: re.Match[str]) -> None:
    """Report, assign or define a variable, or a range of them (`..`)."""
    reader, variables, scope = line.reader, line.machine.variables, line.scope
    letter = match[1]
    first = int(value_of(reader.index(), scope))
    last = first
    if ranged := reader.match(_UP_TO):
        last = int(ranged[1])
    if not 0 <= first <= last < VARIABLES:
        raise Refusal(DATA)
    if letter == "M" and (pointed := reader.match(_DEFINITION)):
        _point(line, first, last, pointed[1])
    elif reader.takes("="):
        if reader.takes("*"):
            values = _defaults(letter, first, last)
        else:
            values = [reader.expression()(scope)] * (last - first + 1)
        for index, value in zip(range(first, last + 1), values, strict=True):
            scope.write(letter, index, value)
    else:
        for index in range(first, last + 1):
            text = variables.shown(letter, index, scope.read(letter, index))
            long = int(variables.i[9]) & 1
            line.items.append(f"{letter}{index}={text}" if long else text)


def _point(line: Line, first: int, last: int, text: str | None) -> None:
    definitions = line.machine.variables.m
    for index in range(first, last + 1):
        if text is None:
            line.items.append(definitions.get(index, Definition()).text)
        else:
            definitions[index] = definition(text)


def _defaults(letter: str, first: int, last: int) -> list[float]:
    """Return the factory values of a range of variables (I1=*)."""
    if letter != "I":
        raise Refusal(DATA)
    defaults = default_variables()
    return [defaults.get(index, 0.0) for index in range(first, last + 1)]


def read_memory(line: Line, match: re.Match[str]) -> None:
    """Execute R: report the content of an address, in hexadecimal for RH."""
    value = line.machine.variables.memory.read(Definition(match[2], int(match[3], 16)))
    line.items.append(f"{int(value) & _LONG_WORD:X}" if match[1] else printed(value))


def write_memory(line: Line, match: re.Match[str]) -> None:
    """Execute W: write a value to an address."""
    at = Definition(match[1], int(match[2], 16))
    line.machine.variables.memory.write(at, line.reader.constant())
