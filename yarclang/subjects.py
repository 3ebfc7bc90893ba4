"""What findings are about, for programs that act on them: a message is only for people, and nobody reads one back."""

from __future__ import annotations

from collections.abc import Iterable

from yarclang.frozen import frozen
from yarclang.suggestions import near
from yarclang.units import Kind


@frozen
class Name:
    """A name that isn't known, or isn't what is wanted in its place.

    Attributes:
        name: as programs compare names: in upper case, without braces.
        meant: the known name that it may stand for, as that is written; empty: none is near.
        others: further names that it may stand for as well.
    """

    name: str
    meant: str = ""
    others: tuple[str, ...] = ()

    @property
    def question(self) -> str:
        """Return `did you mean X, or Y?`, or nothing if no known name is near."""
        return f"did you mean {', or '.join((self.meant, *self.others))}?" if self.meant else ""


@frozen
class MissingUnit:
    """A unit that isn't given.

    Attributes:
        kind: of the unit.
        of: what needs it, as `the speed`.
    """

    kind: Kind
    of: str


@frozen
class LeftOut:
    """Something that a command needs and doesn't say, as `the motion time`."""

    what: str


Subject = Name | MissingUnit | LeftOut


def unknown(text: str, known: Iterable[str] = ()) -> Name:
    """Return a word of a program as a name that isn't one of `known`."""
    meant, *others = near(text, known) or ("",)
    return Name(text.strip("{}$() ").upper(), meant, tuple(others))


def suggest(word: str, known: Iterable[str]) -> str:
    """Return `did you mean X?` for a mistyped word, or nothing if no known name is near."""
    return unknown(word, known).question
