"""Notices that a run sends to its listeners, and orders that it accepts. Plain values; times are those of the
host's clock [s].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from yarclang.runtime.sample import Sample
from yarclang.runtime.signals import Signal
from yarclang.runtime.state import State


@dataclass(frozen=True, slots=True)
class Question:
    """A question to the operator: an integer from `low` to `high` is wanted for the register `into`."""

    text: str
    into: str
    low: int
    high: int


@dataclass(frozen=True, slots=True)
class Wanted:
    """Values that the program takes from outside while it waits.

    `number` counts the requests; `place` is the place of the command. `registers` may be filled, each within
    `low` and `high`; a message must have all that are `needed`.
    """

    number: int
    place: str
    registers: tuple[tuple[str, int, int], ...]
    needed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ValuesWanted:
    """The program takes values from outside from now on, or, with None, no longer."""

    time: float
    wanted: Wanted | None


@dataclass(frozen=True, slots=True)
class Changed:
    """The state has changed, and why.

    If something went wrong, `code` is the finding and `remedy` what to do. With `asks`, the run continues
    only after an answer.
    """

    time: float
    state: State
    why: str
    code: str = ""
    remedy: str = ""
    asks: Question | None = None


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of the program: the known seconds done, those left at the present override, and the current
    command.

    Motions and dwells count. If the program has branches, `done` and `left` follow the longer one.
    """

    time: float
    done: float
    left: float
    command: str
    source_line: int


@dataclass(frozen=True, slots=True)
class Remark:
    """Information in words; with `begins_pass`, a loop repeats."""

    time: float
    text: str
    warning: bool = False
    begins_pass: bool = False


@dataclass(frozen=True, slots=True)
class Reached:
    """The robot stands at a command that waits for an input or the operator. The place in the program is
    given as P0020(I=2)>P0010.
    """

    time: float
    place: str


@dataclass(frozen=True, slots=True)
class Planned:
    """The rest of the program after a search, or the lines of an OFFSET (`kind`), was planned and proved: its
    controller text, and its certificate as JSON.
    """

    time: float
    text: str
    certificate: str
    kind: Literal["search", "offset"] = "search"


Notice: TypeAlias = Changed | Progress | Remark | Reached | Planned | ValuesWanted | Signal | Sample


@dataclass(frozen=True, slots=True)
class Hold:
    """Come to rest on the path, ready to continue."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Continue after a hold; `answer` is the operator's answer, if a question was asked."""

    answer: int | None = None


@dataclass(frozen=True, slots=True)
class Stop:
    """Come to rest on the path and end the program."""


@dataclass(frozen=True, slots=True)
class Abort:
    """Bring each motor to rest at once, off the path, and end the program."""


@dataclass(frozen=True, slots=True)
class Override:
    """Set the override: `percent` of the programmed speed, 1 to 100."""

    percent: float


@dataclass(frozen=True, slots=True)
class Fill:
    """Set registers to these values from outside, all at once; `client` sends them.

    The sender has checked the values against what is wanted.
    """

    values: tuple[tuple[str, int], ...]
    client: str


@dataclass(frozen=True, slots=True)
class Fail:
    """Come to rest on the path as a fault, because something outside failed (for example, the log can't be
    written).
    """

    what: str
    remedy: str = ""


Order: TypeAlias = Hold | Resume | Stop | Abort | Override | Fill | Fail
