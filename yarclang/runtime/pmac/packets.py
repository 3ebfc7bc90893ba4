"""Conversion of requests to packets, and of replies with a fixed size to events."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from yarclang.pmac import requests as pmac
from yarclang.pmac.requests import Code
from yarclang.runtime.actions import Violation
from yarclang.runtime.pmac.messages import (
    Ask,
    AskControl,
    Control,
    Event,
    Fetch,
    Flush,
    IsReady,
    Memory,
    ReadMemory,
    Ready,
    Request,
    Send,
    Taken,
    Write,
    WriteMemory,
    Written,
)

_pack = struct.Struct(pmac.HEADER).pack


class ProtocolError(ValueError):
    """A request that can't be sent: a bug in the caller."""


def encode(request: Request) -> bytes:
    """Return the packet of a request as bytes.

    Raises:
        ProtocolError: a line or a packet is too long, or has characters that would end it early.
    """
    match request:
        case Ask(line):
            return _down(Code.GETRESPONSE, _line(line))
        case Send(line):
            return _down(Code.SENDLINE, _line(line))
        case Write(lines):
            data = b"".join(_line(line) + b"\0" for line in lines)
            if not 0 < len(data) <= pmac.MOST_LINES:
                raise ProtocolError(f"{len(data)} bytes of lines don't make a packet: 1 to {pmac.MOST_LINES}")
            return _down(Code.WRITEBUFFER, data)
        case AskControl(character):
            if len(character) != 1 or character not in pmac.ASKING_CONTROLS:
                raise ProtocolError(f"{character!r} has no reply")
            return _header(pmac.UP, Code.CTRL_RESPONSE, ord(character), 0, 0)
        case Control(character):
            if len(character) != 1 or not 0 < ord(character) < 0x20:
                raise ProtocolError(f"{character!r} isn't a control character")
            if character in pmac.ASKING_CONTROLS:
                raise ProtocolError(f"{character!r} has a reply, which would wait without an end: AskControl")
            return _header(pmac.DOWN, Code.SENDCTRLCHAR, ord(character), 0, 0)
        case Fetch():
            return _header(pmac.UP, Code.GETBUFFER, 0, 0, pmac.MOST_REPLY)
        case IsReady():
            return _header(pmac.UP, Code.READREADY, 0, 0, 2)
        case Flush():
            return _header(pmac.DOWN, Code.FLUSH, 0, 0, 0)
        case ReadMemory(offset, size):
            _in_memory(offset, size, pmac.MOST_REPLY)
            return _header(pmac.UP, Code.GETMEM, offset, 0, size)
        case WriteMemory(offset, data):
            _in_memory(offset, len(data), pmac.MOST_DATA)
            return _header(pmac.DOWN, Code.SETMEM, offset, 0, len(data)) + data


def fitting(lines: Sequence[str], first: int = 0, beside: Sequence[str] = ()) -> int:
    """Return how many of `lines`, from number `first` on, fit into one `Write` together with the lines
    `beside`.
    """
    size = sum(len(line) + 1 for line in beside)
    for count, line in enumerate(lines[first : first + pmac.MOST_LINES // 2]):
        size += len(line) + 1
        if size > pmac.MOST_LINES:
            return count
    return min(len(lines) - first, pmac.MOST_LINES // 2)


def _header(direction: int, code: Code, value: int, index: int, length: int) -> bytes:
    return _pack(direction, code, value, index, length)


def _down(code: Code, data: bytes) -> bytes:
    return _pack(pmac.DOWN, code, 0, 0, len(data)) + data


def _line(text: str) -> bytes:
    if not text or not text.isascii() or not text.isprintable():
        raise ProtocolError(f"{text!r} isn't a line: printable ASCII only")
    if len(text) > pmac.MOST_LINE:
        raise ProtocolError(f"a line of {len(text)} characters: at most {pmac.MOST_LINE}")
    return text.encode("ascii")


def _in_memory(offset: int, size: int, most: int) -> None:
    if not (0 < size <= most and 0 <= offset <= 0xFFFF):
        raise ProtocolError(f"{size} bytes from {offset} on don't make a packet: 1 to {most}")


def reply_size(request: Request) -> int:
    """Return the size of a reply [bytes], for requests that determine it."""
    match request:
        case Write():
            return 4
        case IsReady():
            return 2
        case ReadMemory(_, size):
            return size
        case _:
            return 1


def fixed_event(request: Request, data: bytes) -> Event:
    """Parse a reply of fixed size."""
    match request:
        case Write(lines):
            # Low byte first: the line's number in bytes 0 and 1, the error in byte 2, the flag in byte 3.
            line, error, flag = struct.unpack("<HBB", data)
            if data == bytes(4):
                return Written(request)
            if flag != pmac.ERROR_FLAG or not error or line > len(lines):
                return Violation(request, f"{data.hex(' ').upper()} isn't a state of lines")
            return Written(request, error, line)
        case IsReady():
            return Ready(request, data[0] != 0)
        case ReadMemory():
            return Memory(request, data)
        case Control() | Send() | Flush() | WriteMemory():
            return Taken(request)
        case _:
            raise AssertionError(request)
