"""Parser of lines: removes blanks and comments, and reads statements of motion programs, rotaries and PLCs.

Statements that only motion programs have are in `motion_words`.
"""

from __future__ import annotations

import re

from yarclang.pmac.defaults import MOTORS, SYSTEMS
from yarclang.pmac.errors import DATA
from yarclang.simulator.language.motion_words import motion_word
from yarclang.simulator.language.reader import Reader
from yarclang.simulator.language.statements import (
    LAST_PLC,
    Address,
    Assign,
    Frame,
    If,
    Move,
    Plain,
    Plcs,
    Say,
    Skipped,
    Statement,
)
from yarclang.simulator.network.reply import Refusal

_PLAIN_NUMBER = r"[+-]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})"
"""Pattern of a number that needs no further check of its value and length."""
_SIMPLE_MOVE = re.compile(rf"(?:[A-CU-Z]{_PLAIN_NUMBER})+\Z")
_AXIS_WORD = re.compile(rf"([A-CU-Z])({_PLAIN_NUMBER})")
_ASSIGNMENT = re.compile(r"(?=[IPQM](?:\d+(?:\.\.\d+)?|\(.*?\)+)(?:[&|^=]?=))([IPQM])")
_OPERATOR = re.compile(r"==|&=|\|=|\^=|=")
_RANGE = re.compile(r"\.\.(\d{1,5})")
_QUOTED = re.compile(r'"([^"]{0,250})"?')
_CONTROL = re.compile(r"\^([A-Z@])")
_PLAIN = re.compile(
    r"ENDIF|ENDI|ENDWHILE|ENDW|ELSE|WAIT|STOP|RETURN|RET|BLOCKSTART|BSTART|BLOCKSTOP|BSTOP|NOFRAX|TINIT"
    r"|PMATCH|UNLOCK"
)
_SHORT = {"ENDI": "ENDIF", "ENDW": "ENDWHILE", "RET": "RETURN", "BSTART": "BLOCKSTART", "BSTOP": "BLOCKSTOP"}


def cleaned(line: str) -> str:
    """Return a line in upper case, without blanks and comments. Text in quotes isn't changed.

    `;` and `//` begin a comment. Download tools remove both (facts 4).
    """
    if '"' not in line and ";" not in line and "/" not in line:
        return "".join(line.split()).upper()
    parts = line.split('"')
    for place in range(0, len(parts), 2):
        part = parts[place]
        cut = min((at for at in (part.find(";"), part.find("//")) if at >= 0), default=-1)
        parts[place] = "".join(part[: cut if cut >= 0 else None].split()).upper()
        if cut >= 0:
            return '"'.join(parts[: place + 1])
    return '"'.join(parts)


def simple_move(text: str) -> Move | None:
    """Return the move in a line that consists of axis letters with constants, as most lines do. Return None
    for all other lines.
    """
    if not _SIMPLE_MOVE.match(text):
        return None
    return Move(tuple((axis, float(number), None) for axis, number in _AXIS_WORD.findall(text)))


def read_statement(reader: Reader, plc: bool) -> Statement | None:
    """Read the statement that begins at the reader's position. If there is none, return None and read
    nothing.

    Args:
        reader: the text and the position in it.
        plc: True for a PLC, False for a motion program or rotary.

    Raises:
        Refusal: ERR003 if a statement begins correctly but continues wrongly.
    """
    at = reader.at
    statement = _shared(reader) or (_plc_word(reader) if plc else motion_word(reader))
    if statement is None:
        reader.at = at
    return statement


def _shared(reader: Reader) -> Statement | None:
    """Read a statement that motion programs and PLCs share."""
    if reader.match(_ASSIGNMENT):
        return _assignment(reader)
    for name in ("IF", "WHILE", "AND", "OR"):
        if reader.text.startswith(name + "(", reader.at):
            reader.at += len(name) + 1
            condition = reader.condition()
            reader.expect(")")
            return If(name, condition)
    for name in ("SENDS", "SENDP", "SENDR", "SENDA", "SEND", "CMDS", "CMDP", "CMDR", "CMDA", "CMD"):
        if reader.takes(name):
            return _say(reader, name.removesuffix("S") if name.startswith("CMD") else "SEND")
    for name in ("ENABLEPLCC", "DISABLEPLCC", "ENABLEPLC", "DISABLEPLC", "PAUSEPLC", "RESUMEPLC"):
        if reader.takes(name) or (name == "ENABLEPLC" and reader.takes("ENAPLC")):
            numbers = reader.numbers(LAST_PLC)
            if name.endswith("PLCC"):
                return Skipped(name)
            return Plcs(name.removesuffix("PLC"), numbers)
    if reader.takes("DISPLC"):
        return Plcs("DISABLE", reader.numbers(LAST_PLC))
    if reader.takes("DISPLAY") or reader.takes("DISP"):
        return _display(reader)
    if found := reader.match(_PLAIN):
        name = _SHORT.get(found[0], found[0])
        return Frame(name, "") if name == "NOFRAX" else Plain(name)
    return None


def _assignment(reader: Reader) -> Statement:
    """Read an assignment: `P1=5`, `P1..6=0`, or `M1==1`, which waits for the next move."""
    letter = reader.text[reader.at - 1]
    index = reader.index()
    last = int(found[1]) if not callable(index) and (found := reader.match(_RANGE)) else None
    operator = reader.match(_OPERATOR)
    if not operator or (last is not None and operator[0] != "="):
        raise Refusal(DATA)
    synchronous = "" if operator[0] == "=" else operator[0]
    if synchronous:
        reader.takes("=")
        if letter != "M":
            raise Refusal(DATA)
    if not callable(index) and not 0 <= max(index, last or 0) < 8192:
        raise Refusal(DATA)
    return Assign(letter, index, reader.expression(), synchronous, last)


def _say(reader: Reader, name: str) -> Statement:
    if match := reader.match(_CONTROL):
        return Say("CMD", match[0]) if name.startswith("CMD") else Say("SEND^", match[1])
    match = reader.match(_QUOTED)
    if not match:
        raise Refusal(DATA)
    return Say("CMD" if name.startswith("CMD") else name, match[1])


def _display(reader: Reader) -> Statement:
    if reader.has_data():
        reader.data()
    if not reader.match(_QUOTED):
        if reader.ended:
            raise Refusal(DATA)
        while reader.takes(",") or reader.has_data() or (reader.rest and reader.rest[0] in "PQMI"):
            if reader.rest and reader.rest[0] in "PQMI":
                reader.at += 1
                reader.index()
            elif reader.has_data():
                reader.data()
    return Skipped("DISPLAY")


def _plc_word(reader: Reader) -> Statement | None:
    if not reader.takes("ADDRESS") and not reader.takes("ADR"):
        return None
    motor = system = None
    while not reader.ended and reader.rest[0] in "#&":
        if reader.takes("#"):
            motor = _address(reader, MOTORS)
        elif reader.takes("&"):
            system = _address(reader, SYSTEMS)
    return Address(motor, system)


def _address(reader: Reader, largest: int) -> int:
    number = reader.whole()
    if not 1 <= number <= largest:
        raise Refusal(DATA)
    return number
