"""Build a statement from the parse tree of the Lark library. The nodes of its expressions have already been
built, by nodes.py.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

from yarclang.syntax.ast import (
    Comment,
    Computed,
    ComputedPercent,
    FrameName,
    NamedValue,
    Number,
    Option,
    Other,
    Parameter,
    Percent,
    Place,
    Quantity,
    Rate,
    Statement,
    Text,
    Time,
    Units,
    WayPoint,
    Word,
)
from yarclang.syntax.explain_expressions import unequal
from yarclang.syntax.expressions import DEEPEST_EXPRESSION, Expression, is_too_deep
from yarclang.syntax.faults import Fault, FaultError
from yarclang.syntax.leaves import from_to, place_of
from yarclang.syntax.lines import code_of
from yarclang.syntax.nodes import named

_NUMBER = re.compile(r"\S+")


Rows = Sequence[str]
"""The rows of a statement's text; empty if the statement has no expression."""


def statement(text: str, tree: Any) -> Statement:
    """Build a statement from its parse tree; `line` is 0 until the caller sets it.

    Raises:
        FaultError: there is an error that the grammar doesn't detect.
    """
    index: Word | None = None
    name: Word | None = None
    moving: FrameName | None = None
    base: FrameName | None = None
    time: Time | None = None
    units: Units | None = None
    waypoints: tuple[WayPoint, ...] = ()
    expression: Expression | None = None
    options: list[Option] = []
    rows: Rows = text.split("\n") if "$(" in text else ()
    for part in tree.children:
        kind = getattr(part, "data", None)
        if kind is None:
            index = Word(str(part), place_of(part))
            continue
        children = part.children
        if kind == "head":
            name = Word(str(children[0]), place_of(children[0]))
            if len(children) > 1:
                moving = FrameName(str(children[1]), place_of(children[1]))
        elif kind == "values":
            waypoints, time = _waypoints(rows, children)
        elif kind == "time":
            time = Time(tuple(_items(rows, children[1:-1])), _bracket(children))
        elif kind == "units":
            units = Units(tuple(_items(rows, children[1:-1])), _bracket(children))
        elif kind == "base":
            base = FrameName(str(children[0]), place_of(children[0]))
        elif kind == "option":
            at_most = len(children) > 1 and getattr(children[1], "type", None) == "AT_MOST"
            options.append(_option(_items(rows, children), at_most=at_most))
        else:  # the rules call, sub, let, func, condition, waits, lone
            if kind in {"let", "func", "condition", "waits"}:
                expression = _sound(children[-1])
                children = children[: {"let": 2, "func": -1}.get(kind, 1)]
            name, *values = _items(rows, children)
            if values:
                waypoints = (WayPoint(tuple(values)),)
    assert name is not None  # the grammar has no statement without a name
    comments = comments_of(text)
    if expression is not None and comments:
        _check_comment(comments[0])
    return Statement(
        0,
        text.count("\n") + 1,
        index,
        name,
        moving,
        waypoints,
        expression,
        time,
        units,
        base,
        tuple(options),
        comments,
    )


def _waypoints(rows: Rows, children: Any) -> tuple[tuple[WayPoint, ...], Time | None]:
    """Build the waypoints of a statement, each with its time, velocity and acceleration. Also return the
    time of the last waypoint, which is the motion time.
    """
    waypoints: list[WayPoint] = []
    parts: dict[str, Any] = {}
    for child in children:
        kind = child.data
        if kind == "waypoint":
            if parts:
                waypoints.append(WayPoint(**parts))
            parts = {"values": tuple(_items(rows, child.children))}
        elif kind == "time":
            parts["time"] = Time(tuple(_items(rows, child.children[1:-1])), _bracket(child.children))
        else:  # velocity, acceleration
            word, *values = _items(rows, child.children)
            parts[kind] = Rate(word, tuple(values))
    time = parts.pop("time", None)
    return (*waypoints, WayPoint(**parts)), time


def _items(rows: Rows, children: Any) -> list[Any]:
    """Build the syntax nodes of tokens and subtrees. A token with several numbers gives one node for each
    number.
    """
    found: list[Any] = []
    computed = False
    for child in children:
        kind = getattr(child, "type", None)
        if kind == "NUMBERS":
            found += _numbers(child)
        elif kind == "PERCENT":
            found.append(Percent(str(child), float(str(child).rstrip("% \t")), place_of(child)))
        elif kind == "CEILING":
            found += _ceiling(child)
        elif kind in _LEAVES:
            found.append(_LEAVES[kind](str(child), place_of(child)))
        elif kind is None:
            found += _SMALL_TREES[child.data](rows, child.children)
            computed = computed or child.data in ("computed", "named")
    if computed:
        _check_blanks(found)
    return found


def _ceiling(token: Any) -> list[Word | Other]:
    """Build the V and the `<=` of `[V<=250]`."""
    place = place_of(token)
    word = Word(str(token)[0], Place(place.row, place.start, place.start + 1))
    return [word, Other("<=", Place(place.row, place.end - 2, place.end))]


_LEAVES: dict[str | None, Any] = {
    **dict.fromkeys(
        [
            "WORD",
            "OPTION",
            "VEL",
            "ACC",
            "CALL",
            "SUB",
            "LET",
            "FUNC",
            "SETS",
            "IF",
            "WHENS",
            "WAITS",
            "LONE",
            "NAME",
        ],
        Word,
    ),
    "STRING": Text,
    "FRAME": FrameName,
    "OTHER": Other,
    "AT_MOST": Other,
}


def _numbers(token: Any) -> list[Number]:
    """Split a token with several numbers at the blanks."""
    row, column = token.line - 1, token.column
    return [
        Number(match.group(), float(match.group()), Place(row, column + match.start(), column + match.end()))
        for match in _NUMBER.finditer(token)
    ]


def _computed(rows: Rows, children: list[Any]) -> list[Computed]:
    first, last = place_of(children[0]), place_of(children[-1])
    place = from_to(first, last)
    if len(children) == 1:  # $NAME
        variable = str(children[0])
        expression: Expression = named(variable[1:], Place(first.row, first.start + 1, first.end))
        return [Computed(variable, expression, place)]
    row = rows[place.row]
    return [Computed(row[place.start - 1 : place.end - 1], _sound(children[1]), place)]


def _computed_percent(rows: Rows, children: list[Any]) -> list[ComputedPercent]:
    tree, sign = children
    (computed,) = _computed(rows, tree.children)
    place = from_to(computed.place, place_of(sign))
    return [ComputedPercent(computed.text + "%", computed.expression, place)]


def _measured(rows: Rows, children: list[Any]) -> list[Number | Quantity]:  # noqa: ARG001  (as all builders)
    """Build the numbers before a unit. The unit belongs to the last number only."""
    *others, number = _numbers(children[0])
    unit = Word(str(children[2]), place_of(children[2]))
    return [*others, Quantity(number, unit, from_to(number.place, place_of(children[3])))]


def _parameter(rows: Rows, children: list[Any]) -> list[Parameter]:  # noqa: ARG001  (as all builders)
    word = Word(str(children[0]), place_of(children[0]))
    if len(children) == 1:
        return [Parameter(word, None, word.place)]
    unit = Word(str(children[2]), place_of(children[2]))
    return [Parameter(word, unit, from_to(word.place, place_of(children[3])))]


def _default(rows: Rows, children: list[Any]) -> list[Any]:
    """Build a parameter with its default."""
    word = _name_of(children[0])
    first, *others = _items(rows, children[1:2])
    if others:
        message = f"{word.text} can have only one default; `{others[0].text}` is a second one"
        help_ = f"write {word.name}={first.text}, and blanks between parameters"
        raise FaultError(Fault("Y0101", message, help_, others[0].place))
    if len(children) == 2:
        return [Parameter(word, None, from_to(word.place, first.place), first)]
    unit, end = Word(str(children[3]), place_of(children[3])), place_of(children[4])
    return [Parameter(word, unit, from_to(word.place, end), first)]


def _named(rows: Rows, children: list[Any]) -> list[Any]:
    """Build an argument of a CALL with its name. If several numbers follow the name, only the first one
    belongs to it.
    """
    word = _name_of(children[0])
    first, *others = _items(rows, children[1:])
    return [NamedValue(word, first, from_to(word.place, first.place)), *others]


def _name_of(token: Any) -> Word:
    """Return the name before an equals sign."""
    name = str(token)[:-1].rstrip()
    place = place_of(token)
    return Word(name, Place(place.row, place.start, place.start + len(name)))


_SMALL_TREES: dict[str, Callable[[Rows, list[Any]], list[Any]]] = {
    "computed": _computed,
    "computed_percent": _computed_percent,
    "measured": _measured,
    "parameter": _parameter,
    "default": _default,
    "named": _named,
}


def _check_blanks(values: list[Any]) -> None:
    """Check that a blank follows the bracket of a computed value."""
    for one, following in pairwise(values):
        near = one.place.row == following.place.row and one.place.end == following.place.start
        if near and isinstance(one.value if isinstance(one, NamedValue) else one, Computed):
            message = f"`{following.text}` runs into `{one.text}`"
            raise FaultError(
                Fault(
                    "Y0101",
                    message,
                    "write blanks between values, and a whole expression in brackets",
                    following.place,
                )
            )


def _sound(expression: Expression) -> Expression:
    """Return the expression if it isn't nested too deep; otherwise raise a fault."""
    if is_too_deep(expression):
        message = f"more than {DEEPEST_EXPRESSION} operators, functions and brackets are nested"
        raise FaultError(Fault("Y0112", message, "compute parts of it by LET", expression.place))
    return expression


def _bracket(children: list[Any]) -> Place:
    """Return the place of a pair of brackets and their content. If the closing bracket is in another row,
    return the place of the opening bracket.
    """
    first, last = children[0], children[-1]
    same = first.line == last.line
    return Place(first.line - 1, first.column, last.column + 1 if same else first.column + 1)


def _check_comment(comment: Comment) -> None:
    """Check that the comment after an expression wasn't meant as a part of the expression."""
    if fault := unequal(comment.text, comment.place.row, comment.place.start):
        raise FaultError(fault)


def _option(items: list[Any], *, at_most: bool) -> Option:
    """Build an option from its word, `<=` if it is an upper bound, and its argument."""
    word, *values = items
    if at_most:
        sign, *values = values
        if not values:
            message = f"{word.name} <= needs a value"
            raise FaultError(Fault("Y0101", message, f"for example {word.name} <=10", sign.place))
    if word.name in ("UNTIL", "ALLOW") and len(values) == 2 and isinstance(values[0], Word):
        return Option(word, values[0], at_most, values[1])
    if len(values) > 1:
        message = f"{word.name} takes one value; `{values[1].text}` is a second one"
        raise FaultError(Fault("Y0101", message, "remove it", values[1].place))
    return Option(word, values[0] if values else None, at_most)


def comments_of(text: str) -> tuple[Comment, ...]:
    """Return the comments of a statement."""
    return tuple(_comments(text)) if "!" in text else ()


def _comments(text: str) -> Iterator[Comment]:
    for number, row in enumerate(text.split("\n")):
        code = code_of(row)
        if len(code) < len(row):
            place = Place(number, len(code) + 1, len(row.rstrip()) + 1)
            yield Comment(row[len(code) :].rstrip(), place)
