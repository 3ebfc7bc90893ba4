"""Read the tables of a TOML file, and turn errors of pydantic into findings for the user."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from typing import Any, Generic, TypeVar

from pydantic import ValidationError

from yarclang.frozen import frozen
from yarclang.subjects import Name, Subject
from yarclang.toml.file import TomlFile
from yarclang.toml.places import Path
from yarclang.toml.tables import LARGEST, LEAST, Document, Table

D = TypeVar("D", bound=Document)


@frozen
class Mistake:
    """A mistake in the form of a TOML file, such as a value of the wrong type.

    Attributes:
        code: code of the finding.
        path: path of the key.
        message: message of the finding.
        help: remedy.
        at_key: True if the finding's place is the key, not the value.
        subject: subject of the finding.
    """

    code: str
    path: Path
    message: str
    help: str
    at_key: bool = False
    subject: Subject | None = None

    def tell(self, file: TomlFile) -> None:
        """Add the mistake to the findings of the file."""
        file.say(self.code, self.path, self.message, self.help, self.subject, at_key=self.at_key)


@frozen
class Draft(Generic[D]):
    """The readable content of a TOML file, and the mistakes in the rest of the file.

    Attributes:
        table: content of the file, without the dropped keys.
        dropped: the keys with a wrong form.
        mistakes: the mistakes, at least one for each dropped key.
    """

    table: D
    dropped: frozenset[Path]
    mistakes: tuple[Mistake, ...]

    def tell(self, file: TomlFile) -> None:
        """Add the mistakes to the findings of the file."""
        for mistake in self.mistakes:
            mistake.tell(file)


def read_draft(data: dict[str, Any], document: type[D]) -> Draft[D]:
    """Read the tables of a TOML file, without the keys whose values have the wrong form.

    Args:
        data: the file as read by tomllib. Wrong keys are removed from it.
        document: schema of the file.
    """
    mistakes: list[Mistake] = []
    dropped: set[Path] = set()
    excused: set[Path] = set()
    try:
        table = document.model_validate(data)
    except ValidationError as error:
        mistakes = [_mistake(document, data, detail, excused) for detail in error.errors(include_url=False)]
        dropped = {_prune(data, mistake.path) for mistake in mistakes}
        table = document.model_validate(data)  # no error is left, since no key depends on another
    for missing in _missing(table):
        if missing not in dropped and missing not in excused:
            mistakes.append(missing_mistake(document, missing))
    return Draft(table, frozenset(dropped), tuple(mistakes))


def _mistake(document: type[Document], data: dict[str, Any], detail: Any, excused: set[Path]) -> Mistake:
    """Convert one error of pydantic to a mistake. If a key is the misspelling of a required key, the required
    key is added to `excused`, so that it isn't reported as missing.
    """
    path: Path = tuple(detail["loc"])
    kind: str = detail["type"]
    name, value, context = spoken(path), detail.get("input"), detail.get("ctx", {})
    if kind == "extra_forbidden":
        return _unknown_key(document, data, path, excused)
    # pydantic reports `float_type` also for an integer beyond the range of floats. Such a value has the right
    # type.
    if kind in _TYPES and not (kind == "float_type" and type(value) is int):
        wanted = _wanted(document, path) or _TYPES[kind]
        return Mistake("Y1306", path, f"{name} is {_kind(value)}, but must be {wanted}.", f"Write {wanted}.")
    shown = _shown(value)
    if kind == "literal_error":
        expected = str(context.get("expected")).replace("'", '"')
        message = f"{name} is {shown}, but must be {expected}."
        near = difflib.get_close_matches(str(value), expected.split('"')[1::2], 1, 0.6)
        subject = Name(str(value), near[0] if near else "")
        help_ = f"Did you mean {near[0]}?" if near else f"Write {expected}."
        return Mistake("Y1308", path, message, help_, subject=subject)
    if isinstance(value, (int, float)) and abs(value) <= LARGEST and ("ge" in context or "le" in context):
        bound = "at least 0.000001" if context.get("ge") == LEAST else ""
        bound = bound or (
            f"at least {context['ge']:,g}" if "ge" in context else f"at most {context['le']:,.7g}"
        )
        message = f"{name} is {shown}, but must be {bound}."
        return Mistake("Y1308", path, message, f"Write a value of {bound}.")
    message = f"{name} is {shown}, but must be a finite number of at most 1e12."
    return Mistake("Y1307", path, message, "Write a finite number; nan and inf aren't allowed.")


_TYPES = {
    "float_type": "a number",
    "int_type": "an integer",
    "int_from_float": "an integer",
    "bool_type": "true or false",
    "string_type": 'a text in "quotes"',
    "list_type": "a list in [brackets]",
    "dict_type": "a table",
    "model_type": "a table",
}


def _wanted(document: type[Document], path: Path) -> str | None:
    """Return the schema's description of a key's values; None if the schema has no description, and for an
    entry of a list.
    """
    key = path[-1]
    return _table_at(document, path[:-1]).wanted.get(key) if isinstance(key, str) else None


def _unknown_key(document: type[Document], data: dict[str, Any], path: Path, excused: set[Path]) -> Mistake:
    """Return the mistake for an unknown key. If the key is the misspelling of a required key, the required
    key is added to `excused`.
    """
    *above, key = path
    table = _table_at(document, tuple(above))
    fields = tuple(table.model_fields)
    here: Any = data
    for part in above:
        here = here[part]
    near = difflib.get_close_matches(str(key), [field for field in fields if field not in here], 1, 0.6)
    known = ", ".join(fields)
    message = f"{_table(path)} doesn't know the key {key}."
    if not near:
        return Mistake("Y1305", path, message, f"Remove it; the keys are {known}.", at_key=True)
    if near[0] in table.required:
        excused.add((*above, near[0]))
    help_ = f"Did you mean {near[0]}? The keys are {known}."
    return Mistake("Y1305", path, message, help_, at_key=True, subject=Name(str(key), near[0]))


def _table_at(document: type[Document], path: Path) -> type[Table]:
    return document.tables[str(path[0])] if path and path[0] in document.tables else document


def _missing(document: Document) -> Iterator[Path]:
    """Yield the paths of missing required keys."""
    tables: list[tuple[Path, Table]] = [((), document)]
    for key in document.tables:
        content = getattr(document, key)
        if isinstance(content, Table):
            tables.append(((key,), content))
        elif isinstance(content, dict):
            tables += [((key, name), table) for name, table in content.items()]
        else:
            tables += [((key, number), table) for number, table in enumerate(content or ())]
    for path, table in tables:
        yield from ((*path, key) for key in table.required if getattr(table, key) is None)


def missing_mistake(document: type[Document], path: Path, why: str = "") -> Mistake:
    """Return the mistake that a required key is missing; `why` is the end of the message's first sentence."""
    key = str(path[-1])
    example = document.examples.get(key)
    if len(path) == 1 and example is not None and example.startswith("it "):
        message, remedy = f"The table [{key}] is missing{why}.", f"Add it; {example}"
    else:
        message = f"{_table(path) if len(path) > 1 else 'The file'} lacks {key}{why}."
        remedy = f"Add it; {example or f'{key} = [...], one entry for each joint.'}"
    return Mistake("Y1304", path, message, remedy, at_key=True)


def _prune(data: dict[str, Any], path: Path) -> Path:
    """Remove the innermost key of `path` from the data, and return the key's path. If `path` leads to an
    entry of a list, the whole list is removed.
    """
    end = max(at for at, part in enumerate(path) if isinstance(part, str)) + 1
    *above, key = path[:end]
    here: Any = data
    for part in above:
        here = here[part] if isinstance(part, int) else here.get(part, {})
    here.pop(key, None)
    return path[:end]


def spoken(path: Path) -> str:
    """Return a key's path in words: `K[3] of [actuation]`. Entries are counted from 1, like joints."""
    last = _key_of(path)
    name = str(path[last]) + "".join(f"[{part + 1}]" for part in path[last + 1 :] if isinstance(part, int))
    return f"{name} of {table_of(path)}" if last else name


def table_of(path: Path) -> str:
    """Return the table that contains a key, in words; empty for a key at the top of the file."""
    last = _key_of(path)
    return table_name(path[:last]) if last else ""


def _key_of(path: Path) -> int:
    """Return the index of the last key in a path. All later parts of the path are numbers of list entries."""
    return max(at for at, part in enumerate(path) if isinstance(part, str))


def table_name(path: Path) -> str:
    """Return a table in words: `[joints.J1]`, or `[[obstacles]] number 2`."""
    if len(path) > 1 and isinstance(path[1], int):
        return f"[[{path[0]}]] number {path[1] + 1}"
    return f"[{'.'.join(str(part) for part in path)}]"


def _table(path: Path) -> str:
    last = max(at for at, part in enumerate(path) if isinstance(part, str))
    return table_name(path[:last]) if last else "The file"


def _shown(value: Any) -> str:
    """Return a value as a message shows it, shortened if it is long."""
    if isinstance(value, int) and abs(value) >= 10**15:
        return "an integer of more than 15 digits"
    text = f'"{value}"' if isinstance(value, str) else repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def _kind(value: Any) -> str:
    for kind, name in ((bool, "true or false"), (dict, "a table"), (list, "a list")):
        if isinstance(value, kind):
            return name
    return f"the text {_shown(value)}" if isinstance(value, str) else _shown(value)
