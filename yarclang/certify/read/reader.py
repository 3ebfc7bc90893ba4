"""How the judge reads the texts for a kind of controller: with a reader of its own, found by the kind's name."""

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
    """Where a text starts: joint positions `q` (n,), and how exact the text says that, `exact` (n,) [rad or m]; `is_printed` if it prints the positions themselves."""

    q: Array
    exact: Array
    is_printed: bool


@frozen
class Fault:
    """What is wrong with a text whatever its program: the code of the finding, and whether it is about the start, which is the first motion's."""

    code: str
    reason: str
    at_start: bool = False


@frozen(eq=False)
class Reader:
    """The judge's reader of the texts for a kind of controller. It shares no code with what writes them.

    Attributes:
        read: reads a whole text; every line must have the one form that is allowed in its place.
        start: tells where a text starts.
        faults: yields what is wrong with a text for this kind, whatever its program: segment times, the guard, what is assigned. The set has the variables of the
            program's outputs; None where the program isn't known.
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
