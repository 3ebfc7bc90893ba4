"""Actions that a script of the runtime yields, and the outcomes that the script receives. No I/O."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, TypeVar

from yarclang.robot.model import Array
from yarclang.runtime.job import Job


@dataclass(frozen=True, slots=True)
class Wait:
    """Do nothing until `until` [s]. An order from outside ends the wait at once. Answered by `None`."""

    until: float


@dataclass(frozen=True, slots=True)
class Connect:
    """Close the connection, if there is one, and make a new one. Answered by `Connected` or `Unreachable`."""


@dataclass(frozen=True, slots=True)
class Connected:
    """Outcome of `Connect`: there is a new connection."""


@dataclass(frozen=True, slots=True)
class Unreachable:
    """Outcome of `Connect`: there is no connection, and why."""

    reason: str


@dataclass(frozen=True, slots=True)
class Late:
    """No complete reply in time. The connection is lost."""

    request: object


@dataclass(frozen=True, slots=True)
class Violation:
    """The received bytes can't be a reply to `request` (None if no request was in flight). The connection
    is lost.
    """

    request: object
    reason: str


@dataclass(frozen=True, slots=True)
class Closed:
    """The other end closed the connection. `request` had no complete reply and may have been executed."""

    request: object


@dataclass(frozen=True, slots=True)
class Keep:
    """Store the value of a register, so that later runs begin with it.

    Answered by None once the value is on the disk, or by the reason why it can't be stored (str).
    """

    register: str
    value: int


@dataclass(frozen=True, slots=True, eq=False)
class Teach:
    """Store the robot's place for later runs: its joint positions `joints` (n,) [rad or m].

    Answered by `Told` once the place is on the disk, or by the reason why it can't be stored (str).
    """

    teaches: Literal["joints", "pose"]
    name: str
    joints: Array


@dataclass(frozen=True, slots=True)
class Told:
    """The line of a program that declares a stored place."""

    line: str


@dataclass(frozen=True, slots=True, eq=False)
class Replan:
    """Replan and prove the rest of the program after an input has ended a motion, or the lines of an OFFSET.

    Answered by `Replanned`, by the reason why it can't be done (str), or by None if the text runs without its
    program. `begins` is when the searching motion, or the first motion of the OFFSET, begins [s of the
    program]. `joints` (n,) is the robot's position [rad or m]. `values` are the values of the OFFSET's
    registers, one for each of `SHIFTS`; None after a search.
    """

    begins: float
    joints: Array
    values: tuple[int, ...] | None = None


PROGRAM_UNKNOWN = "only the program says what follows, and the text was run without it"
"""Reason to refuse an action that needs planning, if the program isn't known."""


@dataclass(frozen=True, slots=True, eq=False)
class Replanned:
    """The replanned lines, streamed instead of the next legs, and their displacement.

    `jobs` replace the next legs up to the first leg whose end doesn't depend on the search or the shift.
    `length` is the distance that the frame of the searching line has moved [m].
    """

    jobs: tuple[Job, ...]
    length: float


Action: TypeAlias = Any
"""`Wait`, `Connect`, `Keep`, `Teach`, `Replan`, or a request of the controller's kind
(`yarclang.runtime.scripts.Exchange`).
"""
Outcome: TypeAlias = Any
"""`Connected`, `Unreachable`, None after a wait, or the result of a request."""

T = TypeVar("T")
Script: TypeAlias = Generator[Action, Outcome, T]
"""A sequence of actions that returns a T in the end."""


class Lost(Exception):  # noqa: N818 - an event that scripts unwind for
    """The connection is no longer usable: a reply is late, the connection was closed, or it has delivered
    something that can't be a reply.
    """


class TooLate(Lost):
    """The connection is lost because no complete reply came in time: the other end is slow, or has
    stopped.
    """


class Trouble(Exception):  # noqa: N818 - an event that scripts unwind for
    """The run can't continue.

    `what` is wrong, and `remedy` is what to do about it. `code` is the code of the finding. `line` is the
    number of the job's line (from 0) that the fault concerns, if it isn't the line that is being executed.
    """

    def __init__(self, what: str, remedy: str = "", code: str = "Y1601", line: int | None = None) -> None:
        super().__init__(what)
        self.what = what
        self.remedy = remedy
        self.code = code
        self.line = line


class Found(Exception):  # noqa: N818 - an event that scripts unwind for
    """The input that ends a motion early has the wanted value, and the motion is held."""


class Left(Exception):  # noqa: N818 - an event that scripts unwind for
    """After an input has held the motion, a person has ordered the robot to leave: `way` names the program's
    way out.
    """

    def __init__(self, way: str) -> None:
        super().__init__(way)
        self.way = way


class Stopped(Exception):  # noqa: N818 - an event that scripts unwind for
    """A person has ended the run. If `abort` is True, the motors stop without regard to the path."""

    def __init__(self, abort: bool) -> None:
        super().__init__("aborted" if abort else "stopped")
        self.abort = abort
