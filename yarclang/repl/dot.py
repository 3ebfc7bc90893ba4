"""Dot commands: orders to the interpreter itself. Each module of `dots/` defines several."""

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
"""Function that carries out a command. Its arguments are the session and the text after the command's
name.
"""

Complete = Callable[[Session, str], Iterable[str]]
"""Function that returns completions of the text after the command's name."""


class Misused(Exception):  # noqa: N818 - a mistake of the user, not a failure
    """The text after a dot command isn't allowed. The message has the reason."""


@dataclass(frozen=True, slots=True)
class DotCommand:
    """A command for the terminal itself. Its name begins with a dot: `.stop`.

    Attributes:
        name: name with the dot.
        usage: arguments after the name.
        summary: description in one line.
        group: group of the command in the list of `.help`.
        run: function that carries out the command.
        overtakes: True if the command is carried out at once, even during a motion and before texts that
            wait.
        complete: function that returns completions of the arguments; None for none.
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
        """Return the command as users type it."""
        return f"{self.name} {self.usage}".rstrip()


@cache
def dot_commands() -> Mapping[str, DotCommand]:
    """Return all dot commands by name, in the order of `.help`.

    Raises:
        NamedTwice: two commands have the same name.
    """
    from yarclang.repl import dots

    modules = [f"{dots.__name__}.{module.name}" for module in iter_modules(dots.__path__)]
    found: list[tuple[str, str, DotCommand]] = [
        (one.name, place, one) for place in modules for one in import_module(place).COMMANDS
    ]
    return MappingProxyType(
        by_name("dot command", sorted(found, key=lambda one: (one[2].group, one[2].name)))
    )
