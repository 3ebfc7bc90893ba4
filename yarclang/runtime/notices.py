"""What a run tells those who watch it, and what they may order. Plain values; times are those of the host's clock [s]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from yarclang.runtime.sample import Sample
from yarclang.runtime.signals import Signal
from yarclang.runtime.state import State


@dataclass(frozen=True, slots=True)
class Question:
    """What the operator is asked for: an integer from `low` to `high`, which register gets it (`into`)."""

    text: str
    into: str
    low: int
    high: int


@dataclass(frozen=True, slots=True)
class Wanted:
    """Values that the program takes from outside while it waits.

    `number` counts what was asked for; `place` is that of the command. `registers` may be filled, each within `low` and `high`; a message must have all that are `needed`.
    """

    number: int
    place: str
    registers: tuple[tuple[str, int, int], ...]
    needed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ValuesWanted:
    """The program takes values from outside from now on, or, with None, takes no more."""

    time: float
    wanted: Wanted | None


@dataclass(frozen=True, slots=True)
class Changed:
    """The state is another one now, and why; if something went wrong, the code of the finding, and what to do. With `asks` it goes on with an answer only."""

    time: float
    state: State
    why: str
    code: str = ""
    remedy: str = ""
    asks: Question | None = None


@dataclass(frozen=True, slots=True)
class Progress:
    """How far the program is: the known seconds done, those to go at the present override, and the command that is executed.

    Motions and dwells count. Of a program whose ways part, `done` and `left` are those of the longer way.
    """

    time: float
    done: float
    left: float
    command: str
    source_line: int


@dataclass(frozen=True, slots=True)
class Remark:
    """Something worth knowing, in words; with `begins_pass` a loop begins anew."""

    time: float
    text: str
    warning: bool = False
    begins_pass: bool = False


@dataclass(frozen=True, slots=True)
class Reached:
    """The robot stands at a command that waits for an input or the operator: its place in the program, such as P0020(I=2)>P0010."""

    time: float
    place: str


@dataclass(frozen=True, slots=True)
class Planned:
    """What follows a search was planned and proved: its controller text, and its certificate as JSON."""

    time: float
    text: str
    certificate: str


Notice: TypeAlias = Changed | Progress | Remark | Reached | Planned | ValuesWanted | Signal | Sample


@dataclass(frozen=True, slots=True)
class Hold:
    """Come to rest on the path, ready to go on."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Go on behind a hold; `answer` is what the operator says if that was asked."""

    answer: int | None = None


@dataclass(frozen=True, slots=True)
class Stop:
    """Come to rest on the path and end the program."""


@dataclass(frozen=True, slots=True)
class Abort:
    """Each motor comes to rest at once, off the path, and the program ends."""


@dataclass(frozen=True, slots=True)
class Override:
    """Another pace: `percent` of the programmed speed, 1 to 100."""

    percent: float


@dataclass(frozen=True, slots=True)
class Fill:
    """Registers get these values from outside, all at once; `client` gives them. Whoever orders it has checked the values against what is wanted."""

    values: tuple[tuple[str, int], ...]
    client: str


@dataclass(frozen=True, slots=True)
class Fail:
    """Something outside failed (the log can't be written, say): come to rest on the path; it is a fault."""

    what: str
    remedy: str = ""


Order: TypeAlias = Hold | Resume | Stop | Abort | Override | Fill | Fail
