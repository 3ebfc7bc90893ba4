"""Reading the tables of a robot.toml: what pydantic says of them, in words for the user."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from yarclang.robot.schema import (
    LARGEST,
    LEAST,
    ActuationTable,
    ControllerTable,
    FrameTable,
    JointTable,
    MotorsTable,
    RobotTable,
    Table,
    ToleranceTable,
)
from yarclang.robot.toml_places import Path


@dataclass(frozen=True, slots=True)
class Mistake:
    """What is wrong with the form of the file, where."""

    code: str
    path: Path
    message: str
    help: str
    at_key: bool = False


@dataclass(frozen=True, slots=True)
class Draft:
    """A file as far as it can be read: `table` lacks what is `dropped`, each with a mistake."""

    table: RobotTable
    dropped: frozenset[Path]
    mistakes: tuple[Mistake, ...]


def read_draft(data: dict[str, Any]) -> Draft:
    """The tables of a robot.toml, without the keys whose values have the wrong form.

    Args:
        data: what tomllib made of the file; bad keys are taken out of it.
    """
    mistakes: list[Mistake] = []
    dropped: set[Path] = set()
    excused: set[Path] = set()
    try:
        table = RobotTable.model_validate(data)
    except ValidationError as error:
        mistakes = [_mistake(data, detail, excused) for detail in error.errors(include_url=False)]
        dropped = {_prune(data, mistake.path) for mistake in mistakes}
        table = RobotTable.model_validate(data)  # what is left has no error: no key depends on another here
    for missing in _missing(table):
        if missing not in dropped and missing not in excused:
            mistakes.append(_missing_mistake(missing))
    return Draft(table, frozenset(dropped), tuple(mistakes))


def _mistake(data: dict[str, Any], detail: Any, excused: set[Path]) -> Mistake:
    """The words for one error of pydantic."""
    path: Path = tuple(detail["loc"])
    kind: str = detail["type"]
    name, value, context = spoken(path), detail.get("input"), detail.get("ctx", {})
    if kind == "extra_forbidden":
        return _unknown_key(data, path, excused)
    if kind in _TYPES and not (kind == "float_type" and type(value) is int):  # an int beyond the floats
        wanted = _TYPES[kind]
        return Mistake("Y1306", path, f"{name} is {_kind(value)}, but must be {wanted}.", f"Write {wanted}.")
    shown = _shown(value)
    if kind == "literal_error":
        message = f"{name} is {shown}, but the only kind of controller is {context.get('expected')}."
        return Mistake("Y1308", path, message, 'Write kind = "turbo-pmac".')
    if isinstance(value, (int, float)) and abs(value) <= LARGEST and ("ge" in context or "le" in context):
        bound = "at least 0.000001" if context.get("ge") == LEAST else ""
        bound = bound or (
            f"at least {context['ge']:,g}" if "ge" in context else f"at most {context['le']:,.7g}"
        )
        message = f"{name} is {shown}, but must be {bound}."
        return Mistake("Y1308", path, message, f"Give a value of {bound}.")
    message = f"{name} is {shown}, but must be a finite number of at most 1e12."
    return Mistake("Y1307", path, message, "Write the number out; nan and inf are no numbers of a robot.")


_TYPES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": 'a text in "quotes"',
    "list_type": "a list in [brackets]",
    "dict_type": "a table",
    "model_type": "a table",
}


def _unknown_key(data: dict[str, Any], path: Path, excused: set[Path]) -> Mistake:
    """The words for a key that the table doesn't have; a required key that was meant is excused."""
    *above, key = path
    fields, required = _fields(tuple(above))
    here: Any = data
    for part in above:
        here = here[part]
    near = difflib.get_close_matches(str(key), [field for field in fields if field not in here], 1, 0.6)
    known = ", ".join(fields)
    message = f"{_table(path)} has no key {key}."
    if not near:
        return Mistake("Y1305", path, message, f"Remove it; the keys are {known}.", at_key=True)
    if near[0] in required:
        excused.add((*above, near[0]))
    return Mistake("Y1305", path, message, f"Did you mean {near[0]}? The keys are {known}.", at_key=True)


def _fields(path: Path) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The keys of the table at `path`, and those that are required."""
    table: type[Table] = RobotTable
    if path:
        table = _TABLES[str(path[0])]
    return tuple(table.model_fields), table.required


_TABLES: dict[str, type[Table]] = {
    "joints": JointTable,
    "frames": FrameTable,
    "actuation": ActuationTable,
    "motors": MotorsTable,
    "controller": ControllerTable,
    "tolerance": ToleranceTable,
}


def _missing(table: RobotTable) -> Iterator[Path]:
    """The required keys that aren't there."""
    tables: list[tuple[Path, Table | None]] = [((), table)]
    tables += [((key,), getattr(table, key)) for key in ("actuation", "motors", "controller")]
    tables += [(("joints", name), joint) for name, joint in (table.joints or {}).items()]
    for path, content in tables:
        if content is not None:
            yield from ((*path, key) for key in content.required if getattr(content, key) is None)
    if table.positions is not None and "HOME" not in (name.upper() for name in table.positions):
        yield ("positions", "HOME")


def _missing_mistake(path: Path) -> Mistake:
    key = path[-1]
    if len(path) == 1 and key in ("joints", "positions", *_TABLES):
        message, remedy = f"The table [{key}] is missing.", f"Add it; {_EXAMPLES[str(key)]}"
    else:
        message = f"{_table(path)} lacks {key}." if len(path) > 1 else f"The file lacks {key}."
        remedy = f"Add it; {_EXAMPLES.get(str(key), f'{key} = [...], one entry a joint.')}"
    return Mistake("Y1304", path, message, remedy, at_key=True)


_EXAMPLES = {
    "name": 'for example name = "INDUSTRIAL6".',
    "urdf": 'for example urdf = "industrial6.urdf", a file beside the robot.toml.',
    "base": 'for example base = "base_link", the link of the URDF that is {B}.',
    "flange": 'for example flange = "flange", the link of the URDF that is {FLANGE}.',
    "joints": "it has one table [joints.NAME] for each joint of the URDF.",
    "positions": "it needs HOME = [...], one value a joint.",
    "actuation": "it needs K = [...] and J = [[...], ...], as in counts = K J q + a0.",
    "motors": "it needs numbers = [...] and velocity = [...] in counts/ms.",
    "controller": 'it needs axes = ["X", ...] and feedback = ["P1", ...].',
    "velocity": "for example velocity = 60, in deg/s or mm/s (counts/ms in [motors], a list).",
    "acceleration": "for example acceleration = 240, in deg/s^2 or mm/s^2.",
    "jerk": "for example jerk = 2000, in deg/s^3 or mm/s^3.",
    "HOME": "HOME = [...], one value a joint in deg or mm.",
    "J": "J = [[...], ...], a row a motor and a column a joint; the unit matrix without coupling.",
}


def _prune(data: dict[str, Any], path: Path) -> Path:
    """Takes the innermost key of `path` out of the data; a list goes as a whole. Returns the key's path."""
    end = next((at for at, part in enumerate(path) if isinstance(part, int)), len(path))
    *above, key = path[:end]
    here: Any = data
    for part in above:
        here = here.get(part, {})
    here.pop(key, None)
    return path[:end]


def spoken(path: Path) -> str:
    """A path in words: `K[3] of [actuation]`, entries counted from 1 as the joints are."""
    name = ""
    keys = [part for part in path if isinstance(part, str)]
    for part in path:
        name = f"{name}[{part + 1}]" if isinstance(part, int) else part
    return f"{name} of [{'.'.join(keys[:-1])}]" if len(keys) > 1 else name


def _table(path: Path) -> str:
    keys = [str(part) for part in path[:-1] if isinstance(part, str)]
    return f"[{'.'.join(keys)}]" if keys else "The file"


def _shown(value: Any) -> str:
    """A value as a message prints it, cut where it is long."""
    if isinstance(value, int) and abs(value) >= 10**15:
        return "a whole number of more than 15 digits"
    text = f'"{value}"' if isinstance(value, str) else repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def _kind(value: Any) -> str:
    for kind, name in ((bool, "true or false"), (dict, "a table"), (list, "a list")):
        if isinstance(value, kind):
            return name
    return f"the text {_shown(value)}" if isinstance(value, str) else _shown(value)
