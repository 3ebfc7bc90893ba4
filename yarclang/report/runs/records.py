"""The records of an MCAP file up to where it ends, or stops making sense."""

from __future__ import annotations

import io
import json
from typing import Any

from mcap.records import Attachment, Channel, McapRecord, Message, Metadata
from mcap.stream_reader import StreamReader

from yarclang.frozen import frozen
from yarclang.report.runs.kind import MAGIC


@frozen(eq=False)
class Records:
    """What a file has of each kind.

    `messages` are topic and content, in the order in which they were written; those that aren't JSON objects are left out and counted by `unread`. `trouble` says why there may have been more; it is empty for
    a whole file.
    """

    metadata: dict[str, dict[str, str]]
    attachments: dict[str, bytes]
    messages: list[tuple[str, dict[str, Any]]]
    unread: int
    trouble: str


def read_records(content: bytes) -> Records | None:
    """Read what can be read of a file.

    Returns:
        None for a file that isn't MCAP, nor the beginning of one.
    """
    if content[: len(MAGIC)] != MAGIC:
        return None
    records, trouble = _up_to_trouble(content)
    metadata: dict[str, dict[str, str]] = {}
    attachments: dict[str, bytes] = {}
    topics: dict[int, str] = {}
    messages: list[tuple[str, dict[str, Any]]] = []
    unread = 0
    for record in records:
        match record:
            case Metadata(name=name):
                metadata[name] = record.metadata
            case Attachment(name=name, data=data):
                attachments[name] = data
            case Channel(id=number, topic=topic):
                topics[number] = topic.removeprefix("/")
            case Message(channel_id=number, data=data) if number in topics:
                value = _object(data)
                if value is None:
                    unread += 1
                else:
                    messages.append((topics[number], value))
            case _:
                pass
    return Records(metadata, attachments, messages, unread, trouble)


def _up_to_trouble(content: bytes) -> tuple[list[McapRecord], str]:
    """The records, and what ends them before their end."""
    stream = io.BytesIO(content)
    reader = StreamReader(stream, validate_crcs=True, record_size_limit=None)
    records: list[McapRecord] = []
    try:
        for record in reader.records:
            records.append(record)  # noqa: PERF402  (what was read before an exception is kept)
    except Exception:  # nobody knows what parsers and decompressors raise on arbitrary bytes
        return records, "is unfinished" if stream.tell() == len(content) else "is damaged"
    return records, ""


def _object(data: bytes) -> dict[str, Any] | None:
    try:
        value = json.loads(data)
    except (ValueError, RecursionError):
        return None
    return value if isinstance(value, dict) else None
