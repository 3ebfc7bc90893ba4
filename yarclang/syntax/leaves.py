"""The leaves of the syntax tree. A leaf is the value of one token, with its place."""

from __future__ import annotations

from typing import Any

from yarclang.frozen import frozen


@frozen
class Place:
    """A place in a statement: the columns from `start` up to, but not including, `end` in row `row`. Columns
    count from 1, rows from 0.
    """

    row: int
    start: int
    end: int


def place_of(token: Any) -> Place:
    """Return the place of a parser's token."""
    column = token.column
    return Place(token.line - 1, column, column + len(token))


def from_to(first: Place, last: Place) -> Place:
    """Return the place in one row from the beginning of a place to the end of another place."""
    return Place(first.row, first.start, last.end)


@frozen
class Number:
    """A number as written, and its value (infinite if the text overflows a float)."""

    text: str
    value: float
    place: Place


@frozen
class Percent:
    """A percentage as written and its value in percent."""

    text: str
    value: float
    place: Place


@frozen
class Word:
    """A name as written; `name` is its upper-case form."""

    text: str
    place: Place

    @property
    def name(self) -> str:
        """Return the name in the form in which names are compared."""
        return self.text.upper()


@frozen
class Text:
    """A text in quotes; `text` includes the quotes."""

    text: str
    place: Place


@frozen
class Other:
    """A token that is neither a number nor a name nor a text, such as `30-5`, `0,5` or `<=`. The code that
    uses the token decides if it is allowed.
    """

    text: str
    place: Place


@frozen
class FrameName:
    """A frame's name in braces; `text` includes the braces."""

    text: str
    place: Place

    @property
    def name(self) -> str:
        """Return the name without braces, in upper case."""
        return self.text[1:-1].strip().upper()


@frozen
class Quantity:
    """A number with its own unit, `60 (mm)`: in an expression, or among the arguments of CALL."""

    number: Number
    unit: Word
    place: Place

    @property
    def text(self) -> str:
        """Return the number and its unit in their standard form."""
        return f"{self.number.text} ({self.unit.text})"
