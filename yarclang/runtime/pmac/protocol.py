"""The client's end of the controller's Ethernet protocol, without a socket and without a clock.

A `Connection` turns requests into bytes to send, and received bytes into events. One request waits for its
reply at a time. A reply that is longer than a packet is fetched by further requests. `outgoing()` returns
these requests, so send its bytes after each call. The controller must run with I3=2 and I6=1: ask `GREETING`
first.

A late reply doesn't identify its request. A connection on which a reply is missing, or whose bytes can't be a
reply, is therefore lost: open another one. `last_words` gives the bytes for a stop on a lost connection.
"""

from __future__ import annotations

import re
from typing import Final

from yarclang.pmac import requests as pmac
from yarclang.runtime.actions import Closed, Late, Violation
from yarclang.runtime.pmac.messages import (
    Answer,
    Ask,
    AskControl,
    Busy,
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
from yarclang.runtime.pmac.packets import ProtocolError, encode, fitting, fixed_event, reply_size

__all__ = [
    "GREETING",
    "MOST_TEXT",
    "Answer",
    "Ask",
    "AskControl",
    "Busy",
    "Connection",
    "Control",
    "Event",
    "Fetch",
    "Flush",
    "IsReady",
    "Memory",
    "ProtocolError",
    "ReadMemory",
    "Ready",
    "Request",
    "Send",
    "Taken",
    "Write",
    "WriteMemory",
    "Written",
    "encode",
    "fitting",
]

GREETING: Final = "I6=1 I3=2"
"""The first line to ask: it sets errors and replies to the format that this module reads."""

MOST_TEXT: Final = 1 << 24
"""Longest accepted reply [bytes]; a longer reply means that the connection is broken."""

_UNUSUAL = re.compile(rb"[^\r\x20-\x7e]")
_WHOLE = re.compile(rb"[\r\x20-\x7e]*\r\x06")
_ERROR = re.compile(rb"ERR([0-9]{3})")
_NEXT = encode(Fetch())


class Connection:
    """One TCP connection, seen from the client. Times are in seconds on any clock that only goes forward."""

    def __init__(self) -> None:
        self._request: Request | None = None
        self._deadline: float | None = None
        self._timeout = 0.0
        self._lost = False
        self._out = bytearray()
        self._in = bytearray()
        self._piece = 0
        self._first_piece = True
        self._bell = False
        self._left = False

    @property
    def in_flight(self) -> Request | None:
        """Return the request that has no reply yet."""
        return self._request

    @property
    def lost(self) -> bool:
        """Return True if nothing more can be asked on this connection."""
        return self._lost

    @property
    def deadline(self) -> float | None:
        """Return the time at which `check` is due [s]; None if no request waits for its reply."""
        return self._deadline

    def send(self, request: Request, now: float, timeout: float) -> bytes:
        """Begin a request.

        Args:
            request: request to send.
            now: the time [s].
            timeout: how long to wait for each packet of the reply [s].

        Returns:
            All bytes to send now.

        Raises:
            ProtocolError: another request waits for its reply, the reply to a `Send` still waits, the
                connection is lost, or the request can't be encoded.
        """
        if self._lost:
            raise ProtocolError("the connection is lost")
        if self._request is not None:
            raise ProtocolError(f"{type(self._request).__name__} is still in flight")
        if self._left and isinstance(request, Ask | Send):
            raise ProtocolError("the reply to Send may still wait and would come first: Fetch or Flush it")
        packet = encode(request)  # before any change of state: it may raise
        if isinstance(request, Send | Fetch | Flush):
            self._left = isinstance(request, Send)
        self._request, self._timeout, self._deadline = request, timeout, now + timeout
        self._in.clear()
        self._piece, self._first_piece, self._bell = 0, True, False
        return packet

    def outgoing(self) -> bytes:
        """Return the bytes to send now, including requests for the rest of a long reply. Each byte is
        returned once.
        """
        data = bytes(self._out)
        self._out.clear()
        return data

    def receive(self, data: bytes, now: float) -> tuple[Event, ...]:
        """Process received bytes, and return the events in them. Send `outgoing()` afterwards.

        Args:
            data: the bytes, however they are split.
            now: when they came [s].
        """
        if self._lost or not data:
            return ()
        request = self._request
        match request:
            case None:
                return (self._violated("unexpected bytes"),)
            case Ask() | Fetch():
                return self._text(request, data, now)
            case AskControl():
                return self._control_text(request, data)
            case _:
                return self._fixed(request, data)

    def check(self, now: float) -> tuple[Event, ...]:
        """Return `Late` if the deadline has passed at the time `now` [s]."""
        if self._deadline is None or now < self._deadline or self._request is None:
            return ()
        request = self._request
        self._lose()
        return (Late(request),)

    def close(self) -> tuple[Event, ...]:
        """Record that the other end has closed the connection."""
        if self._lost:
            return ()
        request = self._request
        self._lose()
        return (Closed(request),)

    def last_words(self, character: str) -> bytes:
        """Return the bytes that send a control character before the connection is closed, even if a request
        waits for its reply.

        Used for a stop while a reply is missing. Any bytes of that reply are then ignored.
        """
        packet = bytes(self._out) + encode(Control(character))
        self._lose()
        return packet

    def _text(self, request: Ask | Fetch, data: bytes, now: float) -> tuple[Event, ...]:
        """Parse the text of a reply up to ACK, or up to CR after BEL. If a packet is full and has no end,
        more packets follow.
        """
        if self._first_piece and not self._piece and len(data) <= pmac.MOST_REPLY and _WHOLE.fullmatch(data):
            return self._finish(Answer(request, tuple(data[:-2].decode("ascii").split("\r"))), b"")
        # All other replies: several packets, errors, NUL, or violations. `at` is the next byte to look at;
        # `_piece` counts the bytes of the current packet.
        at = 0
        while at < len(data):
            part = data[at : at + pmac.MOST_REPLY - self._piece]
            end = part.find(b"\r") if self._bell else -1
            unusual = _UNUSUAL.search(part)
            if unusual is not None and (end < 0 or unusual.start() < end):
                end = unusual.start()
            if end < 0:
                self._in += part
                at, self._piece = at + len(part), self._piece + len(part)
                if self._piece == pmac.MOST_REPLY and not self._fetch_more(now):
                    return (self._violated("a reply that doesn't end"),)
                continue
            self._in += part[:end]
            rest, byte = data[at + end + 1 :], part[end]
            # BEL begins an error, whose number ends with CR.
            if byte == pmac.BEL and not self._bell:
                self._in.append(byte)
                self._bell, at, self._piece = True, at + end + 1, self._piece + end + 1
                if self._piece == pmac.MOST_REPLY and not self._fetch_more(now):
                    return (self._violated("a reply that doesn't end"),)
                continue
            if byte == pmac.CR:
                return self._finish(self._refusal(request), rest)
            if byte == pmac.ACK and not self._bell:
                return self._finish(self._answer(request), rest)
            if byte == pmac.NUL and self._first_piece and not self._in:
                return self._finish(Busy(request), rest)
            if byte == 0x0A:
                return (self._violated("a line feed: the controller isn't at I3=2 (was it reset?)"),)
            return (self._violated(f"byte {byte:02X} in a text"),)
        return ()

    def _fetch_more(self, now: float) -> bool:
        """Ask for the next packet after a full one, unless the reply is longer than `MOST_TEXT`."""
        self._out += _NEXT
        self._piece, self._first_piece = 0, False
        self._deadline = now + self._timeout
        return len(self._in) <= MOST_TEXT

    def _answer(self, request: Ask | Fetch) -> Event:
        text = self._in.decode("ascii")
        if text and not text.endswith("\r"):
            return Violation(request, "a reply without its last CR")
        return Answer(request, tuple(text.split("\r")[:-1]))

    def _refusal(self, request: Ask | Fetch) -> Event:
        before, _, after = bytes(self._in).partition(b"\x07")
        number = _ERROR.fullmatch(after)
        if number is None or (before and not before.endswith(b"\r")):
            return Violation(request, "an error without its number")
        return Answer(request, tuple(before.decode("ascii").split("\r")[:-1]), int(number[1]))

    def _control_text(self, request: AskControl, data: bytes) -> tuple[Event, ...]:
        """Parse one line: replies to control characters end with CR and have no ACK."""
        end = data.find(b"\r")
        self._in += data if end < 0 else data[:end]
        if len(self._in) > pmac.MOST_REPLY or _UNUSUAL.search(self._in):
            return (self._violated("not the reply of a control character"),)
        if end < 0:
            return ()
        return self._finish(Answer(request, (self._in.decode("ascii"),)), data[end + 1 :])

    def _fixed(self, request: Request, data: bytes) -> tuple[Event, ...]:
        """Parse a reply whose size the request determines."""
        wanted = reply_size(request) - len(self._in)
        self._in += data[:wanted]
        if len(data) < wanted:
            return ()
        return self._finish(fixed_event(request, bytes(self._in)), data[wanted:])

    def _finish(self, event: Event, rest: bytes) -> tuple[Event, ...]:
        self._request = self._deadline = None
        self._in.clear()
        if isinstance(event, Violation):
            self._lose()
            return (event,)
        return (event, self._violated("unexpected bytes")) if rest else (event,)

    def _violated(self, reason: str) -> Violation:
        violation = Violation(self._request, reason)
        self._lose()
        return violation

    def _lose(self) -> None:
        self._request = self._deadline = None
        self._lost = True
        self._in.clear()
        self._out.clear()
