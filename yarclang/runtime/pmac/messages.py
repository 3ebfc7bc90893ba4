"""Requests over Ethernet, and the events that they cause."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from yarclang.runtime.actions import Closed, Late, Violation


@dataclass(frozen=True, slots=True)
class Ask:
    """Execute a line and get its reply (GETRESPONSE). Answered by `Answer` or `Busy`."""

    line: str


@dataclass(frozen=True, slots=True)
class AskControl:
    """Execute ^B ^C ^F ^G ^P or ^V and get its reply (CTRL_RESPONSE). Answered by `Answer`."""

    character: str


@dataclass(frozen=True, slots=True)
class Control:
    """Execute a control character such as ^A (SENDCTRLCHAR). Answered by `Taken`."""

    character: str


@dataclass(frozen=True, slots=True)
class Write:
    """Send lines (WRITEBUFFER). The controller executes them up to the first error. Answered by `Written`.
    `yarclang.runtime.pmac.packets.fitting` returns how many lines fit into one `Write`.
    """

    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Send:
    """Execute a line, whose reply the controller keeps until `Fetch` (SENDLINE). Answered by `Taken`."""

    line: str


@dataclass(frozen=True, slots=True)
class Fetch:
    """Get the waiting reply (GETBUFFER). Answered by `Answer`, or by `Busy` if none waits."""


@dataclass(frozen=True, slots=True)
class IsReady:
    """Ask if a reply waits (READREADY). Answered by `Ready`."""


@dataclass(frozen=True, slots=True)
class Flush:
    """Discard replies that wait at the controller (FLUSH). Answered by `Taken`."""


@dataclass(frozen=True, slots=True)
class ReadMemory:
    """Read `size` bytes of the dual-ported memory from `offset` on (GETMEM). Answered by `Memory`."""

    offset: int
    size: int


@dataclass(frozen=True, slots=True)
class WriteMemory:
    """Write bytes into the dual-ported memory from `offset` on (SETMEM). Answered by `Taken`."""

    offset: int
    data: bytes


Request: TypeAlias = (
    Ask | AskControl | Control | Write | Send | Fetch | IsReady | Flush | ReadMemory | WriteMemory
)


@dataclass(frozen=True, slots=True)
class Answer:
    """A reply: its items, and the number of the error that ended it (pmac-facts 5.2), or None."""

    request: Ask | AskControl | Fetch
    items: tuple[str, ...]
    error: int | None = None


@dataclass(frozen=True, slots=True)
class Busy:
    """The controller has sent a single NUL instead of a reply: it is busy (for example with SAVE), or has no
    reply waiting.
    """

    request: Request


@dataclass(frozen=True, slots=True)
class Written:
    """Answer to `Write`: the controller has accepted all lines, or only the lines before `line`.

    Attributes:
        request: the request.
        error: number of the error for which `line` was refused; None if all lines were accepted.
        line: the controller's number of the refused line. It isn't known if a real controller begins with 0
            or 1; the simulator begins with 1.
    """

    request: Write
    error: int | None = None
    line: int | None = None


@dataclass(frozen=True, slots=True)
class Taken:
    """The controller has received the request; the byte of the answer has no other meaning."""

    request: Control | Send | Flush | WriteMemory


@dataclass(frozen=True, slots=True)
class Ready:
    """Answer to `IsReady`."""

    request: IsReady
    waiting: bool


@dataclass(frozen=True, slots=True)
class Memory:
    """Bytes of the dual-ported memory."""

    request: ReadMemory
    data: bytes


Event: TypeAlias = Answer | Busy | Written | Taken | Ready | Memory | Late | Violation | Closed
