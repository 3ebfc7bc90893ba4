"""Define the part of the interface of a kind of controller that is needed to read a robot.toml.

Each kind of controller is a package `yarclang/backend_NAME`. Its module `kind.py` defines `KIND`, a `Kind`,
which contains everything that is needed to read a robot. Its module `backend.py` defines `BACKEND`, a
`Backend` (`yarclang/backend.py`), which contains everything else.
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
    """The controller variable that a text, such as an entry of a cell.toml, names as an input or output.

    Attributes:
        name: usual form of the variable's name; None if the text names no variable.
        fault: reason why the text names no variable.
        remedy: how to correct the text.
        is_taken: True if yarclang itself uses the variable.
    """

    name: str | None
    fault: str = ""
    remedy: str = ""
    is_taken: bool = False


NO_SIGNAL = SignalVariable(None, "isn't a variable: this controller has none", "remove it")
"""Result of `Kind.signal` for every text if the controller has no inputs and outputs."""


class Controller(Protocol):
    """The connection of a robot to its controller.

    Each kind of controller has its own class, a frozen dataclass that may have more fields.
    """

    @property
    def kind(self) -> str:
        """The name of the kind, as in robot.toml."""

    @property
    def axes(self) -> tuple[str, ...]:
        """The controller's name for each joint."""

    @property
    def motors(self) -> tuple[int, ...]:
        """The controller's number of each motor, in the order of the rows of the actuation matrix."""

    @property
    def smallest_segment(self) -> float:
        """The shortest duration of a segment [s]. The controller can't calculate shorter segments in time."""

    @property
    def largest_segment(self) -> float:
        """The longest duration of a segment that the planner uses [s]."""

    @property
    def hold_time(self) -> float:
        """The time in which a hold brings the robot to rest on its path [s]. A hold is a pause of the
        program.
        """

    @property
    def rapid_share(self) -> float:
        """The speed of the slow motion to a program's start position, as a fraction of the joints' velocity
        limits.
        """

    @property
    def text(self) -> str:
        """The controller's name for the whole robot, as messages use it: `coordinate system 1`."""

    @property
    def timing(self) -> str:
        """The reason why no segment may be shorter than `smallest_segment`, as messages state it."""

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
        controller: function that makes the controller from a correct `[controller]` table and the numbers of
            the motors.
        restored: function that makes a controller from the result of `dataclasses.asdict`.
        lines: function that takes the number of joints, and returns the lines of `[controller]` for a new
            robot.
        check: function that reports mistakes in a `[controller]` table, for a robot with a given number of
            joints.
        not_coupled: function that takes the axes whose joints have coupled motors. It returns the remedy if
            the controller can't couple these axes. It returns an empty text if the controller can, or if a
            name isn't that of an axis.
        signal: function that takes a text in upper case, and returns the controller variable that the text
            names. It is used if the robot isn't known; otherwise, `Controller.signal` is used.
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
