"""Read the records of an MCAP file up to its end, or to the first invalid record."""

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
from yarclang.runtime.log_scene import SCENE_TOPICS

_LARGEST_CHUNK = 1 << 26
"""Largest size of an unpacked chunk of a log [bytes]. `yarc run` writes chunks of 1 MiB, which the last
message of a chunk may exceed.
"""
_LEAST_LEFT, _PACKED = 1 << 28, 40
"""Limit on the total size of all unpacked chunks of a log: a fixed number of bytes, plus a number for each
byte of the file. Logs are usually compressed to a tenth.
"""


@frozen(eq=False)
class Records:
    """Contents of a log (an MCAP file).

    Attributes:
        metadata: metadata by name.
        attachments: attachments by name.
        messages: topic and content, in the order of writing. Messages that aren't JSON objects, and messages
            for viewers of scenes, are left out.
        unread: number of messages that aren't JSON objects.
        trouble: reason why the file may have contained more; empty for a complete file.
    """

    metadata: dict[str, dict[str, str]]
    attachments: dict[str, bytes]
    messages: list[tuple[str, dict[str, Any]]]
    unread: int
    trouble: str


def read_records(content: bytes) -> Records | None:
    """Read a log (an MCAP file) as far as it is valid.

    Returns:
        None if the file doesn't begin like an MCAP file.
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
            case Message(channel_id=number) if topics.get(number) in SCENE_TOPICS:
                pass  # scenes repeat the content of other channels
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
    """Return the records, and the reason if they end before the file's end."""
    stream = io.BytesIO(content)
    reader = StreamReader(stream, emit_chunks=True, validate_crcs=True, record_size_limit=None)
    records: list[McapRecord] = []
    bytes_left = _LEAST_LEFT + _PACKED * len(content)
    try:
        for record in reader.records:
            if not isinstance(record, Chunk):
                records.append(record)
                continue
            chunk = _unpacked(record, min(_LARGEST_CHUNK, bytes_left))
            if chunk is None:
                return records, "is larger when it is unpacked than any log"
            bytes_left -= len(chunk.data)
            records += breakup_chunk(chunk, validate_crc=True)
    except Exception:  # parsers and decompressors may raise any exception on arbitrary bytes
        return records, "is unfinished" if stream.tell() == len(content) else "is damaged"
    return records, ""


def _unpacked(chunk: Chunk, most: int) -> Chunk | None:
    """Unpack a chunk of a log, without trusting the size that it claims.

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
