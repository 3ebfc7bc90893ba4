"""Notices that a run sends to its listeners, and orders that the run accepts. Both are plain values; times
are those of the host's clock [s].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from yarclang.runtime.sample import Sample
from yarclang.runtime.signals import Signal
from yarclang.runtime.state import State


@dataclass(frozen=True, slots=True)
class Question:
    """A question to the operator, who enters an integer from `low` to `high` for the register `into`."""

    text: str
    into: str
    low: int
    high: int


@dataclass(frozen=True, slots=True)
class Wanted:
    """Values that the program accepts from other programs while it waits.

    Attributes:
        number: number of this request for values, counted over the run.
        place: the command at which the program waits.
        registers: registers that a message may fill, each with its smallest and its largest value.
        needed: registers that each message must contain.
    """

    number: int
    place: str
    registers: tuple[tuple[str, int, int], ...]
    needed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ValuesWanted:
    """Notice that the program accepts values from other programs from now on. If `wanted` is None, it accepts
    none any more.
    """

    time: float
    wanted: Wanted | None


@dataclass(frozen=True, slots=True)
class Changed:
    """Notice that the state of the run has changed, with the reason.

    If something went wrong, `code` is the code of the finding and `remedy` what to do. If `asks` is set, the
    run continues only after an answer to this question.
    """

    time: float
    state: State
    why: str
    code: str = ""
    remedy: str = ""
    asks: Question | None = None


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of the program. If the program has branches, times follow the longer branch. Waits of unknown
    length don't count.

    Attributes:
        time: time of the notice [s].
        done: time of the motions and dwells so far [s].
        left: time of the motions and dwells to come, at the present override [s].
        command: the present command.
        source_line: line of this command in the program's source.
    """

    time: float
    done: float
    left: float
    command: str
    source_line: int


@dataclass(frozen=True, slots=True)
class Remark:
    """Notice with information in words. `begins_pass` is True if a loop begins its next pass."""

    time: float
    text: str
    warning: bool = False
    begins_pass: bool = False


@dataclass(frozen=True, slots=True)
class Reached:
    """Notice that the robot stands at a command that waits for an input or the operator. The command is
    written as P0020; inside a loop or a call as P0020(I=2)>P0010.
    """

    time: float
    place: str


@dataclass(frozen=True, slots=True)
class Planned:
    """Notice that a part of the program was planned and proved at run time: what follows a search, or the
    lines of an OFFSET (`kind`).

    `text` is the controller text of this part, and `certificate` its certificate as JSON.
    """

    time: float
    text: str
    certificate: str
    kind: Literal["search", "offset"] = "search"


Notice: TypeAlias = Changed | Progress | Remark | Reached | Planned | ValuesWanted | Signal | Sample


@dataclass(frozen=True, slots=True)
class Hold:
    """Order to come to rest on the path, ready to continue."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Order to continue after a hold; `answer` is the operator's answer, if a question was asked."""

    answer: int | None = None


@dataclass(frozen=True, slots=True)
class Stop:
    """Order to come to rest on the path and end the program."""


@dataclass(frozen=True, slots=True)
class Abort:
    """Order to bring each motor to rest at once, off the path, and end the program."""


@dataclass(frozen=True, slots=True)
class Override:
    """Order to set the override: `percent` of the programmed speed, 1 to 100."""

    percent: float


@dataclass(frozen=True, slots=True)
class Fill:
    """Set registers to values from other programs, all at once; `client` is the sender.

    The sender has checked that the values are wanted and in range.
    """

    values: tuple[tuple[str, int], ...]
    client: str


@dataclass(frozen=True, slots=True)
class Fail:
    """Order to come to rest on the path and to report a fault, because something outside the controller has
    failed (for example, the log can't be written).
    """

    what: str
    remedy: str = ""


Order: TypeAlias = Hold | Resume | Stop | Abort | Override | Fill | Fail
