"""Dot commands: what is typed for the interpreter itself, and not for the robot's program. Each file of `dots/` has some."""

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
"""Carries a command out: with the session, and what stands behind the command's name."""

Complete = Callable[[Session, str], Iterable[str]]
"""What may stand behind the command's name, for completion."""


class Misused(Exception):  # noqa: N818 - something a person did, and no failure
    """What stands behind a dot command isn't what it takes; the message says what is wrong."""


@dataclass(frozen=True, slots=True)
class DotCommand:
    """A dot command.

    Attributes:
        name: with its dot.
        usage: what may stand behind the name.
        summary: one line.
        group: of the list that `.help` shows.
        run: carries it out.
        overtakes: it is carried out at once, while something moves, and before what waits.
        complete: what may stand behind its name.
        doc: more, for `.help NAME`.
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
        """As it is typed."""
        return f"{self.name} {self.usage}".rstrip()


@cache
def dot_commands() -> Mapping[str, DotCommand]:
    """Return all of them by name, in the order in which `.help` lists them.

    Raises:
        NamedTwice: two of them have one name.
    """
    from yarclang.repl import dots

    modules = [f"{dots.__name__}.{module.name}" for module in iter_modules(dots.__path__)]
    found: list[tuple[str, str, DotCommand]] = [
        (one.name, place, one) for place in modules for one in import_module(place).COMMANDS
    ]
    return MappingProxyType(
        by_name("dot command", sorted(found, key=lambda one: (one[2].group, one[2].name)))
    )
