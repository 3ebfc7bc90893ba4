"""The records of an MCAP file up to where it ends, or stops making sense."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from typing import Any

import zstandard
from mcap.records import Attachment, Channel, Chunk, McapRecord, Message, Metadata
from mcap.stream_reader import StreamReader, breakup_chunk

from yarclang.frozen import frozen
from yarclang.report.runs.kind import MAGIC

_LARGEST_CHUNK = 1 << 26
"""Bytes that a chunk may have when it is unpacked; those of `yarc run` have 1 MiB and a message."""
_LEAST_LEFT, _PACKED = 1 << 28, 40
"""Bytes that all chunks may have together, and so many more for each byte of the file: logs are packed to a tenth."""


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
    reader = StreamReader(stream, emit_chunks=True, validate_crcs=True, record_size_limit=None)
    records: list[McapRecord] = []
    left = _LEAST_LEFT + _PACKED * len(content)
    try:
        for record in reader.records:
            if not isinstance(record, Chunk):
                records.append(record)
                continue
            chunk = _unpacked(record, min(_LARGEST_CHUNK, left))
            if chunk is None:
                return records, "is larger when it is unpacked than any log"
            left -= len(chunk.data)
            records += breakup_chunk(chunk, validate_crc=True)
    except Exception:  # nobody knows what parsers and decompressors raise on arbitrary bytes
        return records, "is unfinished" if stream.tell() == len(content) else "is damaged"
    return records, ""


def _unpacked(chunk: Chunk, most: int) -> Chunk | None:
    """Unpack a chunk, whatever size it says it has.

    Returns:
        None if it has more than `most` bytes.
    """
    data = chunk.data
    if chunk.compression == "zstd":
        with zstandard.ZstdDecompressor().stream_reader(data) as stream:
            data = stream.read(most + 1)
    elif chunk.compression:
        raise ValueError(f"compressed by {chunk.compression}")
    return replace(chunk, compression="", data=data) if len(data) <= most else None


def _object(data: bytes) -> dict[str, Any] | None:
    try:
        value = json.loads(data)
    except (ValueError, RecursionError):
        return None
    return value if isinstance(value, dict) else None
