"""The fields of a command, which users change one by one, and their places in the program's text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Literal

from yarclang.assist.sketch import Sketch
from yarclang.assist.vocabulary import command_of
from yarclang.commands.registry import actions
from yarclang.commands.spec import CommandSpec, Values
from yarclang.frozen import frozen
from yarclang.semantics.declared.watching import REACTIONS
from yarclang.syntax.ast import Computed, FrameName, Option, Statement, Text, Value, Word
from yarclang.syntax.leaves import Place
from yarclang.teaching.points import meanings, own_values
from yarclang.units import UNITS, Kind
from yarclang.words.registry import word_specs
from yarclang.words.spec import Slot

FieldKind = Literal["number", "percent", "choice", "frame", "joints", "pose", "signal", "text"]

_JOINTS = tuple(f"J{number}" for number in range(1, 33))
_DECLARED_POSES = ("FRAME", "FRAME_QUAT", "POSE")
_COUNTED = 64
"""Largest number of waypoints of a motion whose values are shown as fields. Further waypoints have no
fields.
"""


@frozen
class Field:
    """A field of a command, which a user can fill in.

    Attributes:
        name: identifier of the field within its command.
        label: name that is displayed.
        kind: kind of the value.
        value: text of the value; empty if the command doesn't contain the value.
        unit: unit of the value; empty for none.
        choices: possible values; empty if they aren't known here.
    """

    name: str
    label: str
    kind: FieldKind
    value: str = ""
    unit: str = ""
    choices: tuple[str, ...] = ()


Part = Literal["name", "moving", "value", "time", "units", "base", "option", "comment"]


@frozen
class Placed:
    """A field of a statement, and the text of the statement that a new value replaces.

    Attributes:
        field: the field.
        part: part of the statement to which the text belongs, such as its time or its options.
        place: place of the text; None if the statement doesn't contain the field.
        form: text to insert, with `@` for the new value.
    """

    field: Field
    part: Part
    place: Place | None
    form: str = "@"


class Reader:
    """Reads the fields of a program's statements.

    Args:
        sketch: parsed structure of the program's text.
        joints: names of the robot's joints; None for J1 and so on.
    """

    def __init__(self, sketch: Sketch, joints: tuple[str, ...] | None = None) -> None:
        self._sketch = sketch
        self._joints = joints
        default = sketch.default
        self._defaults: dict[Kind, str] = _units(default) if default is not None else {}
        self._units = self._defaults
        self._tails: dict[tuple[str, bool], tuple[Placed, ...]] = {}
        self._known: dict[tuple[object, ...], tuple[tuple[str, str], ...]] = {}

    def placed(self, statement: Statement) -> tuple[Placed, ...]:
        """Return the fields of a statement in the order of their places."""
        self._units = {**self._defaults, **_units(statement)} if statement.units else self._defaults
        return tuple(self._fields(statement))

    def _fields(self, statement: Statement) -> Iterator[Placed]:
        word = statement.name.name
        found = command_of(word)
        is_pose = statement.index is None and word in _DECLARED_POSES
        if found is not None:
            yield from self._of_command(statement, found[0])
        elif is_pose or (statement.index is None and word in ("JOINTS", "START")):
            yield from self._points(statement, meanings(statement))
            yield _units_field(statement)
            if is_pose:
                yield _frame("base", "Base frame", statement.base, "base")
        elif word == "TABLE" and statement.index is None:
            first = statement.waypoints[0].values if statement.waypoints else ()
            # If the values aren't numbers, the word POSE or JOINTS after the name determines their meaning.
            kind = first[1].name if len(first) > 1 and isinstance(first[1], Word) else ""
            for row, point in enumerate(statement.waypoints):
                for column, value in enumerate(point.values[1 + bool(kind) :] if row == 0 else point.values):
                    name = f"{row}.{column}" if len(statement.waypoints) > 1 else str(column)
                    yield _value(name, f"Number {name}", "number", value)
            yield _units_field(statement)
            if kind == "POSE":
                yield _frame("base", "Base frame", statement.base, "base")
        elif word == "DEFAULT":
            yield _frame("moving", "Moving frame", statement.moving, "moving")
            yield from _times(statement, has_speed=True, unit=self._unit("time"), speed="")
            yield _units_field(statement)
            yield _frame("base", "Base frame", statement.base, "base")
        else:
            yield from self._of_other(statement, word)
        yield _comment(statement)

    def _of_command(self, statement: Statement, spec: CommandSpec) -> Iterator[Placed]:
        meant = meanings(statement)
        of_joints = all(one.of_joints for one in meant)
        if meant and (statement.moving is not None or not of_joints):
            yield _frame("moving", "Moving frame", statement.moving, "moving")
        yield from self._points(statement, meant)
        if not spec.is_motion:
            return
        if statement.time or statement.units or statement.base or statement.options:
            yield from self._tail(statement, spec, meant)
            return
        # Shortcut: in a long program, most lines leave all of these parts to DEFAULT.
        key = (spec.name, of_joints)
        if key not in self._tails:
            self._tails[key] = tuple(self._tail(statement, spec, meant))
        yield from self._tails[key]

    def _tail(self, statement: Statement, spec: CommandSpec, meant: tuple[Values, ...]) -> Iterator[Placed]:
        length, time = self._unit("length"), self._unit("time")
        if spec.is_timed:
            yield _last_time(statement, time)
        else:
            yield from _times(statement, has_speed=spec.moves_frame, unit=time, speed=f"{length}/{time}")
        yield _units_field(statement)
        if meant and (statement.base is not None or not all(one.of_joints for one in meant)):
            yield _frame("base", "Base frame", statement.base, "base")
        yield from _options_of_table(statement) if spec.is_timed else _options(statement, spec, meant, length)

    def _points(self, statement: Statement, meant: tuple[Values, ...]) -> Iterator[Placed]:
        if statement.name.name == "START" and statement.index is None:
            meant = (Values.JOINTS,) * len(statement.waypoints)
        for number, (meaning, point) in enumerate(zip(meant, statement.waypoints, strict=False), 1):
            if number > _COUNTED:
                return
            values = own_values(statement, point)
            front = f"{number}." if len(meant) > 1 else ""
            if len(values) == 1 and isinstance(word := values[0], Word):
                kind: FieldKind = "joints" if meaning.of_joints else "pose"
                if (symbol := self._sketch.names.meant(word.name, False, statement.line)) is not None:
                    kind = "pose" if symbol.kind == "pose" else "joints"
                field = Field(f"{front}target", f"{front}Target", kind, word.text)
                yield Placed(field, "value", word.place)
                continue
            if len(values) == 1 and isinstance(text := values[0], Text):
                yield Placed(Field("file", "File", "text", text.text.strip('"')), "value", text.place, '"@"')
                continue
            columns = self._columns(meaning, len(values))
            if len(values) == 1 and len(columns) > 1 and isinstance(values[0], Computed):
                # A single expression stands for a whole pose or joint position: an entry of a table.
                target = Field(f"{front}target", f"{front}Target", "number", values[0].text)
                yield Placed(target, "value", values[0].place)
            elif len(columns) == len(values):
                for (label, unit), value in zip(columns, values, strict=True):
                    name = front + label if front else label
                    yield Placed(Field(name, name, "number", value.text, unit), "value", value.place)
            if point.time is not None:
                inner = " ".join(one.text for one in point.time.items)
                field = Field(f"{front}time", f"{front}Time", "number", inner, self._unit("time"))
                yield Placed(field, "value", point.time.place, "[@]")

    def _columns(self, meaning: Values, count: int) -> tuple[tuple[str, str], ...]:
        """Return the label and the unit of each value of a waypoint."""
        key = (meaning, count, *self._units.values())
        if key not in self._known:
            labels = meaning.labels(self._joints or _JOINTS[:count])
            self._known[key] = tuple((one, self._value_unit(meaning, one)) for one in labels)
        return self._known[key]

    def _value_unit(self, meaning: Values, label: str) -> str:
        if meaning.of_joints or label in ("qx", "qy", "qz", "qw"):
            return ""
        return self._unit("length" if label in ("x", "y", "z") else "angle")

    def _unit(self, kind: Kind) -> str:
        return self._units.get(kind, "")

    def _of_other(self, statement: Statement, word: str) -> Iterator[Placed]:
        values = [value for point in statement.waypoints for value in point.values]
        if (spec := actions().get(word)) is not None:
            form = spec.form_of(len(values))
            if statement.expression is not None and word == "WAIT":
                yield self._expression(statement, word)
            elif form is not None:
                yield from slot_fields(form.slots, values)
            if spec.takes_time:
                place = statement.time.place if statement.time else None
                field = Field(
                    "time",
                    "At most" if values or statement.expression else "Time",
                    "number",
                    _inner(statement),
                    self._unit("time"),
                )
                yield Placed(field, "time", place, "[@]")
                yield _units_field(statement)
        elif word == "CALL" and values:
            yield _value("sub", "SUB", "choice", values[0])
            for number, value in enumerate(values[1:], 1):
                yield _value(str(number), f"Argument {number}", "text", value)
        elif word == "REPEAT" and values:
            yield _value("count", "Times", "number", values[-1])
        elif word == "CASE" and values:
            yield _value("selector", "Register or input", "text", values[0])
        elif word == "OF":
            for number, value in enumerate(values, 1):
                yield _value(str(number), "Value or range", "text", value)
        elif word == "REGISTER" and len(values) > 1:
            yield _value("range", "Range", "text", values[1])
            for value in values[2:3]:
                yield _value("first", "Begins with", "number", value)
        elif word == "ON" and len(values) == len(word_specs()[word].slots) + 1:
            yield from slot_fields(word_specs()[word].slots, values[:-1])
            yield _value("sub", "SUB", "choice", values[-1])
        elif word in word_specs() and values and len(values) == len(word_specs()[word].slots):
            yield from slot_fields(word_specs()[word].slots, values)
        elif statement.expression is not None:
            yield self._expression(statement, word)

    def _expression(self, statement: Statement, word: str) -> Placed:
        assert statement.expression is not None
        place = _whole(self._sketch, statement)
        text = self._sketch.source.line(statement.line + place.row)[place.start - 1 : place.end - 1]
        name, label = ("value", "Value") if word in ("LET", "FUNC", "SET") else ("condition", "Condition")
        return Placed(Field(name, label, "text", text), "value", place)


def slot_fields(slots: Sequence[Slot], values: Sequence[Value]) -> Iterator[Placed]:
    """Yield the fields of an action's values."""
    for one, value in zip(fields_of(slots), values, strict=True):
        text = value.text.strip('"') if one.kind == "text" else value.text
        yield Placed(replace(one, value=text), "value", value.place, '"@"' if one.kind == "text" else "@")


def fields_of(slots: Sequence[Slot]) -> tuple[Field, ...]:
    """Return an empty field for each value that an action (a command without motion) takes. If several fields
    have the same name, the names get numbers.
    """
    found: list[Field] = []
    for slot in slots:
        name, label, kind = _SLOTS[slot]
        count = sum(one.name.rpartition(".")[2] == name for one in found) + 1
        choices = _CHOICES.get(slot, ())
        found.append(Field(f"{count}.{name}" if count > 1 else name, label, kind, "", choices=choices))
    return tuple(found)


STATES_OF_SIGNALS = ("ON", "OFF")
_CHOICES = {Slot.STATE: STATES_OF_SIGNALS, Slot.REACTION: tuple(REACTIONS)}
_SLOTS: dict[Slot, tuple[str, str, FieldKind]] = {
    Slot.INPUT: ("signal", "Input", "signal"),
    Slot.OUTPUT: ("signal", "Output", "signal"),
    Slot.STATE: ("value", "Value", "choice"),
    Slot.TEXT: ("text", "Text", "text"),
    Slot.REGISTER: ("register", "Register that receives the answer (empty: no answer is stored)", "choice"),
    Slot.TAUGHT: ("name", "Name of the place", "signal"),
    Slot.TOOL: ("tool", "Tool that is on the flange after this line", "choice"),
    Slot.REACTION: ("reaction", "Action of the robot", "choice"),
}
"""Name, label and kind of the field for each kind of value."""


def _whole(sketch: Sketch, statement: Statement) -> Place:
    """Return the place of the expression in the text of a LET, FUNC, SET, IF, WHEN or WAIT.

    The expression is the code after the equals sign or after the first word, up to a time in brackets.
    """
    from yarclang.syntax.lines import code_of

    code = code_of(sketch.source.line(statement.line)).rstrip()
    if statement.time is not None:
        code = code[: statement.time.place.start - 1].rstrip()
    begin = statement.name.place.end - 1
    if statement.name.name in ("LET", "FUNC", "SET"):
        begin = code.index("=", begin) + 1
    begin += len(code[begin:]) - len(code[begin:].lstrip())
    return Place(0, begin + 1, len(code) + 1)


def _units(statement: Statement) -> dict[Kind, str]:
    items = statement.units.items if statement.units else ()
    named = [UNITS.get(one.text.lower()) for one in items]
    return {unit.kind: unit.name for unit in named if unit is not None}


def _value(name: str, label: str, kind: FieldKind, value: Value, choices: tuple[str, ...] = ()) -> Placed:
    return Placed(Field(name, label, kind, value.text, choices=choices), "value", value.place)


def _frame(name: str, label: str, frame: FrameName | None, part: Part) -> Placed:
    if frame is None:
        return _absent(name, label, "frame", "", part, "{@}")
    return Placed(Field(name, label, "frame", frame.name), part, frame.place, "{@}")


@cache
def _absent(
    name: str, label: str, kind: FieldKind, unit: str, part: Part, form: str, choices: tuple[str, ...] = ()
) -> Placed:
    """Return an empty field for something that a statement doesn't contain. The result is cached, because
    most commands lack most fields.
    """
    return Placed(Field(name, label, kind, "", unit, choices), part, None, form)


def _units_field(statement: Statement) -> Placed:
    units = statement.units
    if units is None:
        return _absent("units", "Units", "text", "", "units", "(@)")
    text = ",".join(one.text for one in units.items)
    return Placed(Field("units", "Units", "text", text), "units", units.place, "(@)")


def _inner(statement: Statement) -> str:
    return " ".join(one.text for one in statement.time.items) if statement.time else ""


def _times(statement: Statement, *, has_speed: bool, unit: str, speed: str) -> Iterator[Placed]:
    """Yield the fields for what a motion's square brackets may contain: a time, a share of the limits, a
    speed, or a largest speed. Only one of these fields has a value.
    """
    if statement.time is None:
        yield _absent("time", "Time", "number", unit, "time", "[@]", ("MIN",))
        yield _absent("percent", "Speed, share of the limits", "percent", "%", "time", "[@%]")
        if has_speed:
            yield _absent("speed", "Speed", "number", speed, "time", "[V @]")
        yield _absent("ceiling", "Speed, at most", "number", speed, "time", "[V<=@]")
        return
    text, place = _inner(statement), statement.time.place
    ceiling = text.partition("<=")[2].strip() if text[:1].upper() == "V" else ""
    is_speed = text[:1].upper() == "V" and not ceiling
    is_share = text.endswith("%")
    plain = "" if is_speed or is_share or ceiling else text
    yield Placed(Field("time", "Time", "number", plain, unit, ("MIN",)), "time", place, "[@]")
    share = text.rstrip("% ") if is_share else ""
    yield Placed(Field("percent", "Speed, share of the limits", "percent", share, "%"), "time", place, "[@%]")
    if has_speed:
        value = text[1:].strip() if is_speed else ""
        yield Placed(Field("speed", "Speed", "number", value, speed), "time", place, "[V @]")
    yield Placed(Field("ceiling", "Speed, at most", "number", ceiling, speed), "time", place, "[V<=@]")


def _options(
    statement: Statement, spec: CommandSpec, meant: tuple[Values, ...], length: str
) -> Iterator[Placed]:
    given = {option.word.name: option for option in statement.options}
    of_joints = bool(meant) and all(one.of_joints for one in meant)
    yield _option(given, "BLEND", "Blend", "number", "" if of_joints else length)
    yield _option(given, "ACC", "Share of acceleration", "percent", "%")
    yield _option(given, "TOL", "Tolerance", "number", length)
    if "NEAR" in given or (not spec.moves_frame and not of_joints):
        yield _option(given, "NEAR", "Near", "joints", "")
    if spec.may_search:
        yield _option(given, "UNTIL", "Until an input is ON (or: NAME OFF)", "text", "")
        if spec.moves_frame:
            yield _option(given, "INTO", "Register for how far it came, 0.01 mm", "text", "")
    yield from _allowed(statement, given)


def _last_time(statement: Statement, unit: str) -> Placed:
    """Return the field for the time of a timed motion's last waypoint."""
    if statement.time is None:
        return _absent("time", "Time", "number", unit, "time", "[@]")
    return Placed(
        Field("time", "Time", "number", _inner(statement), unit), "time", statement.time.place, "[@]"
    )


def _options_of_table(statement: Statement) -> Iterator[Placed]:
    given = {option.word.name: option for option in statement.options}
    yield _option(given, "STRETCH", "All times times", "number", "")
    yield _option(given, "TOL", "Tolerance", "number", "")
    yield from _allowed(statement, given)


def _allowed(statement: Statement, given: dict[str, Option]) -> Iterator[Placed]:
    """Yield the field of the option ALLOW (two bodies that may touch). If a motion has several of these
    options, there is no field, and they are edited in the text.
    """
    if sum(option.word.name == "ALLOW" for option in statement.options) < 2:
        yield _option(given, "ALLOW", "Bodies that may touch (two names)", "text", "")


def _option(given: dict[str, Option], word: str, label: str, kind: FieldKind, unit: str) -> Placed:
    form = f"{word} @%" if kind == "percent" else f"{word} @"
    option = given.get(word)
    if option is None:
        return _absent(word.lower(), label, kind, unit, "option", form)
    if option.at_most:
        form = form.replace("@", "<=@")
    argument = option.argument
    text = argument.text if argument is not None else ""
    end = argument.place if argument is not None else option.word.place
    if option.state is not None:
        text, end = f"{text} {option.state.text}", option.state.place
    place = Place(option.word.place.row, option.word.place.start, end.end)
    if end.row != place.row:
        place = end
    shown = text.rstrip("% ") if kind == "percent" else text
    return Placed(Field(word.lower(), label, kind, shown, unit), "option", place, form)


def _comment(statement: Statement) -> Placed:
    first = next((one for one in statement.comments if one.place.row == 0), None)
    if first is None:
        return _absent("comment", "Comment", "text", "", "comment", "! @")
    return Placed(
        Field("comment", "Comment", "text", first.text.lstrip("!").strip()), "comment", first.place, "! @"
    )
