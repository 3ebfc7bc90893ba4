"""The syntax tree: the statements of a program as written. No name in it is resolved.

Places in the tree are relative to their statement. A statement that only moves to another line therefore
keeps its content; `Statement.span` returns places in the file.
"""

from __future__ import annotations

from yarclang.frozen import frozen
from yarclang.source import SourceFile, Span
from yarclang.syntax.expressions import Expression
from yarclang.syntax.leaves import FrameName, Number, Other, Percent, Place, Quantity, Text, Word

__all__ = [
    "Block",
    "Comment",
    "Computed",
    "ComputedPercent",
    "FrameName",
    "Module",
    "NamedValue",
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
    """An expression instead of a number, as written: `$NAME` or `$(expression)`."""

    text: str
    expression: Expression
    place: Place


@frozen
class ComputedPercent:
    """An expression instead of the number of a percentage, as written: `$SHARE%`."""

    text: str
    expression: Expression
    place: Place


@frozen
class NamedValue:
    """An argument of CALL with the name of its parameter, `ROWS=4`."""

    word: Word
    value: Number | Word | Text | Other | Computed | FrameName | Quantity
    place: Place

    @property
    def text(self) -> str:
        """Return the name and the value in their standard form."""
        return f"{self.word.text}={self.value.text}"


@frozen
class Parameter:
    """A name in the head of a SUB, its unit, and its default: `DEPTH (mm)`, `DEPTH=20 (mm)`."""

    word: Word
    unit: Word | None
    place: Place
    default: Number | Word | Computed | None = None

    @property
    def text(self) -> str:
        """Return the name, its default and its unit in their standard form."""
        name = self.word.text if self.default is None else f"{self.word.text}={self.default.text}"
        return f"{name} ({self.unit.text})" if self.unit else name


Value = Number | Word | Text | Other | Computed | FrameName | Quantity | NamedValue | Parameter
"""A value: a piece of text between blanks.

Some kinds occur only in certain places: frames among CALL's arguments and in the head of a SUB, quantities
and named values among CALL's arguments, and parameters in the head of a SUB.
"""


Item = Value | Percent | ComputedPercent
"""A value of a waypoint, or an item in the square brackets after it, such as a percentage."""


@frozen
class Rate:
    """Velocities or accelerations of all joints at a waypoint: VEL or ACC, and their values."""

    word: Word
    values: tuple[Value, ...]

    @property
    def place(self) -> Place:
        """Return the place from VEL or ACC to the last value in the same row."""
        row = self.word.place.row
        last = [value.place for value in self.values if value.place.row == row]
        return Place(row, self.word.place.start, (last[-1] if last else self.word.place).end)


@frozen
class WayPoint:
    """A waypoint of a motion: its values, which end at a semicolon. A line of another kind has one waypoint
    with its words, arguments or parameters.

    `time` is the waypoint's own time in square brackets, `velocity` and `acceleration` are the VEL and ACC
    after it. The time of the last waypoint is the motion time of its statement, and is stored in the
    statement.
    """

    values: tuple[Value, ...]
    time: Time | None = None
    velocity: Rate | None = None
    acceleration: Rate | None = None

    @property
    def items(self) -> tuple[Item, ...]:
        """Return all items of the waypoint: values, its time, velocities, accelerations."""
        if self.time is None and self.velocity is None:  # nearly always
            return self.values
        rates = [rate.values for rate in (self.velocity, self.acceleration) if rate is not None]
        return (*self.values, *(self.time.items if self.time else ()), *(one for row in rates for one in row))

    @property
    def place(self) -> Place:
        """Return the place of the values. If they continue in another row, the place ends with their first
        row.
        """
        first, last = self.values[0].place, self.values[-1].place
        if last.row != first.row:
            last = [value.place for value in self.values if value.place.row == first.row][-1]
        return Place(first.row, first.start, last.end)


@frozen
class Time:
    """The content of square brackets, such as `[5]` or `[V<=500]`. The `<=` is an item of its own."""

    items: tuple[Number | Word | Percent | Other | Computed | ComputedPercent, ...]
    place: Place


@frozen
class Units:
    """The content of round brackets."""

    items: tuple[Word | Number | Other, ...]
    place: Place


@frozen
class Option:
    """An option after the base frame of a command, and its argument.

    `at_most` is True if the argument is an upper bound (`BLEND <=10`); `state` is a second word: the state of
    an input (`UNTIL TOUCH OFF`), or the second body (`ALLOW GRIPPER BOX`).
    """

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
    """A command (with an index) or a declaration. The fields are in the order in which the elements of a line
    are written.

    `line` is the number of its first line in the file, `rows` the number of its lines. Some statements have
    no waypoints; `waypoints` then holds their names and values as if they were one waypoint: SUB's name and
    parameters, CALL's name and arguments, the name of a LET. `expression` is a value or a condition,
    such as that of a LET or an IF.
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
        """Return the same statement at another line."""
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
        """Return the span in the file of a place in the statement."""
        line = self.line + place.row
        return Span(line, place.start, line, place.end)

    @property
    def waits_else(self) -> bool:
        """Return True for a WAIT with an ELSE, and for a motion with an ELSE after its UNTIL.

        The lines from the ELSE up to the END are carried out if the event that the command waits for doesn't
        occur.
        """
        names = [one.word.name for one in self.options]
        return names[-1:] == ["ELSE"] and (self.name.name == "WAIT" or "UNTIL" in names)

    @property
    def head_span(self) -> Span:
        """Return the span of the index (if there is one) and the name."""
        first = self.index.place if self.index else self.name.place
        return Span(self.line, first.start, self.line, self.name.place.end)

    @property
    def whole_span(self) -> Span:
        """Return the span of the whole statement, in the file."""
        start = self.index.place.start if self.index else self.name.place.start
        last = self._last_place
        return Span(self.line, start, self.line + last.row, last.end)

    @property
    def _last_place(self) -> Place:
        """Return the place of the statement's last element. The order of elements is fixed."""
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
    """The statements from the first line of a block, such as SUB, REPEAT or WHEN, to its END.

    `otherwise` has the statements after ELSE, and is None without an ELSE; for a WAIT with an ELSE, it has
    all statements of the block. `otherwise_head` and `end` are the statements ELSE and END themselves; they
    are None if they are missing or unreadable.
    """

    head: Statement
    body: tuple[Node, ...]
    otherwise: tuple[Node, ...] | None
    otherwise_head: Statement | None
    end: Statement | None


Node = Statement | Block


@frozen
class Module:
    """A parsed file: its statements in order, the first lines of the statements that couldn't be read, and
    the comment lines by line number.
    """

    source: SourceFile
    statements: tuple[Statement, ...]
    unreadable_lines: tuple[int, ...]
    comment_lines: tuple[tuple[int, str], ...]
