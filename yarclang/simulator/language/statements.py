"""The statements that a buffer can hold: motion programs, rotaries and PLCs (TSRM 31, 421-424 and index).

What they do is the business of `programs`.
"""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.simulator.language.arithmetic import Condition, Data

AXES = "ABCUVWXYZ"
"""In the order of Q1 to Q9 in a kinematic program."""

LAST_PLC = 31
"""The largest number of a PLC."""


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
    """SEND (to the host; SEND^ a control character) and CMD (to the interpreter): text with quotes taken off."""

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

_NOT_IN_ROTARY = ("ELSE", "ENDIF", "ENDWHILE", "WAIT", "RETURN")


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
    if isinstance(statement, If | Jump | Label):
        return False
    return not (isinstance(statement, Plain) and statement.name in _NOT_IN_ROTARY)
