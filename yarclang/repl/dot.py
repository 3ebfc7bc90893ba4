"""Dot commands: orders to the interpreter itself. Each module of `dots/` defines some."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType

from yarclang.named import by_name
from yarclang.repl.session import Session

Run = Callable[[Session, str], Awaitable[None] | None]
"""Carries out a command, called with the session and the text after the command's name."""

Complete = Callable[[Session, str], Iterable[str]]
"""Returns completions of the text after the command's name."""


class Misused(Exception):  # noqa: N818 - something a person did, and no failure
    """The text after a dot command isn't allowed; the message says why."""


@dataclass(frozen=True, slots=True)
class DotCommand:
    """A dot command.

    Attributes:
        name: name with its dot.
        usage: arguments after the name.
        summary: one line.
        group: its group in the list of `.help`.
        run: carries it out.
        overtakes: True if it is carried out at once, even during a motion and before waiting texts.
        complete: returns completions of its arguments; None for none.
        doc: further text for `.help NAME`.
    """

    name: str
    usage: str
    summary: str
    group: str
    run: Run
    overtakes: bool = False
    complete: Complete | None = None
    doc: str = ""

    @property
    def line(self) -> str:
        """Return the command as it is typed."""
        return f"{self.name} {self.usage}".rstrip()


@cache
def dot_commands() -> Mapping[str, DotCommand]:
    """Return all dot commands by name, in the order of `.help`.

    Raises:
        NamedTwice: two commands have one name.
    """
    from yarclang.repl import dots

    modules = [f"{dots.__name__}.{module.name}" for module in iter_modules(dots.__path__)]
    found: list[tuple[str, str, DotCommand]] = [
        (one.name, place, one) for place in modules for one in import_module(place).COMMANDS
    ]
    return MappingProxyType(
        by_name("dot command", sorted(found, key=lambda one: (one[2].group, one[2].name)))
    )
