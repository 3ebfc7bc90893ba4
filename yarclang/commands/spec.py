"""Specifications of commands: a `CommandSpec`, or an `ActionSpec` for a command without motion.

Each specification is in a file of commands/builtin. The checks, the documentation, the completion, the forms
and the highlighter read these files; no other code knows a command by its name.
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
    """The kind of the values that a command takes between two semicolons."""

    JOINTS = "joint values"
    JOINT_DELTAS = "joint increments"
    POSE_RPY = "a pose as x y z roll pitch yaw"
    POSE_QUAT = "a pose as x y z qx qy qz qw"
    POSITION = "a position as x y z"
    DELTA_RPY = "a pose increment as x y z roll pitch yaw"
    DELTA_QUAT = "a pose increment as x y z qx qy qz qw"

    @property
    def of_joints(self) -> bool:
        """True if there is one value for each joint; no frame is needed then."""
        return self is Values.JOINTS or self is Values.JOINT_DELTAS

    @property
    def is_delta(self) -> bool:
        """True if the values are relative to the robot's current position."""
        return self is Values.JOINT_DELTAS or self is Values.DELTA_RPY or self is Values.DELTA_QUAT

    @property
    def is_quaternion(self) -> bool:
        """True if the orientation is a unit quaternion."""
        return self is Values.POSE_QUAT or self is Values.DELTA_QUAT

    def labels(self, joints: tuple[str, ...]) -> tuple[str, ...]:
        """Return the name of each value, for a robot with these joints."""
        if self.of_joints:
            return joints
        if self is Values.POSITION:
            return ("x", "y", "z")
        if self.is_quaternion:
            return ("x", "y", "z", "qx", "qy", "qz", "qw")
        return ("x", "y", "z", "roll", "pitch", "yaw")

    def kinds(self, joint_kinds: tuple[Kind, ...]) -> tuple[Kind | None, ...]:
        """Return the kind of unit (length, angle) of each value of a command; None for a plain number.

        Args:
            joint_kinds: kind of unit of each joint value.
        """
        if self.of_joints:
            return joint_kinds
        if self is Values.POSITION:
            return ("length",) * 3
        if self.is_quaternion:
            return ("length",) * 3 + (None,) * 4
        return ("length",) * 3 + ("angle",) * 3


@frozen(eq=False)
class Timed:
    """The timetable that a motion command gives.

    Attributes:
        table: times and positions of the waypoints.
        within: (n,) tolerance of the joints [rad or m].
        stretch: factor that multiplies all times.
        file: path of the file with the rows; empty if the rows are in the program.
    """

    table: Timetable
    within: Array
    stretch: float
    file: str = ""


@frozen
class Arguments:
    """A checked motion command in SI units: the argument of the `build` function of its `CommandSpec`.

    Attributes:
        origin: the command.
        goals: for each waypoint a JointGoal, JointDelta, PoseGoal or PoseDelta, depending on the target in
            the command's name. The name of a joint position gives a JointGoal; a position is an array (3,) in
            {B} [m].
        profile: name of the time profile.
        timing: motion time, or how to choose it.
        tolerance: TOL [m]; None without it.
        blend: BLEND; None without it.
        avoids: True if the name has _AVOID.
        timed: timetable of a command with `is_timed`, which has it instead of goals.
        search: input that ends the motion, only for commands with `may_search`; None without one.
    """

    origin: Origin
    goals: tuple[Any, ...]
    profile: str
    timing: Timing
    tolerance: float | None = None
    blend: Reading | None = None
    avoids: bool = False
    timed: Timed | None = None
    search: Search | None = None


@frozen
class CommandSpec:
    """The specification of one command of the language.

    Attributes:
        name: the command's name.
        summary: one line about the command.
        doc: description on documentation pages.
        build: function that creates the command's step.
        examples: lines that compile for every robot after the standard DEFAULT of the documentation.
        old_name: a former name, which gets a finding with a fix; empty without one.
        targets: kind of the values for each target suffix ("" for none); empty for a command without values.
        waypoints: smallest and largest number of waypoints (None: no limit).
        is_motion: True if the command accepts a profile and a motion time.
        frames_may_move: True if the base frame may be on the flange.
        leading: kinds of the values of the first waypoints, if they differ from the target's.
        moves_frame: True if the command moves the moving frame along a path. A speed is then allowed.
        may_avoid: True if the command accepts the suffix _AVOID.
        may_search: True if an input may end the command (UNTIL).
        is_timed: True if each waypoint has its own time. The command then accepts no profile, and ignores
            the time of DEFAULT. The path of a file in quotes may replace the waypoints.
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


@frozen
class ActionForm:
    """One form of an action (a command without motion): the values after the action's word.

    Attributes:
        slots: kinds of the values.
        time: `may` or `must` if a time in square brackets may or must follow; empty if none is allowed.
    """

    slots: tuple[Slot, ...] = ()
    time: Literal["", "may", "must"] = ""


@frozen
class ToolChange:
    """A change of the tool on the flange.

    Attributes:
        tool: name of the tool that is on the flange afterwards; empty for none.
        lock: output of the changer.
        value: the output's value from then on.
    """

    tool: str
    lock: Signal
    value: float


ActionValue = Signal | float | str | ToolChange


@frozen
class ActionArguments:
    """A checked action (a command without motion) in SI units: the argument of the `build` function of its
    `ActionSpec`.

    Attributes:
        origin: the command.
        values: values of the slots of the action's form: a `Signal`, a number for a state, a `ToolChange`, or
            a str.
        seconds: the time after the values [s]; None without one.
        report: function that adds a finding at the command, from code, message and help.
    """

    origin: Origin
    values: tuple[ActionValue, ...]
    seconds: float | None
    report: Callable[[str, str, str], object]


@frozen
class ActionSpec:
    """The specification of an action: a command without motion, carried out between two motions.

    Attributes:
        name: the word.
        title: heading of the action's form on pages: a few words.
        summary: one line about the action.
        wants: description of the values, for the finding about wrong ones: `an output and its value`.
        build: function that creates the steps, which are carried out one after the other. All steps get
            the `origin` of the arguments.
        forms: the sets of values that the action accepts, each with a different number of values.
        examples: lines without an index. Their signals must be declared first.
        may_be_a_name: True if the word may also be a declared name, because older programs use it as one.
    """

    name: str
    title: str
    summary: str
    wants: str
    build: Callable[[ActionArguments], tuple[Action, ...]]
    forms: tuple[ActionForm, ...]
    examples: tuple[str, ...]
    may_be_a_name: bool = False

    @property
    def fullest(self) -> ActionForm:
        """Form with the most values."""
        return max(self.forms, key=lambda form: len(form.slots))

    @property
    def takes_time(self) -> bool:
        """True if a time may follow the values."""
        return any(form.time for form in self.forms)

    def form_of(self, count: int) -> ActionForm | None:
        """Return the form with `count` values; None without one."""
        return next((form for form in self.forms if len(form.slots) == count), None)
