"""What a script of the runtime does and hears: it yields an action, and is sent what came of it. No I/O."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

from yarclang.robot.model import Array
from yarclang.runtime.job import Job


@dataclass(frozen=True, slots=True)
class Wait:
    """Do nothing until `until` [s]; an order from outside ends it at once. Answered by `None`."""

    until: float


@dataclass(frozen=True, slots=True)
class Connect:
    """Give the connection up, if there is one, and make a new one. Answered by `Connected` or `Unreachable`."""


@dataclass(frozen=True, slots=True)
class Connected:
    """There is a new connection."""


@dataclass(frozen=True, slots=True)
class Unreachable:
    """There isn't, and why."""

    reason: str


@dataclass(frozen=True, slots=True)
class Late:
    """No whole reply in time. The connection is lost."""

    request: object


@dataclass(frozen=True, slots=True)
class Violation:
    """What came can't be a reply to `request` (None: nothing was asked). The connection is lost."""

    request: object
    reason: str


@dataclass(frozen=True, slots=True)
class Closed:
    """The other end closed the connection; `request` had no whole reply and may have been executed."""

    request: object


@dataclass(frozen=True, slots=True)
class Keep:
    """Keep the value of a register from run to run. Answered by None when it is on the disk, or by why it can't be kept (str)."""

    register: str
    value: int


@dataclass(frozen=True, slots=True, eq=False)
class Replan:
    """Plan and prove anew what follows a motion that an input has ended. Answered by `Replanned`, or by why it can't be done (str).

    `begins` is when the motion begins [s of the program], and `joints` (n,) where the robot stands [rad or m].
    """

    begins: float
    joints: Array


@dataclass(frozen=True, slots=True, eq=False)
class Replanned:
    """What is streamed instead of the next legs, up to where their ends are known again, and how far the frame of a line has come [m]."""

    jobs: tuple[Job, ...]
    length: float


Action: TypeAlias = Any
"""`Wait`, `Connect`, `Keep`, `Replan`, or a request that the kind of controller has (`yarclang.runtime.scripts.Exchange`)."""
Outcome: TypeAlias = Any
"""`Connected`, `Unreachable`, None behind a wait, or what came of a request."""

T = TypeVar("T")
Script: TypeAlias = Generator[Action, Outcome, T]
"""A sequence of actions that gives a T in the end."""


class Lost(Exception):  # noqa: N818 - an event that scripts unwind for
    """The connection is of no use any more: late, closed, or something came that can't be a reply."""


class TooLate(Lost):
    """Lost because no whole reply came in time: the other end is slow, or stands still."""


class Trouble(Exception):  # noqa: N818 - an event that scripts unwind for
    """The run can't go on: what is the matter, and what to do about it; the code of the finding that it is, and the line of the
    job (from 0) that it is about, if it isn't about what is being executed.
    """

    def __init__(self, what: str, remedy: str = "", code: str = "Y1601", line: int | None = None) -> None:
        super().__init__(what)
        self.what = what
        self.remedy = remedy
        self.code = code
        self.line = line


class Found(Exception):  # noqa: N818 - an event that scripts unwind for
    """The input that ends a motion on its way is as it is searched for; the motion is held."""


class Stopped(Exception):  # noqa: N818 - an event that scripts unwind for
    """A person ends the run; `abort` without regard to the path."""

    def __init__(self, abort: bool) -> None:
        super().__init__("aborted" if abort else "stopped")
        self.abort = abort
