"""What all scripts of a run share: its clock, its state, its orders, what it tells, and how it asks. No I/O.

Whoever drives a script sets `now` before each step. Orders wait here until the script looks at them.
"""

from __future__ import annotations

import math
import re
from collections import deque

from yarclang.pmac.errors import ERRORS
from yarclang.runtime.actions import Lost, Script, TooLate, Trouble, Wait
from yarclang.runtime.feedback import MotorStatus
from yarclang.runtime.memory import Memory
from yarclang.runtime.messages import (
    Answer,
    Ask,
    AskControl,
    Busy,
    Closed,
    Control,
    Late,
    Taken,
    Violation,
    Write,
    Written,
)
from yarclang.runtime.notices import Abort, Changed, Fail, Hold, Notice, Order, Remark, Stop
from yarclang.runtime.state import Event, State, after

PATIENCE = 2.0
"""How long a controller may be busy with something else [s]."""

SILENCE = 0.4
"""For how long this computer may be silent, before its controller holds [s], until a look has found what the link allows."""

URGENT = (Hold, Stop, Abort, Fail)
"""Orders that don't wait for anything but the reply that is on its way."""

LONGEST_SLEEP = 10.0
"""A process that stood still for longer doesn't go on with a motion by itself [s]."""

POSITIONS_EACH = 0.04
"""Time between two looks at the positions [s]: 25 Hz, if nobody wants them more often."""

_AGAIN = 0.02
"""When a busy controller is asked again [s]."""

_ODD_REPLY = "somebody else may use this controller; run `yarc doctor`"

ABORT_ALL = "\x01"
HOLD_ALL = "\x0f"
CLOSE_ROTARY = "\x0c"


class Interrupted(Exception):  # noqa: N818 - an event that scripts unwind for
    """An order that can't wait has come: nothing was asked."""


class Refused(Trouble):
    """The controller refuses a line with ERR`number`."""

    def __init__(self, line: str, number: int) -> None:
        meaning = ERRORS.get(number, "an error that isn't documented")
        super().__init__(f"the controller refuses {line!r}: ERR{number:03d}, {meaning}", code="Y1603")
        self.text = line
        self.number = number


class Operation:
    """One run against one controller.

    Attributes:
        state: see `yarclang.runtime.state`.
        orders: what people want, oldest first.
        notices: what is to be told, oldest first; whoever tells it takes it away.
        watch: orders that interrupt a script at its next request, so that a stop never waits for more than one reply.
        patience: how long a controller may be busy [s].
        override: the pace that people want, 1 at 100 %; it stays from one job to the next.
        settled: no motor's rest before counts [s]: the time base may still be on its way to 0.
        longest_sleep: when the clock jumps by more [s], this process stood still.
        slept: by how much it has jumped then [s]; 0 once that was looked at.
        positions_each: time between two looks at the positions [s], if the link allows.
        memory: what the controller answered when it was looked at.
        silence: for how long this computer may be silent, before its controller holds [s].
        wanted_silence: that time, if a person has chosen it [s].
        slowest: the slowest reply since the last look began [s].
        latest: how long the last reply took [s].
        motors: the motors' words as they were heard last, in the robot's order.
        ahead: lines in the controller's buffer as they were counted last; None if nothing is streamed.
        beat: time between two beats of the guard PLC [s].
        outputs: the names of outputs, by their variables; those of others aren't known.
        searches: whether a motor searches its home: no hold stops it, only an abort.
        unattended: whether nobody is there who could resume a hold that no person has asked for: such a hold ends the run.
    """

    def __init__(self, now: float = 0.0) -> None:
        self._now = now
        self.longest_sleep = LONGEST_SLEEP
        self.slept = 0.0
        self.state = State.DISCONNECTED
        self.orders: deque[Order] = deque()
        self.notices: deque[Notice] = deque()
        self.watch: tuple[type[Order], ...] = ()
        self.patience = PATIENCE
        self.override = 1.0
        self.settled = -math.inf
        self.positions_each = POSITIONS_EACH
        self.memory = Memory()
        self.silence = SILENCE
        self.wanted_silence: float | None = None
        self.slowest = 0.0
        self.latest = 0.0
        self.motors: tuple[MotorStatus, ...] = ()
        self.ahead: int | None = None
        self.beat = 0.0
        self.outputs: dict[str, str] = {}
        self.searches = False
        self.unattended = False

    @property
    def now(self) -> float:
        """The host's clock [s]."""
        return self._now

    @now.setter
    def now(self, now: float) -> None:
        # between two steps of a script lies one reply, or a short wait
        if now - self._now > self.longest_sleep:
            self.slept = max(self.slept, now - self._now)
        self._now = now

    def go(self, event: Event, why: str = "", code: str = "", remedy: str = "") -> None:
        """Change the state as the table says, and tell it.

        Args:
            event: that changes it.
            why: in words.
            code: of the finding, if something went wrong.
            remedy: what to do then.
        """
        before, self.state = self.state, after(self.state, event)
        if self.state is not before or why:
            self.notices.append(Changed(self.now, self.state, why, code, remedy))

    def remark(self, text: str, *, warning: bool = False) -> None:
        """Tell something."""
        self.notices.append(Remark(self.now, text, warning))

    def ask(self, line: str) -> Script[tuple[str, ...]]:
        """The items of a reply; a busy controller is asked again.

        Raises:
            Interrupted: somebody has ordered what is watched for; the line isn't executed.
            Refused: the controller refuses the line.
            Trouble: it stays busy.
            Lost: the connection is of no use any more.
        """
        since = self.now
        while True:
            self._give_way()
            asked = self.now
            event = yield Ask(line)
            self.latest = self.now - asked
            self.slowest = max(self.slowest, self.latest)
            match event:
                case Answer(items=items, error=None):
                    return items
                case Answer(error=int(number)):
                    raise Refused(line, number)
                case Busy():
                    if self.now - since > self.patience:
                        raise Trouble(
                            f"the controller has been busy for {self.patience:g} s and doesn't answer {line!r}",
                            "wait for its SAVE or download to end, or look at what else uses it",
                        )
                    yield Wait(self.now + _AGAIN)
                case _:
                    raise _lost(event)

    def one(self, line: str) -> Script[str]:
        """The only item of a reply."""
        items = yield from self.ask(line)
        if len(items) != 1:
            raise Trouble(
                f"the controller answers {line!r} with {len(items)} values instead of one", _ODD_REPLY
            )
        return items[0]

    def numbers(self, line: str, count: int) -> Script[tuple[float, ...]]:
        """A reply of so many numbers; hexadecimal ones begin with $."""
        items = yield from self.ask(line)
        try:
            values = tuple(number_in(item) for item in items)
        except ValueError:
            values = ()
        if len(values) != count:
            raise Trouble(
                f"the controller answers {line!r} with {', '.join(items)!r} instead of {count} numbers",
                _ODD_REPLY,
            )
        return values

    def report(self, character: str) -> Script[str]:
        """The line that ^B, ^F or ^P gives."""
        self._give_way()
        event = yield AskControl(character)
        match event:
            case Answer(items=(text,)):
                return text
            case _:
                raise _lost(event)

    def control(self, character: str) -> Script[None]:
        """A control character without a reply."""
        event = yield Control(character)
        if not isinstance(event, Taken):
            raise _lost(event)

    def write(self, lines: tuple[str, ...]) -> Script[Written]:
        """Lines by WRITEBUFFER; the event says whether all are in."""
        self._give_way()
        event = yield Write(lines)
        if not isinstance(event, Written):
            raise _lost(event)
        return event

    # stops: they don't give way

    def hold(self, system: int, within: float) -> Script[None]:
        """H in a coordinate system: its time base goes to 0 on the path, `within` [s]. Where H isn't taken: all hold."""
        event = yield Ask(f"&{system}H")
        match event:
            case Answer(error=None):
                self.settled = self.now + within
            case Answer() | Busy():
                # control characters are taken at any time
                yield from self.hold_all(within)
            case _:
                raise _lost(event)

    def hold_all(self, within: float) -> Script[None]:
        """^O, or ^A if somebody wants an abort."""
        if Abort() in self.orders:
            yield from self.abort()
            return
        yield from self.control(HOLD_ALL)
        self.settled = self.now + within

    def abort(self) -> Script[None]:
        """^A: all motors, each by itself."""
        yield from self.control(ABORT_ALL)
        self.settled = -math.inf

    def _give_way(self) -> None:
        if any(isinstance(order, self.watch) for order in self.orders):
            raise Interrupted


_NUMBER = re.compile(r"\$[0-9A-Fa-f]+|[+-]?(?:\d+\.?\d*|\.\d+)")


def number_in(text: str) -> float:
    """A number as the controller writes it.

    Raises:
        ValueError: it is none.
    """
    if not _NUMBER.fullmatch(text):
        raise ValueError(f"{text!r} isn't a number")
    return float(int(text[1:], 16)) if text.startswith("$") else float(text)


def _lost(event: object) -> Lost:
    """Why the connection is of no use any more."""
    return TooLate(_reason(event)) if isinstance(event, Late) else Lost(_reason(event))


def _reason(event: object) -> str:
    match event:
        case Late(request=request):
            return f"no reply to {_named(request)} in time"
        case Violation(request=request, reason=reason):
            return f"{reason} (in reply to {_named(request)})" if request else reason
        case Closed():
            return "the controller has closed the connection"
        case _:
            return f"{event!r} is no reply"


def _named(request: object) -> str:
    match request:
        case Ask(line=line):
            return repr(line)
        case Write(lines=lines):
            return f"{len(lines)} program lines"
        case AskControl(character=character) | Control(character=character):
            return f"^{chr(ord(character) + 64)}"
        case _:
            return type(request).__name__
