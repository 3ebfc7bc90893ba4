"""The syntax tree: what stands in the text, with nothing looked up.

A place is relative to its statement, so that an unchanged statement is the same value
wherever it moves in the file; `Statement.span` gives the place in the file.
"""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.source import SourceFile, Span


@dataclass(frozen=True, slots=True)
class Place:
    """Columns `start` to `end` (not included, from 1) of the statement's line number `row` (from 0)."""

    row: int
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Number:
    """A number as written and its value (infinite where the text overflows a float)."""

    text: str
    value: float
    place: Place


@dataclass(frozen=True, slots=True)
class Percent:
    """A percentage as written and its value in percent."""

    text: str
    value: float
    place: Place


@dataclass(frozen=True, slots=True)
class Word:
    """A name as written; `name` is its upper-case form."""

    text: str
    place: Place

    @property
    def name(self) -> str:
        """The name in the form in which names are compared."""
        return self.text.upper()


@dataclass(frozen=True, slots=True)
class Text:
    """A text in quotes; `text` has the quotes."""

    text: str
    place: Place


@dataclass(frozen=True, slots=True)
class Other:
    """Something that is none of the above (`30-5`, `0,5`): checked where it stands."""

    text: str
    place: Place


@dataclass(frozen=True, slots=True)
class FrameName:
    """A frame's name in braces; `text` has the braces."""

    text: str
    place: Place

    @property
    def name(self) -> str:
        """The name without braces, in upper case."""
        return self.text[1:-1].strip().upper()


Value = Number | Word | Text | Other


@dataclass(frozen=True, slots=True)
class WayPoint:
    """The values between two semicolons."""

    values: tuple[Value, ...]

    @property
    def place(self) -> Place:
        """From the first value to the last of the same row."""
        first = self.values[0].place
        last = [value.place for value in self.values if value.place.row == first.row][-1]
        return Place(first.row, first.start, last.end)


@dataclass(frozen=True, slots=True)
class Time:
    """What stands in square brackets."""

    items: tuple[Number | Word | Percent | Other, ...]
    place: Place


@dataclass(frozen=True, slots=True)
class Units:
    """What stands in round brackets."""

    items: tuple[Word | Number | Other, ...]
    place: Place


@dataclass(frozen=True, slots=True)
class Option:
    """An option behind the base frame, and its argument."""

    word: Word
    argument: Number | Percent | Word | Other | None


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment with its exclamation mark, in line `row` of its statement."""

    text: str
    place: Place


@dataclass(frozen=True, slots=True)
class Statement:
    """A command (with an index) or a declaration: its parts in the order of the language.

    `line` is the number of its first line in the file, `rows` how many lines it has.
    """

    line: int
    rows: int
    index: Word | None
    name: Word
    moving: FrameName | None
    waypoints: tuple[WayPoint, ...]
    time: Time | None
    units: Units | None
    base: FrameName | None
    options: tuple[Option, ...]
    comments: tuple[Comment, ...]

    def span(self, place: Place) -> Span:
        """The place in the file."""
        return Span.on_line(self.line + place.row, place.start, place.end)

    @property
    def head_span(self) -> Span:
        """The index (if there is one) and the name."""
        first = self.index.place if self.index else self.name.place
        return Span.on_line(self.line, first.start, self.name.place.end)

    @property
    def whole_span(self) -> Span:
        """From the first part to the end of the last."""
        start = self.index.place.start if self.index else self.name.place.start
        places = [self.name.place]
        places += [value.place for waypoint in self.waypoints for value in waypoint.values]
        places += [part.place for part in (self.moving, self.time, self.units, self.base) if part]
        places += [(option.argument or option.word).place for option in self.options]
        row, end = max((place.row, place.end) for place in places)
        return Span(self.line, start, self.line + row, end)


@dataclass(frozen=True, slots=True)
class Module:
    """A file's statements in order, the first lines of those that couldn't be read, and its
    comment lines by line number.
    """

    source: SourceFile
    statements: tuple[Statement, ...]
    unreadable_lines: tuple[int, ...]
    comment_lines: tuple[tuple[int, str], ...]
