"""What a command is: one value of `CommandSpec`, or of `ActionSpec` for a word that isn't a motion, in one file of commands/builtin.

The checks, the documentation, the completion, the forms and the highlighter read it; nothing else in the language
knows a command by name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field
from enum import Enum
from typing import Any, Literal

from yarclang.frozen import frozen
from yarclang.hir import Action, Array, Origin, Reading, Search, Signal, Step, Timetable, Timing
from yarclang.units import Kind
from yarclang.words.spec import Slot


class Values(Enum):
    """What the values between two semicolons mean."""

    JOINTS = "joint values"
    JOINT_DELTAS = "joint increments"
    POSE_RPY = "a pose as x y z roll pitch yaw"
    POSE_QUAT = "a pose as x y z qx qy qz qw"
    POSITION = "a position as x y z"
    DELTA_RPY = "a pose increment as x y z roll pitch yaw"
    DELTA_QUAT = "a pose increment as x y z qx qy qz qw"

    @property
    def of_joints(self) -> bool:
        """Whether there is one value a joint, and so no frame is needed."""
        return self is Values.JOINTS or self is Values.JOINT_DELTAS

    @property
    def is_delta(self) -> bool:
        """Whether the values are counted from where the robot stands."""
        return self is Values.JOINT_DELTAS or self is Values.DELTA_RPY or self is Values.DELTA_QUAT

    @property
    def is_quaternion(self) -> bool:
        """Whether the orientation is a unit quaternion."""
        return self is Values.POSE_QUAT or self is Values.DELTA_QUAT

    def labels(self, joints: tuple[str, ...]) -> tuple[str, ...]:
        """The name of each value, for a robot with these joints."""
        if self.of_joints:
            return joints
        if self is Values.POSITION:
            return ("x", "y", "z")
        if self.is_quaternion:
            return ("x", "y", "z", "qx", "qy", "qz", "qw")
        return ("x", "y", "z", "roll", "pitch", "yaw")

    def kinds(self, joint_kinds: tuple[Kind, ...]) -> tuple[Kind | None, ...]:
        """The kind of unit of each value (None: a plain number)."""
        if self.of_joints:
            return joint_kinds
        if self is Values.POSITION:
            return ("length",) * 3
        if self.is_quaternion:
            return ("length",) * 3 + (None,) * 4
        return ("length",) * 3 + ("angle",) * 3


@frozen(eq=False)
class Timed:
    """The timetable of a motion: `table`, the tolerance `within` (n,) [rad or m], the factor `stretch` of all times, and the `file` that has the rows."""

    table: Timetable
    within: Array
    stretch: float
    file: str = ""


@frozen
class Arguments:
    """A checked command in SI, as its `build` gets it.

    `goals` has one entry a way-point: a JointGoal, JointDelta, PoseGoal or PoseDelta, as the
    target of the command's name says (a JointGoal wherever a joint position's name stands); a position is an array (3,) in {B}. `avoids` says that the name has _AVOID.
    """

    origin: Origin
    goals: tuple[Any, ...]
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    avoids: bool = False
    timed: Timed | None = None
    """What a command with `is_timed` has instead of goals."""
    search: Search | None = None
    """What ends a motion on its way; only of a command with `may_search`."""


@frozen
class CommandSpec:
    """One command of the language.

    `targets` maps the target suffix ("" for none) to what the values mean; a command
    without values has none. `waypoints` is the least and the largest number of way-points
    (None: any). `is_motion` commands take a profile and a motion time. `frames_may_move` allows a base
    frame that is carried by the robot. `leading` are the values of the first way-points where they differ from the target's.
    `moves_frame` commands lead the moving frame along a path, so that its speed may be given. `may_search`: an input may end it (UNTIL). `may_avoid`: it takes the suffix _AVOID, and `build` hears of it. `examples` are lines that compile as they stand for
    every robot after the standard DEFAULT of the documentation.
    """

    name: str
    summary: str
    doc: str
    build: Callable[[Arguments], Step]
    examples: tuple[str, ...]
    old_name: str = ""
    targets: Mapping[str, Values] = field(default_factory=dict)
    waypoints: tuple[int, int | None] = (1, 1)
    is_motion: bool = True
    frames_may_move: bool = False
    leading: tuple[Values, ...] = ()
    moves_frame: bool = False
    may_avoid: bool = False
    may_search: bool = False
    is_timed: bool = False
    """Whether each way-point has its own time: then the command takes no profile, and DEFAULT gives it no time. The way-points may stand in a file, whose path stands
    in quotes instead of them."""


@frozen
class ActionForm:
    """The parts that stand behind an action's word: the values, and whether a time in square brackets may (`may`) or must (`must`) follow."""

    slots: tuple[Slot, ...] = ()
    time: Literal["", "may", "must"] = ""


@frozen
class ActionArguments:
    """A checked action in SI, as its `build` gets it.

    Attributes:
        origin: the command.
        values: of its form's slots: a `Signal`, a number for a state, a str.
        seconds: the time that stands behind them [s]; None if there is none.
        report: adds a finding at the command: its code, its message, the help.
    """

    origin: Origin
    values: tuple[Signal | float | str, ...]
    seconds: float | None
    report: Callable[[str, str, str], object]


@frozen
class ActionSpec:
    """A command that isn't a motion: it says what is done between two motions.

    Attributes:
        name: the word.
        title: the heading of its form on pages: a few words.
        summary: one line.
        wants: its values in words, for who writes others: `an output and its value`.
        build: makes the steps, carried out one after the other. All of them have the origin of the arguments.
        forms: the sets of values that it takes, each with another number of values.
        examples: lines without an index, for which a signal has to be declared.
    """

    name: str
    title: str
    summary: str
    wants: str
    build: Callable[[ActionArguments], tuple[Action, ...]]
    forms: tuple[ActionForm, ...]
    examples: tuple[str, ...]

    @property
    def fullest(self) -> ActionForm:
        """The form with the most values."""
        return max(self.forms, key=lambda form: len(form.slots))

    @property
    def takes_time(self) -> bool:
        """True if a time may stand behind the values."""
        return any(form.time for form in self.forms)

    def form_of(self, count: int) -> ActionForm | None:
        """Return the form with so many values."""
        return next((form for form in self.forms if len(form.slots) == count), None)
