"""Facts of findings for programs that act on them. Messages are only for people, and never parsed."""

from __future__ import annotations

from collections.abc import Iterable

from yarclang.frozen import frozen
from yarclang.suggestions import near
from yarclang.units import Kind


@frozen
class Name:
    """A name that is unknown, or isn't allowed at its place.

    Attributes:
        name: the name in the form in which names are compared: in upper case, without braces.
        meant: similar known name, as it is written; empty without one.
        others: further similar names.
    """

    name: str
    meant: str = ""
    others: tuple[str, ...] = ()

    @property
    def question(self) -> str:
        """Return `did you mean X, or Y?`; empty if no known name is similar."""
        return f"did you mean {', or '.join((self.meant, *self.others))}?" if self.meant else ""


@frozen
class MissingUnit:
    """A missing unit.

    Attributes:
        kind: kind of the unit.
        of: the value that needs it, such as `the speed`.
    """

    kind: Kind
    of: str


@frozen
class LeftOut:
    """Something that a command needs, but doesn't have.

    Attributes:
        what: its name, such as `the motion time`.
    """

    what: str


Subject = Name | MissingUnit | LeftOut


def unknown(text: str, known: Iterable[str] = ()) -> Name:
    """Return a word of a program as a name that isn't among `known`."""
    meant, *others = near(text, known) or ("",)
    return Name(text.strip("{}$() ").upper(), meant, tuple(others))


def suggest(word: str, known: Iterable[str]) -> str:
    """Return `did you mean X?` for a mistyped word; empty if no known name is similar."""
    return unknown(word, known).question
