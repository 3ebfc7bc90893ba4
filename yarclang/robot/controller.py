"""What all kinds of controllers have in common, as far as a robot.toml tells of them.

A kind is a package `yarclang/backend_NAME`: its `kind.py` has a `KIND`, which is all that is needed to read a robot; its `backend.py` has all else
(`yarclang/backend.py`).
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
    """The controller's variable of an input or output in its usual form, M1 for M01; else None, what is wrong with it, and the remedy; `is_taken` if yarclang itself uses it."""

    name: str | None
    fault: str = ""
    remedy: str = ""
    is_taken: bool = False


class Controller(Protocol):
    """How a robot hangs on its controller. Each kind has a class of its own, a frozen dataclass with what else it needs."""

    @property
    def kind(self) -> str:
        """The name of the kind, as robot.toml writes it."""

    @property
    def axes(self) -> tuple[str, ...]:
        """What the controller calls each joint."""

    @property
    def motors(self) -> tuple[int, ...]:
        """The number of each motor; motor k is row k of the actuation matrix."""

    @property
    def smallest_segment(self) -> float:
        """The shortest segment that the controller calculates in time [s]."""

    @property
    def largest_segment(self) -> float:
        """The longest segment that is planned [s]."""

    @property
    def hold_time(self) -> float:
        """How long a hold takes to bring the robot to rest on its path [s]."""

    @property
    def rapid_share(self) -> float:
        """The share of the velocity limits that the slow motion to a program's start uses."""

    @property
    def text(self) -> str:
        """Where the robot hangs on it, for people: `coordinate system 1`."""

    @property
    def timing(self) -> str:
        """What the shortest segment follows from, for people."""

    def signal(self, text: str) -> SignalVariable:
        """Return what a text in upper case names as the variable of an input or output."""


@frozen(eq=False)
class Kind:
    """A kind of controller, as far as a robot.toml tells of it.

    Attributes:
        name: as robot.toml writes it.
        title: for people, with its article.
        table: returns the form of `[controller]`, a `ControllerTable` (`robot/schema.py`); it imports pydantic.
        check: says what is wrong with a table of that form, for a robot of so many joints.
        not_coupled: says what to do where the axes of joints whose motors are coupled can't be; empty: they can, or are no axes.
        controller: makes the controller of a table without mistakes, and of the motors' numbers.
        restored: makes a controller of what `dataclasses.asdict` made of one.
        lines: returns `[controller]` for a new robot of so many joints.
        signal: tells what a text in upper case names as the variable of an input or output, where the robot isn't known.
    """

    name: str
    title: str
    table: Callable[[], type[Table]]
    check: Callable[[TomlFile, Any, int], None]
    not_coupled: Callable[[Sequence[str]], str]
    controller: Callable[[Any, Sequence[int]], Controller]
    restored: Callable[[Mapping[str, Any]], Controller]
    lines: Callable[[int], Sequence[str]]
    signal: Callable[[str], SignalVariable]
