"""Alarms as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from datetime import UTC, datetime

from yarclang.pendant.alarms.alarm import Alarm

_HEAD = (
    *("number", "time (UTC)", "last (UTC)", "count", "ended (UTC)", "acknowledged (UTC)", "by", "code"),
    *("what", "remedy", "source", "program", "line", "command", "joints", "owner"),
)
_FORMULA = ("=", "+", "-", "@", "\t", "\r", "|", "%")
"""Characters with which formulas begin in spreadsheet programs. An apostrophe is put before a cell that
begins with one, so that the cell is read as text.
"""


def as_csv(alarms: Iterable[Alarm]) -> str:
    """Return alarms as CSV, one row each, with times in UTC. Cells that a spreadsheet program would read
    as formulas are marked as text.
    """
    csv_text = io.StringIO()
    writer = csv.writer(csv_text, quoting=csv.QUOTE_ALL, lineterminator="\r\n")
    writer.writerow(_HEAD)
    for alarm in alarms:
        raised, stood = alarm.raised, alarm.stood
        row = (
            str(alarm.number),
            utc(alarm.time),
            utc(alarm.last),
            str(alarm.count),
            "" if alarm.ended is None else utc(alarm.ended),
            "" if alarm.acknowledged is None else utc(alarm.acknowledged),
            alarm.by,
            raised.code,
            raised.what,
            raised.remedy,
            raised.source,
            stood.file or stood.program,
            str(stood.line or ""),
            stood.command,
            " ".join(f"{name} {value:.3f} {unit}" for name, value, unit in stood.joints),
            stood.owner,
        )
        writer.writerow([_harmless(text) for text in row])
    return csv_text.getvalue()


def _harmless(text: str) -> str:
    return f"'{text}" if text.lstrip().startswith(_FORMULA) else text


def utc(seconds: float) -> str:
    """Return a time of day [s since 1970] as ISO 8601 in UTC."""
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")
