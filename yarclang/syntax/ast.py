"""The syntax tree: what stands in the text, with nothing looked up.

A place is relative to its statement, so that an unchanged statement is the same value
wherever it moves in the file; `Statement.span` gives the place in the file.
"""

from __future__ import annotations

from yarclang.frozen import frozen
from yarclang.source import SourceFile, Span
from yarclang.syntax.expressions import Expression
from yarclang.syntax.leaves import FrameName, Number, Other, Parameter, Percent, Place, Quantity, Text, Word

__all__ = [
    "Block",
    "Comment",
    "Computed",
    "ComputedPercent",
    "FrameName",
    "Module",
    "Node",
    "Number",
    "Option",
    "Other",
    "Parameter",
    "Percent",
    "Place",
    "Quantity",
    "Rate",
    "Statement",
    "Text",
    "Time",
    "Units",
    "Value",
    "WayPoint",
    "Word",
]


@frozen
class Computed:
    """An expression that stands for a number, as written: `$NAME` or `$(expression)`."""

    text: str
    expression: Expression
    place: Place


@frozen
class ComputedPercent:
    """An expression that stands for the number of a percentage, as written: `$SHARE%`."""

    text: str
    expression: Expression
    place: Place


Value = Number | Word | Text | Other | Computed | FrameName | Quantity | Parameter
"""What stands between blanks. Frames and quantities stand only among CALL's arguments, frames and parameters
in the head of a SUB."""


Item = Value | Percent | ComputedPercent
"""What stands at a way-point, its time among it."""


@frozen
class Rate:
    """Velocities or accelerations of all joints at a way-point: VEL or ACC, and their values."""

    word: Word
    values: tuple[Value, ...]

    @property
    def place(self) -> Place:
        """From the word to the last value of the same row."""
        row = self.word.place.row
        last = [value.place for value in self.values if value.place.row == row]
        return Place(row, self.word.place.start, (last[-1] if last else self.word.place).end)


@frozen
class WayPoint:
    """The values between two semicolons; the words, arguments or parameters of a line that has no way-points.

    `time` is the way-point's own time in square brackets, `velocity` and `acceleration` what stands behind it (VEL, ACC). The time of
    the last way-point is the motion time of its statement, and stands there.
    """

    values: tuple[Value, ...]
    time: Time | None = None
    velocity: Rate | None = None
    acceleration: Rate | None = None

    @property
    def items(self) -> tuple[Item, ...]:
        """All that stands at the way-point: values, its time, velocities, accelerations."""
        if self.time is None and self.velocity is None:  # nearly always
            return self.values
        rates = [rate.values for rate in (self.velocity, self.acceleration) if rate is not None]
        return (*self.values, *(self.time.items if self.time else ()), *(one for row in rates for one in row))

    @property
    def place(self) -> Place:
        """From the first value to the last of the same row."""
        first, last = self.values[0].place, self.values[-1].place
        if last.row != first.row:
            last = [value.place for value in self.values if value.place.row == first.row][-1]
        return Place(first.row, first.start, last.end)


@frozen
class Time:
    """What stands in square brackets; the `<=` of `[V<=500]` is an item."""

    items: tuple[Number | Word | Percent | Other | Computed | ComputedPercent, ...]
    place: Place


@frozen
class Units:
    """What stands in round brackets."""

    items: tuple[Word | Number | Other, ...]
    place: Place


@frozen
class Option:
    """An option behind the base frame, and its argument; `at_most` says that less will do (`BLEND <=10`), `state` what an input is (`UNTIL TOUCH OFF`)."""

    word: Word
    argument: Number | Word | Percent | Other | Computed | ComputedPercent | None
    at_most: bool = False
    state: Word | None = None


@frozen
class Comment:
    """A comment with its exclamation mark, in line `row` of its statement."""

    text: str
    place: Place


@frozen
class Statement:
    """A command (with an index) or a declaration: its parts in the order of the language.

    `line` is the number of its first line in the file, `rows` how many lines it has. Names and values that
    are no way-points stand in `waypoints` all the same, as one: SUB's name and parameters, CALL's name and
    arguments, the name of a LET. `expression` is what LET says of it, and the condition of an IF.
    """

    line: int
    rows: int
    index: Word | None
    name: Word
    moving: FrameName | None
    waypoints: tuple[WayPoint, ...]
    expression: Expression | None
    time: Time | None
    units: Units | None
    base: FrameName | None
    options: tuple[Option, ...]
    comments: tuple[Comment, ...]

    def at_line(self, line: int) -> Statement:
        """The same statement in another line."""
        return Statement(
            line,
            self.rows,
            self.index,
            self.name,
            self.moving,
            self.waypoints,
            self.expression,
            self.time,
            self.units,
            self.base,
            self.options,
            self.comments,
        )

    def span(self, place: Place) -> Span:
        """The place in the file."""
        line = self.line + place.row
        return Span(line, place.start, line, place.end)

    @property
    def waits_else(self) -> bool:
        """True of a WAIT with an ELSE, and of a motion that has one behind its UNTIL: the lines up to its END are carried out if what is waited or searched for doesn't come."""
        names = [one.word.name for one in self.options]
        return names[-1:] == ["ELSE"] and (self.name.name == "WAIT" or "UNTIL" in names)

    @property
    def head_span(self) -> Span:
        """The index (if there is one) and the name."""
        first = self.index.place if self.index else self.name.place
        return Span(self.line, first.start, self.line, self.name.place.end)

    @property
    def whole_span(self) -> Span:
        """From the first part to the end of the last."""
        start = self.index.place.start if self.index else self.name.place.start
        last = self._last_place
        return Span(self.line, start, self.line + last.row, last.end)

    @property
    def _last_place(self) -> Place:
        """The place of the last part: they stand in one order."""
        if self.options:
            option = self.options[-1]
            return (option.state or option.argument or option.word).place
        last = self.waypoints[-1] if self.waypoints else None
        rates = (None, None) if last is None else (last.acceleration, last.velocity)
        for part in (self.base, self.units, *rates, self.time, self.expression):
            if part is not None:
                return part.values[-1].place if isinstance(part, Rate) else part.place
        if self.waypoints and self.waypoints[-1].values:
            return self.waypoints[-1].values[-1].place
        return (self.moving or self.name).place


@frozen
class Block:
    """The statements from a SUB, REPEAT, IF or WHEN to its END.

    `otherwise` is what stands behind ELSE, None where there is no ELSE; of a WAIT with an ELSE all of it. `otherwise_head` and `end` are the
    statements ELSE and END themselves; they are None where there is none, or none that can be read.
    """

    head: Statement
    body: tuple[Node, ...]
    otherwise: tuple[Node, ...] | None
    otherwise_head: Statement | None
    end: Statement | None


Node = Statement | Block


@frozen
class Module:
    """A file's statements in order, the first lines of those that couldn't be read, and its
    comment lines by line number.
    """

    source: SourceFile
    statements: tuple[Statement, ...]
    unreadable_lines: tuple[int, ...]
    comment_lines: tuple[tuple[int, str], ...]
