"""What a client asks over Ethernet, and what comes of it."""

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
    """Execute lines up to the first error (WRITEBUFFER). Answered by `Written`. `fitting` says how many fit."""

    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Send:
    """Execute a line; its reply waits at the controller (SENDLINE). Answered by `Taken`."""

    line: str


@dataclass(frozen=True, slots=True)
class Fetch:
    """Get the reply that waits (GETBUFFER). Answered by `Answer`, or by `Busy` where none waits."""


@dataclass(frozen=True, slots=True)
class IsReady:
    """Does a reply wait (READREADY)? Answered by `Ready`."""


@dataclass(frozen=True, slots=True)
class Flush:
    """Forget what waits at the controller (FLUSH). Answered by `Taken`."""


@dataclass(frozen=True, slots=True)
class ReadMemory:
    """`size` bytes of the dual-ported memory from `offset` on (GETMEM). Answered by `Memory`."""

    offset: int
    size: int


@dataclass(frozen=True, slots=True)
class WriteMemory:
    """Bytes into the dual-ported memory from `offset` on (SETMEM). Answered by `Taken`."""

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
    """A single NUL instead of a reply: the controller is busy (it saves, say), or nothing was waiting."""

    request: Request


@dataclass(frozen=True, slots=True)
class Written:
    """All lines are in (`error` is None), or the lines before `line` are, and `line` is refused.

    `line` is as the controller counts; whether a real one begins with 0 or 1 isn't known. The simulator: 1.
    """

    request: Write
    error: int | None = None
    line: int | None = None


@dataclass(frozen=True, slots=True)
class Taken:
    """The controller has the request; the byte that says so means nothing more."""

    request: Control | Send | Flush | WriteMemory


@dataclass(frozen=True, slots=True)
class Ready:
    """Whether a reply waits."""

    request: IsReady
    waiting: bool


@dataclass(frozen=True, slots=True)
class Memory:
    """Bytes of the dual-ported memory."""

    request: ReadMemory
    data: bytes


Event: TypeAlias = Answer | Busy | Written | Taken | Ready | Memory | Late | Violation | Closed
