"""A program for the controller, before it is text."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.decisions import Register, Searched, Watch
from yarclang.frozen import frozen

Target = Literal["rotary", "prog"]


LOADING: Mapping[Target, str] = MappingProxyType(
    {
        "rotary": "loading moves nothing; R moves the robot slowly to the start, then runs the program",
        "prog": "loading moves nothing; with all motors closed-loop, &{system}B1R runs it, from the start only",
    }
)
"""What a person who loads the text by hand must know; `{system}` is the coordinate system."""


@frozen
class SegmentTime:
    """TM: the segment time of the moves that follow [ms], exactly as the controller keeps it."""

    milliseconds: float


@frozen
class Assignment:
    """A variable takes a value when the controller gets there; the motion doesn't mind.

    With `in_step`, when the move line behind it begins to move the robot, and not already when it is calculated (TUM, synchronous
    assignments).
    """

    variable: str
    value: float
    in_step: bool = False


@frozen
class Rest:
    """DWELL: the sequence ends, and the robot stands for so long [ms]; what follows is calculated behind it."""

    milliseconds: float


@frozen(eq=False)
class Stand:
    """The robot stands at `point` (axes,) [axis units]: a slow RAPID there, which is no motion if it does, and SPLINE1."""

    point: NDArray[np.float64]


BarrierKind = Literal[
    "wait", "hold", "when", "else", "end", "set", "stop", "abort", "say", "loop", "next", "exit", "endloop"
]


@frozen
class Barrier:
    """Where the program may not go on by itself: it waits for an input or the operator, its ways part or meet, a loop begins, begins anew, is left or ends, a register changes, or it ends.

    `wait` compares `variable` with `value`; `name` is the input's, the operator's text, or why the program ends. `timeout` is in s
    (None: for ever). `condition` is that of a `when`, and what a `set` gives to which register, in canonical form.
    """

    step: int
    kind: BarrierKind
    variable: str = ""
    value: float = 0.0
    timeout: float | None = None
    name: str = ""
    label: str = ""
    condition: str = ""


@frozen(eq=False)
class Moves:
    """Move lines of one command: `values` (k, axes) in axis units, rounded to the printed decimals."""

    step: int
    values: NDArray[np.float64]


Item = SegmentTime | Assignment | Rest | Stand | Barrier | Moves


@frozen
class Command:
    """What the map in the header says of a command of the program.

    `overlap` are the segments in which it flows into the next one, half of them after the end of its lines; None if it ends at rest. `any_jerk` says
    that its law has no limit of the jerk.
    """

    step: int
    index: str
    name: str
    source_line: int
    overlap: int | None = None
    any_jerk: bool = False


@frozen(eq=False)
class PmacProgram:
    """All that the text says.

    `start` (axes,) is where the motion begins, in axis units; `start_counts` and `start_slack` are the
    motors' positions there and how far each may be off [1/(Ixx08 32) count].
    `full_lines` and `low_lines` are I17 and I16: the rotary counts as full from so many lines ahead on,
    and as low below so many. `rotary_words` is the size to define. `safe_outputs` are the variables of outputs, and
    what they become when the guard has held the motion. `rapid` says whether a rotary begins with a slow RAPID to the start; without it the motion begins
    where the motors are commanded to stand. `registers` are those that the runtime keeps, `watches` the inputs that it looks at, and `searches` what ends which step on its way.
    """

    target: Target
    coordinate_system: int
    motors: tuple[int, ...]
    axes: tuple[str, ...]
    joint_names: tuple[str, ...]
    decimals: int
    start: NDArray[np.float64]
    start_counts: NDArray[np.float64]
    start_slack: NDArray[np.float64]
    rotary_words: int
    full_lines: int
    low_lines: int
    body: tuple[Item, ...]
    commands: tuple[Command, ...]
    safe_outputs: tuple[tuple[str, float], ...] = ()
    rapid: bool = True
    registers: tuple[Register, ...] = ()
    watches: tuple[Watch, ...] = ()
    searches: tuple[Searched, ...] = ()
