"""Define the interface of all kinds of controllers, as far as reading a robot.toml needs it.

Each kind of controller is a package `yarclang/backend_NAME`. Its `kind.py` has a `KIND` with all that is
needed to read a robot; its `backend.py` has everything else (`yarclang/backend.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from yarclang.frozen import frozen

if TYPE_CHECKING:
    from yarclang.toml.file import TomlFile
    from yarclang.toml.tables import Table


@frozen
class SignalVariable:
    """The controller variable that belongs to an input or output of a program, as found in a text.

    `name` is the usual form of the variable's name. It is None if the text names no variable; `fault` is then
    the reason and `remedy` the correction. `is_taken` is True if yarclang itself uses the variable.
    """

    name: str | None
    fault: str = ""
    remedy: str = ""
    is_taken: bool = False


NO_SIGNAL = SignalVariable(None, "is no variable: this controller has none", "leave it out")
"""Result for a kind of controller that has no inputs and outputs."""


class Controller(Protocol):
    """The connection of a robot to its controller.

    Each kind of controller has its own class, a frozen dataclass that may have more fields.
    """

    @property
    def kind(self) -> str:
        """The name of the kind, as in robot.toml."""

    @property
    def axes(self) -> tuple[str, ...]:
        """The controller's name of each joint."""

    @property
    def motors(self) -> tuple[int, ...]:
        """The number of each motor; motor k is row k of the actuation matrix."""

    @property
    def smallest_segment(self) -> float:
        """The shortest segment that the controller can calculate fast enough [s]."""

    @property
    def largest_segment(self) -> float:
        """The longest segment that is planned [s]."""

    @property
    def hold_time(self) -> float:
        """The time in which a hold brings the robot to rest on its path [s]. A hold is a pause of the
        program.
        """

    @property
    def rapid_share(self) -> float:
        """The share of the joints' velocity limits that the slow motion to a program's start position
        uses.
        """

    @property
    def text(self) -> str:
        """The robot's place on the controller, in words for people: `coordinate system 1`."""

    @property
    def timing(self) -> str:
        """The reason for the length of the shortest segment, in words for people."""

    def signal(self, text: str) -> SignalVariable:
        """Return the controller variable that `text` names; `text` is in upper case."""


@frozen(eq=False)
class Kind:
    """A kind of controller: the functions that are needed to read and write robot.toml files for it.

    Attributes:
        name: the kind's name in robot.toml.
        title: the kind's name for people, with its article.
        table: function that returns the schema of the table `[controller]`, a `ControllerTable`
            (`robot/schema.py`). It imports pydantic.
        controller: function that makes the controller from a `[controller]` table without mistakes and the
            motors' numbers.
        restored: function that makes a controller from the result of `dataclasses.asdict`.
        lines: function that takes the number of joints, and returns the lines of `[controller]` for a new
            robot.
        check: function that reports mistakes in a `[controller]` table, for a robot with a given number of
            joints.
        not_coupled: function that takes the axes whose joints have coupled motors. It returns the remedy if
            the controller can't couple these axes. It returns an empty text if the controller can, or if a
            name isn't that of an axis.
        signal: function that returns the controller variable of an input or output that a text in upper case
            names. It is used if the robot isn't known.
    """

    name: str
    title: str
    table: Callable[[], type[Table]]
    controller: Callable[[Any, Sequence[int]], Controller]
    restored: Callable[[Mapping[str, Any]], Controller]
    lines: Callable[[int], Sequence[str]]
    check: Callable[[TomlFile, Any, int], None] = lambda file, table, size: None  # noqa: ARG005
    not_coupled: Callable[[Sequence[str]], str] = lambda axes: ""  # noqa: ARG005
    signal: Callable[[str], SignalVariable] = lambda text: NO_SIGNAL  # noqa: ARG005
