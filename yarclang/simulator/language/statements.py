"""The statements of motion programs, rotaries and PLCs as data (TSRM 31, 421-424 and index).

The package `programs` executes them.
"""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.simulator.language.arithmetic import Condition, Data

AXES = "ABCUVWXYZ"
"""The axes, in the order of Q1 to Q9 in a kinematic program."""

LAST_PLC = 31
"""Largest number of a PLC."""


@dataclass(frozen=True, slots=True)
class Move:
    """Axis words of a move: letter, position, and velocity for PVT."""

    words: tuple[tuple[str, Data, Data | None], ...]


@dataclass(frozen=True, slots=True)
class Mode:
    """A move mode; `time` is that of PVT moves [ms]."""

    name: str
    time: Data | None = None


@dataclass(frozen=True, slots=True)
class Attribute:
    """A setting for later moves: TM, TA or TS [ms], or F."""

    name: str
    value: Data


@dataclass(frozen=True, slots=True)
class Frame:
    """ABS, INC or FRAX of `axes` (empty for all), or NOFRAX."""

    name: str
    axes: str


@dataclass(frozen=True, slots=True)
class Pset:
    """PSET: new positions of axes, without a motion."""

    words: tuple[tuple[str, Data], ...]


@dataclass(frozen=True, slots=True)
class Pause:
    """DWELL or DELAY [ms]."""

    name: str
    time: Data


@dataclass(frozen=True, slots=True)
class Assign:
    """An assignment to one variable, or to several.

    Attributes:
        letter: I, P, Q or M.
        index: number of the variable, or of the first one.
        value: the value.
        synchronous: operator of an assignment that waits for the next move (==, &=, |=, ^=); empty otherwise.
        last: number of the last variable; None for a single one.
    """

    letter: str
    index: Data
    value: Data
    synchronous: str = ""
    last: int | None = None


@dataclass(frozen=True, slots=True)
class If:
    """IF, WHILE, AND or OR (`name`) with a condition."""

    name: str
    condition: Condition


@dataclass(frozen=True, slots=True)
class Plain:
    """A word without data: ELSE, ENDIF, ENDWHILE, WAIT, STOP, RETURN, and more."""

    name: str


@dataclass(frozen=True, slots=True)
class Jump:
    """GOTO or GOSUB (to a label), CALL (to a program and a label in it), or G, M, T or D."""

    name: str
    to: Data


@dataclass(frozen=True, slots=True)
class Label:
    """A label: N or O and a number."""

    number: int


@dataclass(frozen=True, slots=True)
class Say:
    """SEND (a text to the host; SEND^ a control character) or CMD (a line to the interpreter of on-line
    commands). `text` has no quotes.
    """

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Plcs:
    """ENABLE, DISABLE, PAUSE or RESUME (`name`) of PLCs."""

    name: str
    numbers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Home:
    """HOME or HOMEZ (`name`) of motors, in a program."""

    name: str
    motors: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Address:
    """ADDRESS#n&n: the motor and coordinate system that CMD of a PLC addresses."""

    motor: int | None
    system: int | None


@dataclass(frozen=True, slots=True)
class Skipped:
    """A word that a real controller executes, but the simulator skips."""

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
    """Return the number of words of memory that a statement takes in a buffer: 1 per value (TUM 337), 1 per
    keyword (assumed).
    """
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
    """Return True if a rotary can hold a statement: no branch, loop or label (PSRM 273)."""
    if isinstance(statement, If | Jump | Label):
        return False
    return not (isinstance(statement, Plain) and statement.name in _NOT_IN_ROTARY)
