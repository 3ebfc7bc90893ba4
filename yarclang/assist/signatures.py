"""Describe the values of a line: their names and units, and which one is being typed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from yarclang.assist.cursor import Cursor, cursor_at
from yarclang.assist.declared import described_sub
from yarclang.assist.lexemes import Lexeme
from yarclang.assist.sketch import Sketch
from yarclang.assist.view import View
from yarclang.assist.vocabulary import DECLARED, command_of
from yarclang.commands.spec import Values
from yarclang.report.module_text import SubText
from yarclang.robot.joint_names import joint_labels
from yarclang.syntax.words import OPTIONS
from yarclang.units import UNITS, Kind
from yarclang.words.registry import word_specs

_MEANINGS = {
    "x": "along the x axis of the base frame",
    "y": "along the y axis of the base frame",
    "z": "along the z axis of the base frame",
    "roll": "about x: R = Rz(yaw) Ry(pitch) Rx(roll)",
    "pitch": "about y: R = Rz(yaw) Ry(pitch) Rx(roll)",
    "yaw": "about z: R = Rz(yaw) Ry(pitch) Rx(roll)",
    "qx": "of the unit quaternion x y z w",
    "qy": "of the unit quaternion x y z w",
    "qz": "of the unit quaternion x y z w",
    "qw": "of the unit quaternion x y z w",
}
_DECLARED = {
    "FRAME": Values.POSE_RPY,
    "FRAME_QUAT": Values.POSE_QUAT,
    "JOINTS": Values.JOINTS,
    "POSE": Values.POSE_RPY,
    "START": Values.JOINTS,
}
_WITHOUT_ROBOT = ("J1", "J2", "J3", "J4", "J5", "J6")
_DEFAULT_UNITS: Mapping[Kind, str] = {"length": "length", "angle": "angle", "time": "time"}


@dataclass(frozen=True, slots=True)
class ValueText:
    """A value that a line needs, as shown to the user.

    Attributes:
        label: name of the value with its unit.
        meaning: meaning of the value.
    """

    label: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Signature:
    """The values that a line needs, for display while the user types them.

    Attributes:
        head: first word of the line.
        values: the values in order.
        active: number of the value that is being typed, from 0; None after the last one.
        summary: meaning of the line.
    """

    head: str
    values: tuple[ValueText, ...]
    active: int | None
    summary: str


def signature_at(view: View, line: int, column: int) -> Signature | None:
    """Return the values that a line needs, at a place (line and column from 1); None if no values are
    expected there.
    """
    cursor = cursor_at(view.sketch, line, column)
    if cursor.is_head or cursor.is_comment or cursor.bracket in {"[", "("} or _is_behind(cursor):
        return None
    if cursor.head == "CALL":
        return _of_call(view, cursor)
    wanted = _wanted(cursor)
    if wanted is None:
        return None
    values, summary = wanted
    texts = value_texts(view, values, cursor)
    if not texts:
        return None
    given = list(cursor.values)
    if _has_frame(cursor):
        given = given[1:]
    if cursor.head in ("JOINTS", "POSE"):
        given = given[1:]
    active = len(given)
    return Signature(cursor.head, texts, active if active < len(texts) else None, summary)


def _has_frame(cursor: Cursor) -> bool:
    """Return True if a moving frame is before the values of the first waypoint."""
    return len(cursor.before) > 1 and cursor.before[1].kind == "frame" and not cursor.way_point


def _is_behind(cursor: Cursor) -> bool:
    """Return True if the values of a line end before the place, because a time, units, the base frame or an
    option has followed.
    """
    depth = 0
    # Each waypoint of a timetable has a time. After a semicolon, values begin again.
    begins = max((number for number, one in enumerate(cursor.before) if one.text == ";"), default=0)
    for number, one in enumerate(cursor.before[begins + 1 :], begins + 1):
        if one.text == "[" or (one.text == "(" and not depth):
            return cursor.head != "CALL"
        depth += (one.text in {"$(", "("}) - (one.text == ")")
        is_base = one.kind == "frame" and number > 1
        is_option = one.kind == "word" and one.name in OPTIONS
        if (is_base or is_option) and cursor.head != "CALL":
            return True
    return False


def _wanted(cursor: Cursor) -> tuple[Values, str] | None:
    """Return the values that a command's waypoint or a declaration needs."""
    if cursor.head in _DECLARED:
        return _DECLARED[cursor.head], DECLARED[cursor.head].summary
    found = command_of(cursor.head)
    if found is None:
        return None
    spec, target, _ = found
    values = spec.targets.get(target)
    if cursor.way_point < len(spec.leading):
        values = spec.leading[cursor.way_point]
    return None if values is None else (values, spec.summary)


def value_texts(view: View, values: Values, cursor: Cursor) -> tuple[ValueText, ...]:
    """Return the names of values, with the units that they have in a line."""
    robot = view.robot
    names = joint_labels(robot.joint_names) if robot else _WITHOUT_ROBOT
    kinds: tuple[Kind, ...] = tuple(
        "length" if unit == "mm" else "angle" for unit in (robot.axis_unit_names if robot else ("deg",) * 6)
    )
    units = units_in(view.sketch, cursor.line)
    texts: list[ValueText] = []
    for label, kind in zip(values.labels(names), values.kinds(kinds), strict=True):
        unit = f" ({units[kind]})" if kind else ""
        meaning = _MEANINGS.get(label, f"joint {label}")
        if values.is_delta:
            meaning = f"increment of {meaning}" if values.of_joints else f"increment {meaning}"
        texts.append(ValueText(f"{label}{unit}", meaning))
    return tuple(texts)


def units_in(sketch: Sketch, line: int) -> Mapping[Kind, str]:
    """Return the unit of lengths, angles and times in a line: the line's own, or that of DEFAULT, or else the
    name of the quantity.
    """
    found = dict(_DEFAULT_UNITS)
    for statement in (sketch.default, sketch.statement_at(line)):
        for item in statement.units.items if statement and statement.units else ():
            if (unit := UNITS.get(item.text.lower())) is not None:
                found[unit.kind] = unit.name
    return found


def _of_call(view: View, cursor: Cursor) -> Signature | None:
    """Return the parameters of the SUB that is called."""
    sub = called_sub(view, cursor)
    if sub is None:
        return None
    name = cursor.before[1].name
    values = tuple(ValueText(one.written, one.meaning) for one in sub.parameters)
    words = [one.word for one in sub.parameters]
    return Signature(
        f"CALL {name}",
        values,
        _next_argument(cursor.before[2:], words),
        sub.purpose or word_specs()["CALL"].summary,
    )


def called_sub(view: View, cursor: Cursor) -> SubText | None:
    """Return the SUB that the CALL at a cursor names; None without one."""
    arguments = [
        lexeme
        for lexeme in cursor.before[1:]
        if lexeme.kind in {"word", "frame", "number", "string"} or lexeme.text == "$("
    ]
    if not arguments or arguments[0].kind != "word":
        return None
    name = arguments[0].name
    module, dot, inner = name.partition(".")
    sketch = view.module(module) if dot else view.sketch
    return described_sub(sketch, inner if dot else name) if sketch else None


def given_arguments(pieces: tuple[Lexeme, ...]) -> tuple[list[str], bool]:
    """Return the names of the arguments that a CALL already has. An unnamed argument has an empty text.

    Args:
        pieces: the tokens of the CALL after the SUB's name. Tokens in brackets belong to one argument.

    Returns:
        The names, in order, and True if the last argument has no value yet.
    """
    depth, found, waits = 0, [], False
    for at, one in enumerate(pieces):
        if one.text == "=" and not depth:
            continue
        if one.text in {"(", "$("}:
            is_value, depth = one.text == "$(" and not depth, depth + 1
        elif one.text == ")":
            is_value, depth = False, max(depth - 1, 0)
        else:
            is_value = not depth and one.kind != "mark"
        if not is_value:
            continue
        if one.kind == "word" and at + 1 < len(pieces) and pieces[at + 1].text == "=":
            found.append(one.name)
            waits = True
        elif waits:
            waits = False
        else:
            found.append("")
    return found, waits


def _next_argument(pieces: tuple[Lexeme, ...], parameters: list[str]) -> int | None:
    """Return the number of the SUB's parameter that is being typed, from 0; None if all are given.

    Args:
        pieces: the tokens of the CALL after the SUB's name.
        parameters: names of the SUB's parameters, without braces.
    """
    given, waits = given_arguments(pieces)
    if waits:
        return parameters.index(given[-1]) if given[-1] in parameters else None
    rest = [at for at, name in enumerate(parameters) if at >= given.count("") and name not in given]
    return rest[0] if rest else None
