"""Database table of alarms. Each function takes a database connection; call it through `Database.call`, as
one transaction.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable
from typing import Any

from yarclang.pendant.alarms.alarm import Alarm, Raised, Stood

_COLUMNS = "number, time, last, count, ended, acknowledged, by, source, code, what, remedy, stood"


def kept_alarms(connection: sqlite3.Connection, most: int) -> tuple[Alarm, ...]:
    """Return the newest alarms in the database, at most `most`. Table rows that can't be read are left
    out.
    """
    rows = connection.execute(
        f"SELECT {_COLUMNS} FROM alarms ORDER BY number DESC LIMIT ?",
        (most,),
    )
    alarms = []
    for row in rows:
        try:
            alarms.append(_alarm(row))
        except (ValueError, TypeError, KeyError):
            continue
    return tuple(alarms)


def _alarm(row: tuple[Any, ...]) -> Alarm:
    number, time, last, count, ended, acknowledged, by, source, code, what, remedy, stood = row
    stood_values = json.loads(stood)
    stood_values["joints"] = tuple(
        (str(name), float(value), str(unit)) for name, value, unit in stood_values["joints"]
    )
    stood_values["flange"] = (
        None if stood_values["flange"] is None else tuple(map(float, stood_values["flange"]))
    )
    return Alarm(
        number,
        Raised(source, what, code, remedy),
        Stood(**stood_values),
        time,
        last,
        count,
        ended,
        acknowledged,
        by,
    )


def write_alarms(connection: sqlite3.Connection, alarms: Iterable[Alarm], removed: Iterable[int]) -> None:
    """Write alarms to the database, and delete those that were removed.

    Args:
        connection: connection to the database.
        alarms: new and changed alarms.
        removed: numbers of the removed alarms.
    """
    connection.executemany("DELETE FROM alarms WHERE number = ?", [(one,) for one in removed])
    connection.executemany(
        f"INSERT OR REPLACE INTO alarms ({_COLUMNS}) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        [_row(one) for one in alarms],
    )


def _row(alarm: Alarm) -> tuple[Any, ...]:
    raised, stood = alarm.raised, alarm.stood
    stood_values = {name: getattr(stood, name) for name in Stood.__slots__}
    return (
        alarm.number,
        alarm.time,
        alarm.last,
        alarm.count,
        alarm.ended,
        alarm.acknowledged,
        alarm.by,
        raised.source,
        raised.code,
        raised.what,
        raised.remedy,
        json.dumps(stood_values),
    )
