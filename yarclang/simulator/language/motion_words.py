"""Parser of the statements that only motion programs and rotaries may contain: moves, modes, pauses, jumps
(TSRM 421-424 and index).
"""

from __future__ import annotations

import re

from yarclang.pmac.defaults import MOTORS
from yarclang.simulator.language.arithmetic import Data
from yarclang.simulator.language.reader import Reader
from yarclang.simulator.language.statements import (
    AXES,
    Attribute,
    Frame,
    Home,
    Jump,
    Label,
    Mode,
    Move,
    Pause,
    Pset,
    Skipped,
    Statement,
)

_AXIS_LIST = re.compile(r"\(([A-CIJKRU-Z](?:,[A-CIJKRU-Z])*)\)")
_MODE = re.compile(r"LINEAR|LIN|RAPID|RPD|CIRCLE[1234]|CIR[12]|SPLINE[12]")
_MODES = {"LIN": "LINEAR", "RPD": "RAPID", "CIR1": "CIRCLE1", "CIR2": "CIRCLE2"}
_WITH_DATA = re.compile(r"TSEL|ADIS|IDIS|AROT|IROT|CCR|TR|NX|NY|NZ|[GTD]|S(?=[\d(.+-])|[HEL](?=[\d(.+-])")
_WITHOUT_DATA = re.compile(r"CC[0-4]|SETPHASE[\d,.]+|LOCK[\d(]\d*\)?|READ\([A-Z](?:,[A-Z])*\)|NORMAL|NRM")
_VECTOR = "IJKR"
_ASSIGNED = re.compile(r"(?=[PQMI]\d+=)")
_LABEL = re.compile(r"\d{1,6}")


def motion_word(reader: Reader) -> Statement | None:
    """Read the statement that begins at the reader's position; None if no such statement begins there.

    Raises:
        Refusal: ERR003 if a statement begins correctly but continues wrongly.
    """
    if match := reader.match(_MODE):
        return Mode(_MODES.get(match[0], match[0]))
    for name in ("PVT", "DWELL", "DWE", "DELAY", "DLY", "TM", "TA", "TS"):
        if reader.text.startswith(name, reader.at) and not reader.text.startswith("TSEL", reader.at):
            reader.at += len(name)
            value = reader.data()
            if name == "PVT":
                return Mode("PVT", value)
            if name[0] == "D":
                return Pause("DWELL" if name.startswith("DW") else "DELAY", value)
            return Attribute(name, value)
    for name in ("ABS", "INC", "FRAX"):
        if reader.takes(name):
            listed = reader.match(_AXIS_LIST)
            return Frame(name, listed[1].replace(",", "") if listed else "")
    if reader.takes("PSET"):
        return Pset(tuple((axis, data) for axis, data, _ in _axis_words(reader)))
    for name in ("GOTO", "GOSUB", "CALL"):
        if reader.takes(name):
            target = Jump(name, reader.data())
            return target if name == "GOTO" else _with_arguments(reader, target)
    for name in ("HOMEZ", "HMZ", "HOME", "HM"):
        if reader.takes(name):
            return Home("HOMEZ" if name.endswith("Z") else "HOME", reader.numbers(MOTORS))
    if match := reader.match(_WITHOUT_DATA):
        if match[0] in ("NORMAL", "NRM"):
            _vector(reader)
        return Skipped(re.sub(r"[\d(].*", "", match[0]) or match[0])
    start = reader.at
    if (match := reader.match(_WITH_DATA)) and reader.has_data():
        data = reader.data()
        if match[0] in "GTD":
            return Jump(match[0], data)
        return Skipped(match[0])
    reader.at = start
    return _letter(reader)


def _with_arguments(reader: Reader, jump: Jump) -> Jump:
    """Read and ignore the arguments after a subprogram call: letters with data, which a READ in the
    subprogram would fetch.
    """
    while not reader.ended and reader.rest[0].isalpha() and not reader.match(_ASSIGNED):
        here = reader.at
        reader.at += 1
        if not reader.has_data():
            reader.at = here
            break
        reader.data()
    return jump


def _letter(reader: Reader) -> Statement | None:
    """Read a single letter with data: an axis, F, N, or M (which calls PROG 1001)."""
    letter = reader.rest[:1]
    if not letter:
        return None
    at = reader.at
    reader.at += 1
    if letter in "NO" and (found := reader.match(_LABEL)):
        return Label(int(found[0]))
    if not reader.has_data():
        reader.at = at
        return None
    if letter == "F":
        return Attribute("F", reader.data())
    if letter == "M":
        return Jump("M", reader.data())
    reader.at = at
    words = _axis_words(reader)
    return Move(tuple(words)) if words else _vector_only(reader)


def _vector_only(reader: Reader) -> Statement | None:
    return Skipped("I J K R") if _vector(reader) else None


def _vector(reader: Reader) -> bool:
    """Read circle vectors and ignore them; return True if there were any."""
    any_read = False
    while not reader.ended and reader.rest[0] in _VECTOR:
        at = reader.at
        reader.at += 1
        if not reader.has_data():
            reader.at = at
            break
        reader.data()
        any_read = True
    return any_read


def _axis_words(reader: Reader) -> list[tuple[str, Data, Data | None]]:
    """Read letters of axes with data. Circle vectors among them are ignored."""
    words: list[tuple[str, Data, Data | None]] = []
    while not reader.ended:
        letter = reader.rest[0]
        at = reader.at
        if words and letter in _VECTOR and _vector(reader):
            continue
        reader.at = at
        if letter not in AXES:
            break
        reader.at += 1
        if not reader.has_data():
            reader.at = at
            break
        position = reader.data()
        velocity = reader.data() if reader.takes(":") else None
        if reader.takes("^"):
            reader.data()
        words.append((letter, position, velocity))
    return words
