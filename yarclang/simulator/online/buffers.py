"""On-line commands for buffers: OPEN, CLOSE, CLEAR, DEFINE, DELETE, LIST."""

from __future__ import annotations

import re
from collections.abc import Sequence

from yarclang.pmac.errors import DATA, NEEDS_BUFFER
from yarclang.simulator.language.reader import Reader
from yarclang.simulator.language.statements import LAST_PLC
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.online.line import Line
from yarclang.simulator.programs import program

_KINDS = {"PRO": "prog", "PLC": "plc", "ROT": "rotary"}


def open_buffer(line: Line, match: re.Match[str]) -> None:
    """Execute OPEN PROG n, OPEN PLC n or OPEN ROT."""
    kind = _KINDS[match[1][:3]]
    number = 0 if kind == "rotary" else line.reader.whole()
    line.machine.buffers.open(line.port, kind, number)


def close(line: Line, match: re.Match[str]) -> None:
    """Execute CLOSE or CLOSE ALL."""
    line.machine.buffers.close(None if match[1] else line.port)


def clear(line: Line, match: re.Match[str]) -> None:
    """Execute CLEAR for the open buffer, CLEAR ALL or CLEAR PLC n."""
    if match[1]:
        line.machine.buffers.clear_plcs(line.reader.numbers(LAST_PLC) if match[1] != "ALL" else None)
    elif not line.port.open:
        raise Refusal(NEEDS_BUFFER)
    else:
        line.machine.buffers.clear(line.port)


def define(line: Line, match: re.Match[str]) -> None:
    """Execute DEFINE ROT n. Definitions of other buffers have no effect."""
    reader, machine = line.reader, line.machine
    if match[1].startswith("ROT"):
        machine.buffers.define_rotary(line.port.system, reader.whole())
        return
    while reader.has_data() or reader.takes(","):
        if reader.has_data():
            reader.constant()
    machine.buffers.gathering = machine.buffers.gathering or match[1].startswith("GAT")


def delete(line: Line, match: re.Match[str]) -> None:
    """Execute DELETE ROT or DELETE GATHER. For other buffers, DELETE has no effect."""
    if match[1].startswith("ROT"):
        line.machine.buffers.delete_rotary(line.port.system)
    elif match[1].startswith("GAT"):
        line.machine.buffers.gathering = False


def listing(line: Line, match: re.Match[str]) -> None:
    """Execute LIST PROG n (with the first line and the number of lines, if given), LIST PLC n or LIST ROT."""
    reader, machine = line.reader, line.machine
    lines: Sequence[program.Line]
    first, count = 0, None
    match match[1]:
        case "PLC":
            number = reader.whole()
            if number not in machine.plcs.by_number:
                raise Refusal(DATA)
            lines = machine.plcs.by_number[number].program.lines
        case "PROG" | "PRO":
            number = reader.whole()
            if number not in machine.buffers.programs:
                raise Refusal(DATA)
            lines = machine.buffers.programs[number].lines
            first, count = _argument(reader) or 0, _argument(reader)
        case _:
            rotary = line.system.calculation.rotary
            if rotary is None:
                raise Refusal(DATA)
            lines = list(rotary.lines)
    listed = lines[first : None if count is None else first + count]
    line.items += [*(each.text for each in listed), "RETURN"]


def _argument(reader: Reader) -> int | None:
    """Read a number after a comma; return None if there is none."""
    return reader.whole() if reader.takes(",") and reader.has_data() else None
