"""Change a value, a table, or an entry of an array of tables in a TOML text.

All other bytes stay unchanged. Each changed text is parsed again, and refused if its meaning isn't the
intended one.
"""

from __future__ import annotations

import copy
import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from yarclang.source import SourceFile
from yarclang.toml.places import Path, Places, find_places

_BARE = re.compile(r"[A-Za-z0-9_-]+")


class ChangeError(ValueError):
    """Raised if the form of a TOML file doesn't allow a small change. The user then has to edit the file."""


def printed(value: object) -> str:
    """Return a value as TOML on one line. The value is a text, a boolean, a number, or a list or table of
    these.

    Raises:
        ChangeError: TOML has no such value.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() else repr(value)
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{_key(key)} = {printed(one)}' for key, one in value.items())} }}"
    if isinstance(value, Sequence):
        return f"[{', '.join(map(printed, value))}]"
    raise ChangeError(f"{value!r:.40} can't be written into a TOML file")


def with_value(source: SourceFile, path: Path, value: object) -> str:
    """Return a TOML text with one value changed. A new key becomes the last key of its table; a missing table
    is added.

    Args:
        source: a text that tomllib accepts.
        path: path of the value.
        value: the new value.

    Raises:
        ChangeError: the form of the file doesn't allow the change.
    """
    places = find_places(source)
    lines = source.text.split("\n")  # a carriage return before a line break stays part of its line
    if span := places.values.get(path):
        behind = lines[span.end_line - 1][span.end_column - 1 :]
        before = lines[span.line - 1][: span.column - 1]
        lines[span.line - 1 : span.end_line] = (before + printed(value) + behind).split("\n")
    elif (last := _last_line(places, lines, path[:-1])) is not None:
        ending = "\r" if source.text.endswith("\r\n") or "\r\n" in source.text else ""
        if last >= len(lines):
            lines.append("")
            lines[last - 1] += ending
        lines.insert(last, f"{_key(str(path[-1]))} = {printed(value)}{ending}")
    else:
        return with_table(source, path[:-1], {str(path[-1]): value})
    return _checked(source.text, "\n".join(lines), path, value)


def with_table(source: SourceFile, path: Path, values: Mapping[str, object]) -> str:
    """Return a TOML text with a new table at its end.

    Args:
        source: a text that tomllib accepts.
        path: path of the table, which doesn't exist yet. If it ends in a number, the table is a new entry of
            an array of tables.
        values: values of the table's keys.

    Raises:
        ChangeError: if the form of the file doesn't allow the change.
    """
    text = source.text
    ending = "\r\n" if "\r\n" in text else "\n"
    is_entry = bool(path) and isinstance(path[-1], int)
    name = ".".join(_key(str(one)) for one in path if not isinstance(one, int))
    header = f"[[{name}]]" if is_entry else f"[{name}]"
    if text and not text.endswith("\n"):
        text += ending
    made = [header, *(f"{_key(key)} = {printed(value)}" for key, value in values.items()), ""]
    text += (ending if text else "") + ending.join(made)
    return _checked(source.text, text, path, dict(values))


def without(source: SourceFile, path: Path) -> str:
    """Return a TOML text without a key, a table, or an entry of an array of tables. Comments above a table
    stay.

    Args:
        source: a text that tomllib accepts.
        path: path of the key, table or entry to remove.

    Raises:
        ChangeError: if the form of the file doesn't allow the change, or if the path doesn't exist.
    """
    places = find_places(source)
    lines = source.text.split("\n")
    if path not in places.keys:
        raise ChangeError(f"{_said(path)} isn't in {source.name}")
    first = places.keys[path].line
    if path in places.values:
        last = places.values[path].end_line
    else:
        last = max(
            span.end_line
            for table in (places.keys, places.values)
            for one, span in table.items()
            if one[: len(path)] == path
        )
        if last < len(lines) and not lines[last].strip():
            last += 1
    del lines[first - 1 : last]
    return _checked(source.text, "\n".join(lines), path, None)


def _last_line(places: Places, lines: Sequence[str], table: Path) -> int | None:
    """Return the number (from 1) of the line after which a new key of a table is added; 0 for the start of
    the file. None if the table has no header.
    """
    if not table:
        tops = [span.end_line for path, span in places.values.items() if len(path) == 1]
        return max(tops, default=0)
    header = places.keys.get(table)
    if header is None or not lines[header.line - 1].lstrip().startswith("["):
        return None
    own = [span.end_line for path, span in places.values.items() if path[:-1] == table]
    return max([header.line, *own])


def _checked(old: str, new: str, path: Path, value: object) -> str:
    """Check that a changed TOML text differs from the old text only in the value at a path, and return the
    changed text.

    Args:
        old: the text before the change.
        new: the text after the change.
        path: path of the change.
        value: the new value; None if it was removed.

    Raises:
        ChangeError: the texts differ elsewhere.
    """
    try:
        wanted, found = tomllib.loads(old), tomllib.loads(new)
        _put(wanted, path, value)
    except (tomllib.TOMLDecodeError, KeyError, IndexError, TypeError) as error:
        raise ChangeError(f"{_said(path)} can't be changed in place: {error}") from None
    if wanted != found:
        raise ChangeError(f"{_said(path)} can't be changed in place")
    return new


def _put(data: dict[str, Any], path: Path, value: object) -> None:
    here: Any = data
    for one, below in pairwise(path):
        if isinstance(one, str) and one not in here:
            here[one] = [] if isinstance(below, int) else {}
        here = here[one]
    last = path[-1]
    if value is None:
        del here[last]
        # Removing the last entry of an array of tables removes the array.
        if not here and isinstance(last, int):
            _put(data, path[:-1], None)
    elif isinstance(last, int) and last == len(here):
        here.append(copy.deepcopy(value))
    else:
        here[last] = copy.deepcopy(value)


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else printed(name)


def _said(path: Path) -> str:
    return ".".join(map(str, path))
