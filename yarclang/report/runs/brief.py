"""Summarize a log from its beginning and its end only."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Iterator
from typing import Any

import zstandard

from yarclang.frozen import frozen
from yarclang.report.runs.kind import MAGIC
from yarclang.runtime.log_record import FORMAT, METADATA

ReadAt = Callable[[int, int], bytes]
"""Function that takes an offset and a number of bytes, and reads these bytes of a file; it returns fewer
bytes at the end of the file.
"""

_HEAD = 1 << 16
_MOST_INDEX = 1 << 23
"""Largest number of bytes that are read of a log's index. The index of a run of four hours has this size."""
_MOST_CHUNK, _MOST_UNPACKED = 1 << 21, 1 << 23
"""Largest size of a log's last chunk, packed and unpacked [bytes]. A chunk is written twice a second."""
_LONGEST = 300
"""Largest number of characters of a text in the summary."""
_FOOTER = struct.Struct("<BQQQI")
_CHANNEL, _MESSAGE, _STATISTICS, _CHUNK, _CHUNK_INDEX, _METADATA, _OFFSET = 4, 5, 0x0B, 6, 8, 0x0C, 0x0E


@frozen
class Brief:
    """Summary of a run, from its log.

    Attributes:
        program: name of the program for people.
        robot: name of the robot.
        controller: address of the controller.
        client: client that ordered the first motion; empty if unknown.
        version: version of yarclang that wrote the log.
        started: date and time in UTC, ISO 8601.
        is_known: False if this version can't read the log's format.
        is_whole: True if the log was closed; False if it is being written or was cut off.
        duration: time from the first message to the last [s]; None if unknown.
        well: True if the run came to its end; None if unknown.
        what: reason why it didn't end well.
        code: code of the finding with this reason.
    """

    program: str
    robot: str
    controller: str
    client: str
    version: str
    started: str
    is_known: bool
    is_whole: bool
    duration: float | None = None
    well: bool | None = None
    what: str = ""
    code: str = ""


def brief_of(read: ReadAt, size: int) -> Brief | None:
    """Return the summary of a run from its log; None if the file isn't the log of a run.

    Args:
        read: function that reads from the file.
        size: size of the file [bytes].
    """
    try:
        facts = _facts(read(0, _HEAD))
    except (struct.error, ValueError, IndexError):
        return None
    if facts is None:
        return None
    ends: dict[str, Any] = {}
    is_whole = False
    try:
        start, offsets = _footer(read, size)
        is_whole = True
        ends = _end(read, start, offsets, size)
    except (struct.error, ValueError, IndexError, KeyError, TypeError, RecursionError, zstandard.ZstdError):
        pass  # the log is cut off, is being written, or was forged
    text = {key: value[:_LONGEST] for key, value in facts.items()}
    return Brief(
        text.get("program", ""),
        text.get("robot", ""),
        text.get("controller", ""),
        text.get("client", ""),
        text.get("yarclang", ""),
        text.get("started", ""),
        facts.get("format") == FORMAT,
        is_whole,
        **ends,
    )


def _facts(head: bytes) -> dict[str, str] | None:
    if head[: len(MAGIC)] != MAGIC:
        return None
    for kind, content in _records(head[len(MAGIC) :]):
        if kind == _METADATA:
            name, at = _text(content, 0)
            if name == METADATA:
                return _texts(content, at)
        elif kind == _CHUNK:
            break
    return None


def _footer(read: ReadAt, size: int) -> tuple[int, int]:
    """Return the position of a log's summary in the file, and that of the summary's offset records [bytes].

    Raises:
        ValueError: the file has no valid footer.
    """
    length = _FOOTER.size + len(MAGIC)
    tail = read(max(0, size - length), length)
    kind, count, start, offsets, _ = _FOOTER.unpack(tail[: _FOOTER.size])
    if kind != 2 or count != 20 or tail[_FOOTER.size :] != MAGIC or not 0 < start <= offsets < size:
        raise ValueError("no footer")
    return start, offsets


def _end(read: ReadAt, start: int, offsets: int, size: int) -> dict[str, Any]:
    """Return the outcome of the run, and the duration of the log."""
    groups: dict[int, bytes] = {}
    for kind, content in _records(read(offsets, min(size - offsets, 4096))):
        if kind == _OFFSET:
            group, begins, length = struct.unpack_from("<BQQ", content)
            if start <= begins < size and length <= _MOST_INDEX:
                groups[group] = read(begins, length)
    ending: dict[str, Any] = {}
    for _, content in _records(groups.get(_STATISTICS, b"")):
        first, last = struct.unpack_from("<QQ", content, 26)
        ending["duration"] = max(0.0, (last - first) / 1e9)
    channels = {
        struct.unpack_from("<H", content)[0]
        for _, content in _records(groups.get(_CHANNEL, b""))
        if _text(content, 4)[0] == "/outcome"
    }
    chunks = [content for kind, content in _records(groups.get(_CHUNK_INDEX, b"")) if kind == _CHUNK_INDEX]
    for content in reversed(chunks[-3:]):
        begins, length = struct.unpack_from("<QQ", content, 16)
        if begins >= start or length > _MOST_CHUNK:
            continue
        for message in _messages(read(begins, length), channels):
            outcome = json.loads(message)
            ending["well"] = outcome["well"] is True
            ending["what"] = str(outcome["what"])[:_LONGEST]
            ending["code"] = str(outcome.get("code", ""))[:10]
        if "well" in ending:
            break
    return ending


def _messages(chunk: bytes, channels: set[int]) -> Iterator[bytes]:
    """Yield the messages of given channels in a chunk."""
    for kind, content in _records(chunk):
        if kind != _CHUNK:
            return
        compression, at = _text(content, 28)
        data = content[at + 8 :]
        if compression == "zstd":
            with zstandard.ZstdDecompressor().stream_reader(data) as stream:
                data = stream.read(_MOST_UNPACKED)
        for each, message in _records(data):
            if each == _MESSAGE and struct.unpack_from("<H", message)[0] in channels:
                yield message[22:]


def _records(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the complete records in a string of bytes: kind and content."""
    at = 0
    while at + 9 <= len(data):
        kind, length = struct.unpack_from("<BQ", data, at)
        if at + 9 + length > len(data):
            return
        yield kind, data[at + 9 : at + 9 + length]
        at += 9 + length


def _text(data: bytes, at: int) -> tuple[str, int]:
    """Read a string at an offset. Return the string, and the offset after it."""
    (length,) = struct.unpack_from("<I", data, at)
    ends = at + 4 + length
    if ends > len(data):
        raise ValueError("a text is cut off")
    return data[at + 4 : ends].decode("utf-8", "replace"), ends


def _texts(data: bytes, at: int) -> dict[str, str]:
    """Read a map from names to texts at an offset."""
    (length,) = struct.unpack_from("<I", data, at)
    at, ends = at + 4, min(len(data), at + 4 + length)
    found: dict[str, str] = {}
    while at < ends:
        name, at = _text(data, at)
        found[name], at = _text(data, at)
    return found
