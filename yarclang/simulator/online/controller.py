"""On-line commands for the controller as a whole: status, versions, PLCs, SAVE and reset."""

from __future__ import annotations

import re

from yarclang.simulator.language.statements import LAST_PLC
from yarclang.simulator.online.line import Line
from yarclang.simulator.state import status

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


def status_words(line: Line, match: re.Match[str]) -> None:
    """Answer ?, ?? or ???."""
    line.items.append(status.digits(line.machine, len(match[0]), line.port.motor, line.port.system))


def fixed(line: Line, match: re.Match[str]) -> None:
    """Answer VER, TYPE, CID, VID, SID, DATE or CHKS by a constant."""
    line.items.append(_ANSWERS[match[0]])


def time(line: Line, _: re.Match[str]) -> None:
    """Answer TIME: the time since power-up."""
    seconds = int(line.machine.now) % 86400
    line.items.append(f"{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}")


def plcs(line: Line, match: re.Match[str]) -> None:
    """Execute ENABLE, DISABLE, PAUSE or RESUME for PLCs. There are no compiled PLCs (PLCC)."""
    name = {"ENA": "ENABLE", "DIS": "DISABLE"}.get(match[1], match[1])
    numbers = line.reader.numbers(LAST_PLC)
    if not match[2]:
        line.machine.switch_plcs(name, numbers)


def message(line: Line, match: re.Match[str]) -> None:
    """Execute SEND as an on-line command. CMD has no effect."""
    if match[1] == "SEND":
        line.items.append(match[2])


def reset(line: Line, match: re.Match[str]) -> None:
    """Execute $$$ or $$$***."""
    if match[1]:
        line.machine.initialise()
    else:
        line.machine.reset()


def save(line: Line, _: re.Match[str]) -> None:
    """Execute SAVE."""
    line.machine.save()


def nothing(_line: Line, _match: re.Match[str]) -> None:
    """Accept a command that has no effect here."""
