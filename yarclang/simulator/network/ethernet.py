"""The controller's end of its Ethernet protocol, without a socket: bytes become packets, and packets get
replies.

The effects of packets follow pmac-facts 6. Where the manuals are silent, the simulator makes these
assumptions. Packets that arrive before the reply to an earlier packet are queued. An unknown code has no
reply. An impossible length ends the connection. The rest of a long reply waits for GETBUFFER and precedes
later replies; FLUSH discards it. The lines of a WRITEBUFFER are counted from 1.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import NamedTuple

from yarclang.pmac import requests as pmac
from yarclang.pmac.requests import Code
from yarclang.simulator.machine import Machine

_MOST_WAITING = 1 << 24
"""Largest number of bytes of replies that wait to be fetched. Further bytes are lost."""

_MEMORY = 1 << 14
"""Size of the dual-ported memory [bytes]."""

_FACTORY_ADDRESS = bytes((192, 6, 94, 5))
"""IP address of a new controller."""

_TOO_LONG = 3
"""ERR003: data error."""

_UNPACK = struct.Struct(pmac.HEADER).unpack_from


class Packet(NamedTuple):
    """One request of a client.

    Attributes:
        up: True if the client requests `length` bytes, False if it sends `data`.
        code: code of the request, such as GETRESPONSE.
        value: the field wValue.
        second: the field wIndex.
        length: number of bytes that are requested or sent.
        data: the bytes that are sent.
    """

    up: bool
    code: int
    value: int
    second: int
    length: int
    data: bytes


class PacketReader:
    """Cuts a stream of bytes into packets."""

    def __init__(self) -> None:
        self._in = bytearray()
        self.broken: str | None = None
        """Reason why the stream can't be read any further: an impossible header. None if the stream can be
        read.
        """

    def receive(self, data: bytes) -> list[Packet]:
        """Add received bytes. Return the packets that are now complete, in order. At most one incomplete
        packet is kept.
        """
        if self.broken is not None:
            return []
        if not self._in and len(data) >= pmac.HEADER_SIZE:
            direction, code, value, second, length = _UNPACK(data)
            if direction == pmac.DOWN and length == len(data) - pmac.HEADER_SIZE <= pmac.MOST_DATA:
                return [Packet(False, code, value, second, length, data[pmac.HEADER_SIZE :])]
        return self._cut(data)

    def _cut(self, data: bytes) -> list[Packet]:
        """Extract any number of packets from the bytes, which may end within a packet."""
        packets: list[Packet] = []
        buffer = self._in
        buffer += data
        at = 0
        while len(buffer) - at >= pmac.HEADER_SIZE:
            direction, code, value, second, length = _UNPACK(buffer, at)
            if direction not in (pmac.UP, pmac.DOWN) or (direction == pmac.DOWN and length > pmac.MOST_DATA):
                header = bytes(buffer[at : at + pmac.HEADER_SIZE])
                self.broken = f"{header.hex(' ')} isn't the header of a packet"
                buffer.clear()
                return packets
            behind = at + pmac.HEADER_SIZE + (length if direction == pmac.DOWN else 0)
            if behind > len(buffer):
                break
            body = bytes(buffer[at + pmac.HEADER_SIZE : behind])
            packets.append(Packet(direction == pmac.UP, code, value, second, length, body))
            at = behind
        del buffer[:at]
        return packets


class Station:
    """One client's connection to the simulated controller: the client's port, and replies that wait to be
    fetched.

    Args:
        machine: the controller.
        port: number of the controller's port that belongs to this client.
        memory: dual-ported memory, which all connections share. The controller's programs don't see it.
    """

    def __init__(self, machine: Machine, port: int, memory: bytearray | None = None) -> None:
        self._machine = machine
        self._port = port
        self._memory = memory if memory is not None else bytearray(_MEMORY)
        self._waiting = bytearray()
        self._state = bytes(4)
        self._lines = 0

    def answer(self, packet: Packet) -> bytes:
        """Execute the request of a packet and return the reply; empty if there is none."""
        work = _WORK.get((packet.up, packet.code))
        return work(self, packet) if work is not None else b""

    def take_lines(self) -> int:
        """Return the number of lines that WRITEBUFFER has brought since the last call."""
        lines, self._lines = self._lines, 0
        return lines

    def _get_response(self, packet: Packet) -> bytes:
        reply = self._machine.respond(_text(packet.data), self._port)
        if not self._waiting and len(reply) <= pmac.MOST_REPLY:
            return reply
        self._wait(reply)
        return self._next(pmac.MOST_REPLY)

    def _send_line(self, packet: Packet) -> bytes:
        self._wait(self._machine.respond(_text(packet.data), self._port))
        return b"\x00"

    def _get_line(self, packet: Packet) -> bytes:
        """Return waiting bytes of replies, up to and including the first CR. Without a CR, return all of
        them, such as an ACK.
        """
        self._listen()
        end = self._waiting.find(b"\r") + 1
        return self._next(min(packet.length or pmac.MOST_REPLY, end or pmac.MOST_REPLY)) or b"\x00"

    def _get_buffer(self, packet: Packet) -> bytes:
        self._listen()
        return self._next(min(packet.length or pmac.MOST_REPLY, pmac.MOST_REPLY)) or b"\x00"

    def _ready(self, packet: Packet) -> bytes:  # noqa: ARG002  (one signature for all codes)
        self._listen()
        return b"\x01\x00" if self._waiting else b"\x00\x00"

    def _flush(self, packet: Packet) -> bytes:  # noqa: ARG002
        self._waiting.clear()
        return bytes((pmac.FLUSHED,))

    def _send_control(self, packet: Packet) -> bytes:
        """Execute a control character. Its reply waits to be fetched; ^X discards waiting replies."""
        if packet.value & 0xFF == 0x18:
            self._waiting.clear()
        self._wait(self._controlled(packet))
        return b"\x00"

    def _control_response(self, packet: Packet) -> bytes:
        return self._controlled(packet)[: pmac.MOST_REPLY] or b"\x00"

    def _controlled(self, packet: Packet) -> bytes:
        """Return the reply to a control character. The reply has no ACK, as pmacAsynIPPort expects."""
        reply = self._machine.control(packet.value & 0xFF, self._port)
        return b"".join(item.encode("ascii", "replace") + b"\r" for item in reply.items)

    def _write_buffer(self, packet: Packet) -> bytes:
        """Execute the lines of a packet up to the first line that is refused (TUM 418). If the packet has too
        many bytes, no line is executed (assumed).
        """
        lines = packet.data.split(b"\0")
        if not lines[-1]:
            lines.pop()
        if len(packet.data) > pmac.MOST_LINES:
            return self._refuse(1, _TOO_LONG)
        for number, line in enumerate(lines, 1):
            error = self._machine.command(_text(line), self._port).error
            if error is not None:
                return self._refuse(number, error)
            self._lines += 1
        self._state = bytes(4)
        return self._state

    def _refuse(self, line: int, error: int) -> bytes:
        self._state = struct.pack("<HBB", line, error, pmac.ERROR_FLAG)
        return self._state

    def _write_error(self, packet: Packet) -> bytes:  # noqa: ARG002
        return self._state

    def _get_memory(self, packet: Packet) -> bytes:
        size = min(packet.length, pmac.MOST_REPLY)
        return bytes(self._memory[packet.value : packet.value + size]).ljust(size, b"\0")

    def _set_memory(self, packet: Packet) -> bytes:
        fitting = packet.data[: max(0, len(self._memory) - packet.value)]
        self._memory[packet.value : packet.value + len(fitting)] = fitting
        return b"\x00"

    def _acknowledge(self, packet: Packet) -> bytes:  # noqa: ARG002
        """Acknowledge a request that concerns hardware that the simulator doesn't have."""
        return b"\x00"

    def _address(self, packet: Packet) -> bytes:  # noqa: ARG002
        return _FACTORY_ADDRESS

    def _listen(self) -> None:
        """Collect the texts that programs have sent, and append them to the waiting replies."""
        for message in self._machine.messages(self._port):
            self._wait(message.encode("ascii", "replace") + b"\r")

    def _wait(self, reply: bytes) -> None:
        self._waiting += reply[: max(0, _MOST_WAITING - len(self._waiting))]

    def _next(self, most: int) -> bytes:
        part = bytes(self._waiting[:most])
        del self._waiting[:most]
        return part


_WORK: dict[tuple[bool, int], Callable[[Station, Packet], bytes]] = {
    (False, Code.GETRESPONSE): Station._get_response,
    (False, Code.SENDLINE): Station._send_line,
    (True, Code.GETLINE): Station._get_line,
    (True, Code.GETBUFFER): Station._get_buffer,
    (True, Code.READREADY): Station._ready,
    (False, Code.FLUSH): Station._flush,
    (False, Code.SENDCTRLCHAR): Station._send_control,
    (True, Code.CTRL_RESPONSE): Station._control_response,
    (False, Code.WRITEBUFFER): Station._write_buffer,
    (True, Code.WRITEERROR): Station._write_error,
    (True, Code.GETMEM): Station._get_memory,
    (False, Code.SETMEM): Station._set_memory,
    (False, Code.SETBIT): Station._acknowledge,
    (False, Code.SETBITS): Station._acknowledge,
    (False, Code.PORT): Station._acknowledge,
    (True, Code.PORT): Station._acknowledge,
    (True, Code.IPADDRESS): Station._address,
}


def _text(data: bytes) -> str:
    """Return a line as text, without the line end that some clients send. Bytes beyond ASCII are kept."""
    return data.rstrip(b"\r\n\0").decode("latin-1")
