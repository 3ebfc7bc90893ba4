"""The judge's readers of controller texts, found by the kind of the controller."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Set
from importlib import import_module

from yarclang.certify.read.text import ControllerText, Unreadable
from yarclang.frozen import frozen
from yarclang.memory import Memory
from yarclang.robot.controller import Controller
from yarclang.robot.kinds import module_of
from yarclang.robot.model import Array, Robot


@frozen(eq=False)
class StartPlace:
    """Joint positions at the start of a controller text.

    Attributes:
        q: (n,) joint positions [rad or m].
        exact: (n,) precision with which the text gives them [rad or m].
        is_printed: True if the text prints the joint positions themselves.
    """

    q: Array
    exact: Array
    is_printed: bool


@frozen
class Fault:
    """A fault in a controller text that can be found without the program.

    Attributes:
        code: code of the finding.
        reason: the fault in words.
        at_start: True if the fault concerns the start, and thus the first motion.
    """

    code: str
    reason: str
    at_start: bool = False


@frozen(eq=False)
class Reader:
    """The judge's reader of the controller texts for one kind of controller.

    It shares no code with the writer of these texts.

    Attributes:
        read: function that reads a whole text; every line must have the one form that is allowed in its
            place.
        start: function that returns the joint positions at the start of a text.
        faults: function that yields the faults in a text that can be found without the program: in segment
            times, the guard, assignments. Its last argument is the set of the variables of the program's
            outputs; None if the program is unknown.
    """

    read: Callable[[str, Controller, Memory], ControllerText | Unreadable]
    start: Callable[[ControllerText, Robot], StartPlace]
    faults: Callable[[ControllerText, Robot, Set[str] | None], Iterator[Fault]]


def reader_of(controller: Controller) -> Reader:
    """Return the reader of the texts for a controller.

    Raises:
        KeyError: there is no such kind of controller.
    """
    found: Reader = import_module(module_of(controller.kind)).BACKEND.reader()
    return found
