"""Changes of zones, obstacles and limits in the text of a file. All other bytes of the text stay unchanged.
No I/O.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import Any

from yarclang.pendant.messages.workspace import EntryChange, EntryValues, LimitChange
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.toml.changes import ChangeError, with_table, with_value, without

_BY_HAND = "change the file by hand: Program > open it"
_LONGEST = 2000
_MOST_WORK = 2_000_000
"""Largest product of the number of changes and the number of characters of a file. Each change parses the
text again; the limit corresponds to about 10 s.
"""


def with_entries(source: SourceFile, changes: Sequence[EntryChange]) -> tuple[str, str]:
    """Return the text of a cell.toml with changed zones and obstacles, and a description of the changes.

    Args:
        source: the text before the changes.
        changes: at most one change for each entry.

    Raises:
        Trouble: there is no such entry, or the file is written in a form that can't be changed.
    """
    if len(changes) * len(source.text) > _MOST_WORK:
        what = (
            f"{len(changes)} changes of {source.name}, which has {len(source.text):,} characters, are "
            f"too many at once"
        )
        raise Trouble(what, "save fewer at a time, or change the file by hand under Program", "large")
    data = _data(source)
    told: list[str] = []
    text = source.text
    _check_each_once(changes, data)
    try:
        for one in changes:
            if one.at is not None and one.values is not None:
                text, said = _changed(text, source.name, one, data[one.table][one.at])
                told += said
        for one in sorted(changes, key=lambda each: -(each.at or 0)):
            if one.at is not None and one.values is None:
                text = without(SourceFile(source.name, text), (one.table, one.at))
                told.append(f"{_called(one, data[one.table][one.at])} removed")
        for one in changes:
            if one.at is None and one.values is not None:
                count = len(tomllib.loads(text).get(one.table, ()))
                values = _given(one.values)
                text = with_table(SourceFile(source.name, text), (one.table, count), values)
                told.append(f"{_called(one, values)} added")
    except ChangeError as error:
        what = f"{source.name} writes this in a form that can't be changed here: {str(error)[:200]}"
        raise Trouble(what, _BY_HAND, "") from None
    return text, "; ".join(told)[:_LONGEST]


def with_limits(source: SourceFile, limits: Sequence[LimitChange]) -> tuple[str, str]:
    """Return the text of a robot.toml with changed position limits, and a description of the changes.

    Raises:
        Trouble: there is no such joint, or the file is written in a form that can't be changed.
    """
    data = _data(source)
    tables = data.get("joints", {})
    text, told = source.text, []
    for one in limits:
        table = tables.get(one.joint) if isinstance(tables, dict) else None
        if not isinstance(table, dict):
            raise Trouble(f"{source.name} has no joint {one.joint[:40]}", "open the page again", "")
        if not one.lower < one.upper:
            what = f"the lower limit {one.lower:g} of {one.joint} isn't below the upper limit {one.upper:g}"
            raise Trouble(what, "exchange the two", "Y1316")
        wanted = [one.lower, one.upper]
        if table.get("position") == wanted:
            continue
        try:
            text = with_value(SourceFile(source.name, text), ("joints", one.joint, "position"), wanted)
        except ChangeError as error:
            raise Trouble(f"{source.name} can't be changed here: {error}", _BY_HAND, "") from None
        told.append(f"position of {one.joint} from {table.get('position', 'none')} to {_plain(wanted)}")
    return text, "; ".join(told)[:_LONGEST]


def _data(source: SourceFile) -> dict[str, Any]:
    try:
        return tomllib.loads(source.text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise Trouble(f"{source.name} is not TOML: {error}", _BY_HAND, "") from None


def _check_each_once(changes: Sequence[EntryChange], data: dict[str, Any]) -> None:
    seen = set()
    for one in changes:
        if one.at is None:
            continue
        entries = data.get(one.table)
        if not isinstance(entries, list) or one.at >= len(entries) or not isinstance(entries[one.at], dict):
            raise Trouble(f"there is no entry {one.at + 1} of {one.table}", "open the page again", "")
        if (one.table, one.at) in seen:
            raise Trouble(f"entry {one.at + 1} of {one.table} is changed twice", "open the page again", "")
        seen.add((one.table, one.at))


def _changed(text: str, name: str, one: EntryChange, before: dict[str, Any]) -> tuple[str, list[str]]:
    """Return the text with a changed entry, and a description of each changed value."""
    assert one.values is not None
    wanted, told = _given(one.values), list[str]()
    changed = text
    for key in EntryValues.model_fields:
        path = (one.table, one.at or 0, key)
        called = f"{key} of {_called(one, before)}"
        if key in wanted and before.get(key) != wanted[key]:
            changed = _put(changed, name, path, wanted[key])
            told.append(f"{called} from {_plain(before.get(key, 'none'))} to {_plain(wanted[key])}")
        elif key not in wanted and key in before:
            changed = _put(changed, name, path, None)
            told.append(f"{called} from {_plain(before[key])} to none")
    return changed, told


def _put(text: str, name: str, path: tuple[str, int, str], value: object) -> str:
    """Return the text with a new value for a key of an entry (None removes the key). An entry that is written
    on one line is written anew.
    """
    source = SourceFile(name, text)
    try:
        return without(source, path) if value is None else with_value(source, path, value)
    except ChangeError:
        entry = dict(tomllib.loads(text)[path[0]][path[1]])
        entry.pop(path[2], None)
        return with_value(source, path[:2], entry if value is None else entry | {path[2]: value})


def _given(values: EntryValues) -> dict[str, Any]:
    found: dict[str, Any] = values.model_dump(mode="json", exclude_none=True)
    return found


def _called(one: EntryChange, values: dict[str, Any]) -> str:
    return f"{one.table[:-1]} {str(values.get('name', 'without a name'))[:40]}"


def _plain(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_plain, value))}]"
    return str(value)[:80]
