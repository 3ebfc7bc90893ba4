"""The words that a buffer can hold: motion programs, rotaries and PLCs (TSRM 31, 421-424 and index).

A line of text becomes statements; what they do is the business of `execution` and `plc`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from yarclang.pmac.defaults import MOTORS, SYSTEMS
from yarclang.pmac.errors import DATA
from yarclang.simulator.expressions import Condition, Data, Reader
from yarclang.simulator.reply import Refusal

AXES = "ABCUVWXYZ"
"""In the order of Q1 to Q9 in a kinematic program."""


@dataclass(frozen=True, slots=True)
class Move:
    """Axis words: letter, position, and for PVT its velocity."""

    words: tuple[tuple[str, Data, Data | None], ...]


@dataclass(frozen=True, slots=True)
class Mode:
    """A move mode; `time` is that of PVT [ms]."""

    name: str
    time: Data | None = None


@dataclass(frozen=True, slots=True)
class Attribute:
    """TM, TA, TS [ms] or F."""

    name: str
    value: Data


@dataclass(frozen=True, slots=True)
class Frame:
    """ABS, INC (of `axes`, or all), FRAX and NOFRAX."""

    name: str
    axes: str


@dataclass(frozen=True, slots=True)
class Pset:
    """The axes stand at these positions from now on."""

    words: tuple[tuple[str, Data], ...]


@dataclass(frozen=True, slots=True)
class Pause:
    """DWELL or DELAY [ms]."""

    name: str
    time: Data


@dataclass(frozen=True, slots=True)
class Assign:
    """`letter` `index` to `last` take a value; `synchronous` ones wait for the next move."""

    letter: str
    index: Data
    value: Data
    synchronous: str = ""
    last: int | None = None


@dataclass(frozen=True, slots=True)
class If:
    """IF, WHILE, AND, OR: `name` and the condition."""

    name: str
    condition: Condition


@dataclass(frozen=True, slots=True)
class Plain:
    """A word without data: ELSE, ENDIF, ENDWHILE, WAIT, STOP, RETURN, and more."""

    name: str


@dataclass(frozen=True, slots=True)
class Jump:
    """GOTO, GOSUB (a label) and CALL (a program and a label in it)."""

    name: str
    to: Data


@dataclass(frozen=True, slots=True)
class Label:
    """N or O and a number."""

    number: int


@dataclass(frozen=True, slots=True)
class Say:
    """SEND (to the host), CMD (to the interpreter), DISPLAY: text with quotes taken off."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Plcs:
    """ENABLE, DISABLE, PAUSE or RESUME of PLCs."""

    name: str
    numbers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Home:
    """HOME or HOMEZ of motors, in a program."""

    name: str
    motors: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Address:
    """ADDRESS#n&n: what CMD of a PLC addresses."""

    motor: int | None
    system: int | None


@dataclass(frozen=True, slots=True)
class Skipped:
    """A word that the controller knows and this machine doesn't act on."""

    name: str
    words: int = 1


Statement = (
    Move
    | Mode
    | Attribute
    | Frame
    | Pset
    | Pause
    | Assign
    | If
    | Plain
    | Jump
    | Label
    | Say
    | Plcs
    | Home
    | Address
    | Skipped
)

_SIMPLE_MOVE = re.compile(r"(?:[A-CU-Z][+-]?(?:\d+\.?\d*|\.\d+))+$")
_AXIS_WORD = re.compile(r"([A-CU-Z])([+-]?(?:\d+\.?\d*|\.\d+))")
_ASSIGNMENT = re.compile(r"(?=[IPQM](?:\d+(?:\.\.\d+)?|\(.*?\)+)(?:[&|^=]?=))([IPQM])")
_OPERATOR = re.compile(r"==|&=|\|=|\^=|=")
_RANGE = re.compile(r"\.\.(\d{1,5})")
_AXIS_LIST = re.compile(r"\(([A-CIJKRU-Z](?:,[A-CIJKRU-Z])*)\)")
_NUMBERS = re.compile(r"\d{1,3}(?:\.\.\d{1,3})?(?:,\d{1,3}(?:\.\.\d{1,3})?)*")
_QUOTED = re.compile(r'"([^"]{0,250})"?')
_CONTROL = re.compile(r"\^([A-Z@])")
_PLAIN = re.compile(
    r"ENDIF|ENDI|ENDWHILE|ENDW|ELSE|WAIT|STOP|RETURN|RET|BLOCKSTART|BSTART|BLOCKSTOP|BSTOP|NOFRAX|TINIT|PMATCH|UNLOCK"
)
_SHORT = {"ENDI": "ENDIF", "ENDW": "ENDWHILE", "RET": "RETURN", "BSTART": "BLOCKSTART", "BSTOP": "BLOCKSTOP"}
_MODE = re.compile(r"LINEAR|LIN|RAPID|RPD|CIRCLE[1234]|CIR[12]|SPLINE[12]")
_MODES = {"LIN": "LINEAR", "RPD": "RAPID", "CIR1": "CIRCLE1", "CIR2": "CIRCLE2"}
_WITH_DATA = re.compile(r"TSEL|ADIS|IDIS|AROT|IROT|CCR|TR|NX|NY|NZ|[GTD]|S(?=[\d(.+-])|[HEL](?=[\d(.+-])")
_WITHOUT_DATA = re.compile(r"CC[0-4]|SETPHASE[\d,.]+|LOCK[\d(]\d*\)?|READ\([A-Z](?:,[A-Z])*\)|NORMAL|NRM")
_VECTOR = "IJKR"

PLC_ONLY = (Address,)
NOT_IN_ROTARY = (If, Jump, Label)
_NOT_IN_ROTARY = ("ELSE", "ENDIF", "ENDWHILE", "WAIT", "RETURN")


def cleaned(line: str) -> str:
    """Upper case without blanks and comments, but what stands in quotes as it is.

    `;` begins a comment; so does `//` (the download tools strip both; facts 4).
    """
    parts = line.split('"')
    for place in range(0, len(parts), 2):
        part = parts[place]
        cut = min((at for at in (part.find(";"), part.find("//")) if at >= 0), default=-1)
        parts[place] = "".join(part[: cut if cut >= 0 else None].split()).upper()
        if cut >= 0:
            return '"'.join(parts[: place + 1])
    return '"'.join(parts)


def simple_move(text: str) -> Move | None:
    """A line that is nothing but axis letters with constants: most lines are."""
    if not _SIMPLE_MOVE.match(text):
        return None
    return Move(tuple((axis, float(number), None) for axis, number in _AXIS_WORD.findall(text)))


def read_statement(reader: Reader, plc: bool) -> Statement | None:
    """The statement that begins here, or None (and nothing read) where none does.

    Raises:
        Refusal: ERR003, where a statement begins and goes on badly.
    """
    at = reader.at
    statement = _shared(reader) or (_plc_word(reader) if plc else _motion_word(reader))
    if statement is None:
        reader.at = at
    return statement


def cost(statement: Statement) -> int:
    """The words of buffer that a statement takes: one each value (TUM 337), one a keyword (assumed)."""
    match statement:
        case Move(words=words):
            return sum(1 if velocity is None else 2 for _, _, velocity in words)
        case Say(text=text):
            return 1 + len(text) // 6
        case If():
            return 4
        case Assign():
            return 2
        case Skipped(words=words):
            return words
        case _:
            return 1


def in_rotary(statement: Statement) -> bool:
    """Whether a rotary takes it: branches, loops and labels aren't for it (PSRM 273); the error is assumed."""
    if isinstance(statement, NOT_IN_ROTARY):
        return False
    return not (isinstance(statement, Plain) and statement.name in _NOT_IN_ROTARY)


def _shared(reader: Reader) -> Statement | None:
    """What both motion programs and PLCs hold."""
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
            return _said(reader, name.removesuffix("S") if name.startswith("CMD") else "SEND")
    for name in ("ENABLEPLCC", "DISABLEPLCC", "ENABLEPLC", "DISABLEPLC", "PAUSEPLC", "RESUMEPLC"):
        if reader.takes(name) or (name == "ENABLEPLC" and reader.takes("ENAPLC")):
            numbers = numbers_listed(reader, 31)
            if name.endswith("PLCC"):
                return Skipped(name)
            return Plcs(name.removesuffix("PLC"), numbers)
    if reader.takes("DISPLC"):
        return Plcs("DISABLE", numbers_listed(reader, 31))
    if reader.takes("DISPLAY") or reader.takes("DISP"):
        return _display(reader)
    if found := reader.match(_PLAIN):
        name = _SHORT.get(found[0], found[0])
        return Frame(name, "") if name == "NOFRAX" else Plain(name)
    return None


def _assignment(reader: Reader) -> Statement:
    """`P1=5`, `P1..6=0`, `M1==1` (waits for the next move)."""
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


def _said(reader: Reader, name: str) -> Statement:
    if found := reader.match(_CONTROL):
        return Say(name + "^", found[1])
    found = reader.match(_QUOTED)
    if not found:
        raise Refusal(DATA)
    return Say("CMD" if name.startswith("CMD") else name, found[1])


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


def numbers_listed(reader: Reader, largest: int) -> tuple[int, ...]:
    """`1`, `1,3` or `1..4`; ERR003 beyond `largest`."""
    found = reader.match(_NUMBERS)
    if not found:
        raise Refusal(DATA)
    numbers: list[int] = []
    for part in found[0].split(","):
        first, _, last = part.partition("..")
        numbers += range(int(first), int(last or first) + 1)
    if not numbers or max(numbers) > largest:
        raise Refusal(DATA)
    return tuple(numbers)


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


def _motion_word(reader: Reader) -> Statement | None:
    if found := reader.match(_MODE):
        return Mode(_MODES.get(found[0], found[0]))
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
            return Home("HOMEZ" if name.endswith("Z") else "HOME", numbers_listed(reader, 32))
    if found := reader.match(_WITHOUT_DATA):
        if found[0] in ("NORMAL", "NRM"):
            _vector(reader)
        return Skipped(re.sub(r"[\d(].*", "", found[0]) or found[0])
    here = reader.at
    if (found := reader.match(_WITH_DATA)) and reader.has_data():
        data = reader.data()
        if found[0] in "GTD":
            return Jump(found[0], data)
        return Skipped(found[0])
    reader.at = here
    return _letter(reader)


def _with_arguments(reader: Reader, jump: Jump) -> Jump:
    """Arguments of a subprogram: letters with data, for READ. They stay in the text and are not passed on."""
    while not reader.ended and reader.rest[0].isalpha() and not reader.match(re.compile(r"(?=[PQMI]\d+=)")):
        here = reader.at
        reader.at += 1
        if not reader.has_data():
            reader.at = here
            break
        reader.data()
    return jump


def _letter(reader: Reader) -> Statement | None:
    """A single letter with data: an axis, F, N, or M (which calls PROG 1001)."""
    letter = reader.rest[:1]
    if not letter:
        return None
    at = reader.at
    reader.at += 1
    if letter in "NO" and (found := reader.match(re.compile(r"\d{1,6}"))):
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
    """Circle vectors, read and left out."""
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
    """Letters of axes with data; circle vectors among them are read and left out."""
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
