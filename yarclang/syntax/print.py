"""Print a syntax tree as a program in standard form.

Names are in upper case, elements of a line are separated by one blank, and blocks are indented by two. The
digits of numbers aren't changed. Comments of neighbouring lines are aligned.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

from yarclang.syntax.ast import (
    Computed,
    ComputedPercent,
    FrameName,
    Module,
    NamedValue,
    Number,
    Option,
    Other,
    Parameter,
    Percent,
    Quantity,
    Statement,
    Text,
    Time,
    WayPoint,
    Word,
)
from yarclang.syntax.blocks import DEEPEST_BLOCK
from yarclang.syntax.expressions import Applied, Binary, Bracket, Element, Expression, Function, Name, Unary
from yarclang.syntax.words import BLOCK_ENDS, opens_block

_INDENT = "  "
_TIGHT = {"*", "/", "%", "**"}
"""Operators without blanks around them."""


_FARTHEST = 40
"""Comments of adjacent lines are aligned at a common column. Lines with more code than this number of
characters don't count for the column; their comment directly follows the code.
"""


@dataclass(slots=True)
class _Row:
    """A line of the printed program: its code with its indentation, and its comment. A comment on its own
    line is indented like code.
    """

    code: str
    comment: str = ""


def print_module(module: Module) -> str:
    """Print a file's syntax tree as text. Parsing this text gives the same statements, possibly at other
    places.

    Several empty lines become one. Comment lines stay before the statement that they preceded.
    """
    paragraph: list[_Row] = []
    lines: list[str] = []
    for row in _rows(module):
        if row is not None:
            paragraph.append(row)
            continue
        lines += [*_aligned(paragraph), ""]
        paragraph = []
    return "".join(line + "\n" for line in [*lines, *_aligned(paragraph)])


def _rows(module: Module) -> Iterator[_Row | None]:
    """Yield the lines of a printed file; None separates two paragraphs."""
    pieces: list[tuple[int, Statement | str]] = [(one.line, one) for one in module.statements]
    pieces += module.comment_lines
    depth, behind = 0, 0
    for line, piece in sorted(pieces, key=lambda entry: entry[0]):
        if behind and any(not module.source.line(number).strip() for number in range(behind, line)):
            yield None
        if isinstance(piece, str):
            yield _Row(_INDENT * min(depth, DEEPEST_BLOCK) + piece)
            behind = line + 1
            continue
        behind = line + piece.rows
        word = piece.name.name
        if word in BLOCK_ENDS:
            depth = max(depth - 1, 0)
        indent = _INDENT * min(max(depth - (word in ("ELSE", "OF")), 0), DEEPEST_BLOCK)
        for row in _rows_of(piece):
            yield _Row(indent + (row.code or row.comment), row.comment if row.code else "")
        depth += opens_block(piece)


def _aligned(paragraph: list[_Row]) -> list[str]:
    """Return the lines of a paragraph, with their comments in one column."""
    widths = [len(row.code) for row in paragraph if row.comment and len(row.code) <= _FARTHEST]
    column = max(widths, default=0)
    return [f"{row.code:<{column}}  {row.comment}" if row.comment else row.code for row in paragraph]


def _rows_of(statement: Statement) -> list[_Row]:
    """Return the lines of a statement; a comment on its own line has no code."""
    parts: list[str] = []
    if statement.index:
        parts.append(statement.index.name)
    parts.append(statement.name.name)
    if statement.moving:
        parts.append(_item(statement.moving))
    if statement.waypoints:
        is_function = statement.name.name == "FUNC" and statement.expression is not None
        parts.append((_head_of_function if is_function else _waypoints)(statement.waypoints))
    if statement.expression:
        parts += ["="] * bool(statement.waypoints)  # the name of LET or SET comes before it
        parts.append(print_expression(statement.expression))
    if statement.time:
        parts.append(_time(statement.time))
    if statement.waypoints:
        parts += _rates(statement.waypoints[-1])
    if statement.units:
        parts.append(f"({','.join(item.text.lower() for item in statement.units.items)})")
    if statement.base:
        parts.append(_item(statement.base))
    for option in statement.options:
        parts += _option(option)
    written = dict(zip(_code_rows(statement), " ".join(parts).split("\n"), strict=True))
    said = {comment.place.row: comment.text for comment in statement.comments}
    return [_Row(written.get(row, ""), said.get(row, "")) for row in sorted({*written, *said})]


def _code_rows(statement: Statement) -> list[int]:
    """Return the row numbers of a statement that have code: the first row, and the rows in which
    waypoints begin.
    """
    first = statement.waypoints[0].place.row if statement.waypoints else 0
    return [0, *sorted({waypoint.place.row for waypoint in statement.waypoints} - {first})]


def print_expression(expression: Expression) -> str:
    """Print an expression with its brackets as written: without blanks around * / % **, with one around
    other operators.
    """
    match expression:
        case Binary(operator, left, right):
            blank = "" if operator in _TIGHT else " "
            return f"{print_expression(left)}{blank}{operator}{blank}{print_expression(right)}"
        case Unary(operator, operand):
            return f"{operator}{' ' * (operator == 'NOT')}{print_expression(operand)}"
        case Bracket(inner):
            return f"({print_expression(inner)})"
        case Function():
            return f"{expression.name}({', '.join(map(print_expression, expression.arguments))})"
        case Element(table=table, indices=indices):
            return f"{table.name}[{', '.join(map(print_expression, indices))}]"
        case Applied(function=function, arguments=arguments):
            return f"{function.name}({', '.join(map(print_expression, arguments))})"
        case Name():
            return expression.name
        case _:
            return _item(expression)


def _waypoints(waypoints: tuple[WayPoint, ...]) -> str:
    lines = groupby(waypoints, key=lambda waypoint: waypoint.place.row)
    return ";\n".join(
        "; ".join(_waypoint(waypoint, waypoint is waypoints[-1]) for waypoint in line) for _, line in lines
    )


def _head_of_function(waypoints: tuple[WayPoint, ...]) -> str:
    """Print the part between FUNC and its equals sign: a name, and parameters in brackets."""
    ((name, *parameters),) = (waypoint.values for waypoint in waypoints)
    return f"{_item(name)}({', '.join(map(_item, parameters))})"


def _waypoint(waypoint: WayPoint, is_last: bool) -> str:
    """Print a waypoint with its time. The velocity of the last waypoint comes after the motion time."""
    parts = [_item(value) for value in waypoint.values]
    if waypoint.time:
        parts.append(_time(waypoint.time))
    if not is_last:
        parts += _rates(waypoint)
    return " ".join(parts)


def _time(time: Time) -> str:
    said = " ".join(_item(item) for item in time.items)
    return f"[{said.replace(' <= ', '<=')}]"


def _rates(waypoint: WayPoint) -> list[str]:
    return [
        _item(one)
        for rate in (waypoint.velocity, waypoint.acceleration)
        if rate is not None
        for one in (rate.word, *rate.values)
    ]


def _option(option: Option) -> list[str]:
    sign = "<=" * option.at_most
    said = [option.word.name, *([sign + _item(option.argument)] if option.argument is not None else [])]
    return said if option.state is None else [*said, _item(option.state)]


_Item = (
    Number
    | Word
    | Percent
    | Text
    | Other
    | Computed
    | ComputedPercent
    | FrameName
    | Quantity
    | NamedValue
    | Parameter
)


def _item(item: _Item) -> str:
    """Print a value: a single token, or a computed value."""
    match item:
        case Word():
            return item.name
        case FrameName():
            return f"{{{item.name}}}"
        case Quantity(number, unit):
            return f"{number.text} ({unit.text.lower()})"
        case Parameter(word, unit, default=default):
            name = word.name if default is None else f"{word.name}={_item(default)}"
            return f"{name} ({unit.text.lower()})" if unit else name
        case NamedValue(word, value):
            return f"{word.name}={_item(value)}"
        case Computed() | ComputedPercent():
            inner = print_expression(item.expression)
            inner = f"({inner})" if item.text.startswith("$(") else inner
            return f"${inner}{'%' * isinstance(item, ComputedPercent)}"
        case _:
            return item.text
