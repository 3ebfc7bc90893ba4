"""The structure of a program for the controller, before it is printed as text."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.decisions import KeptTo, Permitted, Register, Searched, Shifted, Watch
from yarclang.frozen import frozen

Target = Literal["rotary", "prog"]


LOADING: Mapping[Target, str] = MappingProxyType(
    {
        "rotary": "loading moves nothing; R moves the robot slowly to the start, then runs the program",
        "prog": "loading moves nothing; with all motors closed-loop, &{system}B1R runs it, from the start "
        "only",
    }
)
"""Instructions for a person who loads a text by hand, for each kind of text; `{system}` is the coordinate
system.
"""


MOST_IN_STEP = 64
"""Largest number of synchronous assignments at one move. The controller stores them until the move begins;
its manuals don't state for how many it has room.
"""


@frozen
class SegmentTime:
    """TM: the segment time of the following moves [ms], exactly as the controller stores it."""

    milliseconds: float


@frozen
class Assignment:
    """Assignment of a value to a variable when the execution reaches it. It does not affect the motion.

    With `in_step`, the assignment takes effect when the next move line begins to move the robot, not when
    that line is calculated (TUM, synchronous assignments).
    """

    variable: str
    value: float
    in_step: bool = False


@frozen
class Disarm:
    """The line that disarms the guard after the last move."""


@frozen
class Rest:
    """DWELL: the sequence of moves ends, and the robot stands still for this time [ms]. The controller
    calculates the following lines only after the dwell.
    """

    milliseconds: float


@frozen(eq=False)
class Stand:
    """Stop at `point` (axes,) [axis units]. A slow RAPID moves the robot to the point, if it isn't there
    already. Then the mode is SPLINE1 again.
    """

    point: NDArray[np.float64]


BarrierKind = Literal[
    "wait", "hold", "when", "else", "end", "set", "stop", "abort", "say", "loop", "next", "exit", "endloop"
]


@frozen
class Barrier:
    """A place that the program passes only after the runtime has allowed it. In a program buffer, the
    controller decides this itself.

    At a barrier the program waits for an input or the operator; branches divide or join; a loop begins,
    repeats, is left or ends; a register changes; or the program ends.

    `wait` compares `variable` with `value`. `name` is the input's name, the text for the operator, or the
    reason why the program ends. `timeout` is in s (None: no limit). `condition` is the condition of a `when`,
    or the value and register of a `set`, in canonical form.
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


Item = SegmentTime | Assignment | Disarm | Rest | Stand | Barrier | Moves


@frozen
class Command:
    """One command of the program, as listed in the map in the text's header.

    `overlap` is the number of segments during which the command flows into the next one; None if it ends at
    rest. Half of these segments come after the end of the command's own lines. `any_jerk` is True if its
    motion profile has no jerk limit.
    """

    step: int
    index: str
    name: str
    source_line: int
    overlap: int | None = None
    any_jerk: bool = False


@frozen(eq=False)
class PmacProgram:
    """Everything that the text of a program contains.

    `start` (axes,) is where the motion begins, in axis units. `start_counts` and `start_slack` are the
    motors' positions at the start and the allowed deviation of each motor [1/(Ixx08 32) count]. `full_lines`
    and `low_lines` are I17 and I16: the rotary buffer counts as full from this many lines ahead on, and as
    low below this many. `rotary_words` is the size of the rotary buffer. `safe_outputs` are the variables of
    outputs and the values that they get after the guard has held the motion. `rapid` is True if a rotary
    program begins with a slow RAPID to the start; otherwise the motion begins at the commanded positions of
    the motors. `registers` are stored by the runtime, `watches` are the inputs that it observes, `searches`
    are the inputs that end a step early, `offsets` are the branches that the runtime plans in a shifted
    frame, `allows` are the bodies that may touch on a step, and `keeps` are the rules of KEEP that apply to a
    step.
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
    offsets: tuple[Shifted, ...] = ()
    allows: tuple[Permitted, ...] = ()
    keeps: tuple[KeptTo, ...] = ()
