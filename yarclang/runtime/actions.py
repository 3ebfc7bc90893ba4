"""Actions that a script of the runtime yields, and the outcomes that are sent back to the script. No I/O."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, TypeVar

from yarclang.robot.model import Array
from yarclang.runtime.job import Job


@dataclass(frozen=True, slots=True)
class Wait:
    """Do nothing until the time `until` [s]. An order from outside the script ends the wait at once. Answered
    by `None`.
    """

    until: float


@dataclass(frozen=True, slots=True)
class Connect:
    """Close the present connection to the controller, if there is one, and make a new one. Answered by
    `Connected` or `Unreachable`.
    """


@dataclass(frozen=True, slots=True)
class Connected:
    """Outcome of `Connect`: there is a new connection to the controller."""


@dataclass(frozen=True, slots=True)
class Unreachable:
    """Outcome of `Connect`: there is no connection to the controller; `reason` says why."""

    reason: str


@dataclass(frozen=True, slots=True)
class Late:
    """The controller has sent no complete reply in time. The connection is lost."""

    request: object


@dataclass(frozen=True, slots=True)
class Violation:
    """The received bytes can't be a reply to `request` (None if no request was waiting for its reply). The
    connection is lost.
    """

    request: object
    reason: str


@dataclass(frozen=True, slots=True)
class Closed:
    """The controller has closed the connection. `request` had no complete reply and may have been
    executed.
    """

    request: object


@dataclass(frozen=True, slots=True)
class Keep:
    """Store the value of a register of the program, so that later runs begin with it.

    Answered by None once the value is on the disk, or by the reason why it can't be stored (str).
    """

    register: str
    value: int


@dataclass(frozen=True, slots=True, eq=False)
class Teach:
    """Store the robot's present position for later runs, from its joint positions `joints` (n,) [rad or m].

    Answered by `Told` once the position is on the disk, or by the reason why it can't be stored (str).
    """

    teaches: Literal["joints", "pose"]
    name: str
    joints: Array


@dataclass(frozen=True, slots=True)
class Told:
    """The answer to `Teach`: the program line that declares the stored position."""

    line: str


@dataclass(frozen=True, slots=True, eq=False)
class Replan:
    """Plan and prove a part of the program again at run time.

    The part is either what follows a search (a motion that an input ends), or the lines of an OFFSET.
    Answered by `Replanned`, by the reason why planning fails (str), or by None if the program isn't known
    because only its controller text is executed.

    Attributes:
        begins: program time at which the search motion, or the first motion of the OFFSET, begins [s].
        joints: (n,) position of the robot [rad or m].
        values: values of the OFFSET's registers, one for each of `SHIFTS`; None after a search.
    """

    begins: float
    joints: Array
    values: tuple[int, ...] | None = None


PROGRAM_UNKNOWN = "what follows is known only from the program, and the text was run without it"
"""Reason to refuse an action that needs planning, if the program isn't known."""


@dataclass(frozen=True, slots=True, eq=False)
class Replanned:
    """The replanned jobs, and the distance covered by a search.

    The runtime streams `jobs` instead of the legs that come next. The last of these jobs ends where the end
    position no longer depends on the search or the OFFSET. `length` is the distance that the moving frame has
    covered from the start of the search to its end [m]; 0 for a joint motion and for an OFFSET.
    """

    jobs: tuple[Job, ...]
    length: float


Action: TypeAlias = Any
"""What a script may yield: `Wait`, `Connect`, `Keep`, `Teach`, `Replan`, or a request to this kind of
controller (`yarclang.runtime.scripts.Exchange`).
"""
Outcome: TypeAlias = Any
"""What a script receives: `Connected`, `Unreachable`, None after a wait, or the result of a request."""

T = TypeVar("T")
Script: TypeAlias = Generator[Action, Outcome, T]
"""A sequence of actions that returns a T in the end."""


class Lost(Exception):  # noqa: N818 - an event that scripts unwind for
    """The connection can no longer be used: a reply is late, the connection was closed, or bytes have arrived
    that can't be a reply.
    """


class TooLate(Lost):
    """The connection is lost because no complete reply came in time: the controller or the network is
    slow, or has stopped.
    """


class Trouble(Exception):  # noqa: N818 - an event that scripts unwind for
    """A fault after which the run can't continue.

    `what` is the fault in words, and `remedy` is what a person should do about it. `code` is the code of the
    finding. `line` is the number of the job's line (from 0) that has the fault, if it isn't the line that is
    being executed.
    """

    def __init__(self, what: str, remedy: str = "", code: str = "Y1601", line: int | None = None) -> None:
        super().__init__(what)
        self.what = what
        self.remedy = remedy
        self.code = code
        self.line = line


class Found(Exception):  # noqa: N818 - an event that scripts unwind for
    """Raised when an input that ends the motion early has its wanted value. The run then brings the robot to
    rest on the path.
    """


class Left(Exception):  # noqa: N818 - an event that scripts unwind for
    """Raised when a person resumes after an input has held the motion, and the robot is to retreat instead of
    continuing. `way` is the name of the SUB by which it retreats.
    """

    def __init__(self, way: str) -> None:
        super().__init__(way)
        self.way = way


class Stopped(Exception):  # noqa: N818 - an event that scripts unwind for
    """Raised when a person has ended the run. If `abort` is True, the motors stop at once, and may leave
    the path.
    """

    def __init__(self, abort: bool) -> None:
        super().__init__("aborted" if abort else "stopped")
        self.abort = abort
