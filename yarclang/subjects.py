"""Facts about findings, as data for programs that act on findings. Messages are only for people, and never
parsed.
"""

from __future__ import annotations

from collections.abc import Iterable

from yarclang.frozen import frozen
from yarclang.suggestions import near
from yarclang.units import Kind


@frozen
class Name:
    """The fact that a name is unknown, or isn't allowed at its place.

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
    """The fact that a value lacks its unit.

    Attributes:
        kind: kind of the unit.
        of: the value that needs the unit, such as `the speed`.
    """

    kind: Kind
    of: str


@frozen
class LeftOut:
    """The fact that a command lacks something that it needs.

    Attributes:
        what: what is missing, such as `the motion time`.
    """

    what: str


Subject = Name | MissingUnit | LeftOut


def unknown(text: str, known: Iterable[str] = ()) -> Name:
    """Return the subject of a finding about an unknown word of a program: the word, and similar names among
    `known`.
    """
    meant, *others = near(text, known) or ("",)
    return Name(text.strip("{}$() ").upper(), meant, tuple(others))


def suggest(word: str, known: Iterable[str]) -> str:
    """Return `did you mean X?` for a mistyped word; empty if no known name is similar."""
    return unknown(word, known).question
