"""Syntax tree to text: names in upper case, one blank between parts, blocks indented by two, digits and comments
as they were.
"""

from __future__ import annotations

from itertools import groupby

from yarclang.syntax.ast import (
    Computed,
    ComputedPercent,
    FrameName,
    Module,
    Number,
    Option,
    Other,
    Parameter,
    Percent,
    Quantity,
    Statement,
    Text,
    WayPoint,
    Word,
)
from yarclang.syntax.blocks import DEEPEST_BLOCK
from yarclang.syntax.expressions import Binary, Bracket, Expression, Function, Name, Unary
from yarclang.syntax.words import BLOCK_HEADS

_INDENT = "  "
_TIGHT = {"*", "/", "%", "**"}
"""Operators that have no blanks round them."""


def print_module(module: Module) -> str:
    """The whole module as text; parsing it again gives the same statements, moved at most.

    Empty lines are dropped; comment lines stay before the statement that they stood before.
    """
    pieces: list[tuple[int, Statement | str]] = [(one.line, one) for one in module.statements]
    pieces += module.comment_lines
    lines: list[str] = []
    depth = 0
    for _, piece in sorted(pieces, key=lambda entry: entry[0]):
        if isinstance(piece, str):
            lines.append(_INDENT * min(depth, DEEPEST_BLOCK) + piece)
            continue
        word = piece.name.name
        if word == "END":
            depth = max(depth - 1, 0)
        indent = _INDENT * min(max(depth - (word == "ELSE"), 0), DEEPEST_BLOCK)
        lines += [indent + row for row in print_statement(piece).split("\n")]
        depth += word in BLOCK_HEADS
    return "".join(line + "\n" for line in lines)


def print_statement(statement: Statement) -> str:
    """One statement, not indented; a way-point list keeps its line breaks."""
    parts: list[str] = []
    if statement.index:
        parts.append(statement.index.name)
    parts.append(statement.name.name)
    if statement.moving:
        parts.append(_item(statement.moving))
    if statement.waypoints:
        parts.append(_waypoints(statement.waypoints))
    if statement.expression:
        parts += ["="] * bool(statement.waypoints)  # LET's name stands before it
        parts.append(print_expression(statement.expression))
    if statement.time:
        parts.append(f"[{' '.join(_item(item) for item in statement.time.items)}]")
    if statement.units:
        parts.append(f"({','.join(item.text.lower() for item in statement.units.items)})")
    if statement.base:
        parts.append(_item(statement.base))
    for option in statement.options:
        parts += _option(option)
    rows = " ".join(parts).split("\n")
    for comment in statement.comments:
        row = min(comment.place.row, len(rows) - 1)
        rows[row] = f"{rows[row]} {comment.text}"
    return "\n".join(rows)


def print_expression(expression: Expression) -> str:
    """An expression with the brackets that it was written with: no blanks round * / % **, one round the others."""
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
        case Name():
            return expression.name
        case _:
            return _item(expression)


def _waypoints(waypoints: tuple[WayPoint, ...]) -> str:
    lines = groupby(waypoints, key=lambda waypoint: waypoint.place.row)
    return ";\n".join(
        "; ".join(" ".join(_item(value) for value in waypoint.values) for waypoint in line)
        for _, line in lines
    )


def _option(option: Option) -> list[str]:
    return [option.word.name, *([_item(option.argument)] if option.argument is not None else [])]


_Item = Number | Word | Percent | Text | Other | Computed | ComputedPercent | FrameName | Quantity | Parameter


def _item(item: _Item) -> str:
    """A leaf, or what is computed."""
    match item:
        case Word():
            return item.name
        case FrameName():
            return f"{{{item.name}}}"
        case Quantity(number, unit):
            return f"{number.text} ({unit.text.lower()})"
        case Parameter(word, unit):
            return f"{word.name} ({unit.text.lower()})" if unit else word.name
        case Computed() | ComputedPercent():
            inner = print_expression(item.expression)
            inner = f"({inner})" if item.text.startswith("$(") else inner
            return f"${inner}{'%' * isinstance(item, ComputedPercent)}"
        case _:
            return item.text
