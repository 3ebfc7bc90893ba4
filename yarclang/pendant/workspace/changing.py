"""Changes of zones, obstacles and joint limits in the texts of cell.toml and robot.toml. All other bytes
of a text stay unchanged. No I/O.
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
"""Limit on the work for one draft: the number of changes times the number of characters of the file. Each
change parses the text again, and at this limit the changes take about 10 s.
"""


def with_entries(source: SourceFile, changes: Sequence[EntryChange]) -> tuple[str, str]:
    """Change zones and obstacles in the text of a cell.toml. Return two values: the new text, and a
    description of the changes.

    Args:
        source: the text before the changes.
        changes: changes of entries (zones and obstacles), at most one for each entry.

    Raises:
        Trouble: there is no such entry, or the file is written in a form that can't be changed.
    """
    if len(changes) * len(source.text) > _MOST_WORK:
        problem = (
            f"{len(changes)} changes of {source.name}, which has {len(source.text):,} characters, can't "
            "be saved at once"
        )
        raise Trouble(
            problem, "save fewer changes at a time, or change the file by hand under Program", "large"
        )
    data = _data(source)
    descriptions: list[str] = []
    text = source.text
    _check_each_once(changes, data)
    try:
        for change in changes:
            if change.at is not None and change.values is not None:
                text, said = _changed(text, source.name, change, data[change.table][change.at])
                descriptions += said
        for change in sorted(changes, key=lambda each: -(each.at or 0)):
            if change.at is not None and change.values is None:
                text = without(SourceFile(source.name, text), (change.table, change.at))
                descriptions.append(f"{_called(change, data[change.table][change.at])} removed")
        for change in changes:
            if change.at is None and change.values is not None:
                count = len(tomllib.loads(text).get(change.table, ()))
                values = _values_set(change.values)
                text = with_table(SourceFile(source.name, text), (change.table, count), values)
                descriptions.append(f"{_called(change, values)} added")
    except ChangeError as error:
        problem = f"{source.name} has this entry in a form that can't be changed here: {str(error)[:200]}"
        raise Trouble(problem, _BY_HAND, "") from None
    return text, "; ".join(descriptions)[:_LONGEST]


def with_limits(source: SourceFile, limits: Sequence[LimitChange]) -> tuple[str, str]:
    """Change position limits of joints in the text of a robot.toml. Return two values: the new text, and a
    description of the changes.

    Raises:
        Trouble: there is no such joint, or the file is written in a form that can't be changed.
    """
    data = _data(source)
    tables = data.get("joints", {})
    text, descriptions = source.text, []
    for row in limits:
        table = tables.get(row.joint) if isinstance(tables, dict) else None
        if not isinstance(table, dict):
            raise Trouble(f"{source.name} has no joint {row.joint[:40]}", "open the page again", "")
        if not row.lower < row.upper:
            what = f"the lower limit {row.lower:g} of {row.joint} isn't below the upper limit {row.upper:g}"
            raise Trouble(what, "exchange the two", "Y1316")
        limits_asked = [row.lower, row.upper]
        if table.get("position") == limits_asked:
            continue
        try:
            text = with_value(SourceFile(source.name, text), ("joints", row.joint, "position"), limits_asked)
        except ChangeError as error:
            raise Trouble(f"{source.name} can't be changed here: {error}", _BY_HAND, "") from None
        descriptions.append(
            f"position of {row.joint} from {table.get('position', 'none')} to {_plain(limits_asked)}"
        )
    return text, "; ".join(descriptions)[:_LONGEST]


def _data(source: SourceFile) -> dict[str, Any]:
    try:
        return tomllib.loads(source.text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise Trouble(f"{source.name} is not TOML: {error}", _BY_HAND, "") from None


def _check_each_once(changes: Sequence[EntryChange], data: dict[str, Any]) -> None:
    names_seen = set()
    for change in changes:
        if change.at is None:
            continue
        entries = data.get(change.table)
        if (
            not isinstance(entries, list)
            or change.at >= len(entries)
            or not isinstance(entries[change.at], dict)
        ):
            raise Trouble(f"there is no entry {change.at + 1} of {change.table}", "open the page again", "")
        if (change.table, change.at) in names_seen:
            raise Trouble(
                f"entry {change.at + 1} of {change.table} is changed twice", "open the page again", ""
            )
        names_seen.add((change.table, change.at))


def _changed(text: str, name: str, change: EntryChange, before: dict[str, Any]) -> tuple[str, list[str]]:
    """Change the entry of a zone or obstacle. Return two values: the new text of the file, and a
    description of each changed value.
    """
    assert change.values is not None
    new_values, descriptions = _values_set(change.values), list[str]()
    changed = text
    for key in EntryValues.model_fields:
        path = (change.table, change.at or 0, key)
        called = f"{key} of {_called(change, before)}"
        if key in new_values and before.get(key) != new_values[key]:
            changed = _put(changed, name, path, new_values[key])
            descriptions.append(
                f"{called} from {_plain(before.get(key, 'none'))} to {_plain(new_values[key])}"
            )
        elif key not in new_values and key in before:
            changed = _put(changed, name, path, None)
            descriptions.append(f"{called} from {_plain(before[key])} to none")
    return changed, descriptions


def _put(text: str, name: str, path: tuple[str, int, str], value: object) -> str:
    """Return the text of a file with a new value for one key of an entry; None removes the key. If the text
    doesn't allow changing this key alone, the whole entry is written anew.
    """
    source = SourceFile(name, text)
    try:
        return without(source, path) if value is None else with_value(source, path, value)
    except ChangeError:
        entry = dict(tomllib.loads(text)[path[0]][path[1]])
        entry.pop(path[2], None)
        return with_value(source, path[:2], entry if value is None else entry | {path[2]: value})


def _values_set(values: EntryValues) -> dict[str, Any]:
    found: dict[str, Any] = values.model_dump(mode="json", exclude_none=True)
    return found


def _called(change: EntryChange, values: dict[str, Any]) -> str:
    return f"{change.table[:-1]} {str(values.get('name', 'without a name'))[:40]}"


def _plain(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_plain, value))}]"
    return str(value)[:80]
