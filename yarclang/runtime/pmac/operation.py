"""Questions and stops for a Turbo PMAC. No I/O."""

from __future__ import annotations

import math
import re

from yarclang.pmac.errors import ERRORS
from yarclang.runtime import operation
from yarclang.runtime.actions import Closed, Late, Lost, Script, TooLate, Trouble, Violation, Wait
from yarclang.runtime.notices import Abort
from yarclang.runtime.pmac.feedback import MotorStatus
from yarclang.runtime.pmac.memory import Memory
from yarclang.runtime.pmac.messages import Answer, Ask, AskControl, Busy, Control, Taken, Write, Written

PATIENCE = 2.0
"""Longest time that a controller may be busy with something else [s]."""

_AGAIN = 0.02
"""Pause before a question to a busy controller is repeated [s]."""

_ODD_REPLY = "another client may use this controller; run `yarc doctor`"

ABORT_ALL = "\x01"
HOLD_ALL = "\x0f"
CLOSE_ROTARY = "\x0c"


class Refused(Trouble):
    """The controller refuses a line with ERR`number`."""

    def __init__(self, line: str, number: int) -> None:
        meaning = ERRORS.get(number, "an error that isn't documented")
        super().__init__(f"the controller refuses {line!r}: ERR{number:03d}, {meaning}", code="Y1603")
        self.text = line
        self.number = number


class Operation(operation.Operation):
    """One run against a Turbo PMAC.

    Attributes:
        patience: longest time that the controller may be busy [s].
        settled: time before which a motor without desired velocity doesn't count as at rest [s]: a hold may
            still be bringing the time base to 0.
        memory: answers of the controller at inspection.
        motors: the motors' last status words, in the robot's order.
        beat: time between two heartbeats of the guard PLC [s].
    """

    motors: tuple[MotorStatus, ...]

    def __init__(self, now: float = 0.0) -> None:
        super().__init__(now)
        self.patience = PATIENCE
        self.settled = -math.inf
        self.memory = Memory()
        self.beat = 0.0

    def ask(self, line: str) -> Script[tuple[str, ...]]:
        """Send a line with questions or commands, and return the items of its reply. If the controller is
        busy, the line is sent again.

        Raises:
            Interrupted: an order in `watch` has come; the line isn't executed.
            Refused: the controller refuses the line.
            Trouble: the controller stays busy.
            Lost: the connection is no longer usable.
        """
        since = self.now
        while True:
            self.give_way()
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
                            f"the controller has been busy for {self.patience:g} s and doesn't answer "
                            f"{line!r}",
                            "wait for its SAVE or download to end, or find other clients of it",
                        )
                    yield Wait(self.now + _AGAIN)
                case _:
                    raise _lost(event)

    def one(self, line: str) -> Script[str]:
        """Return the only item of a reply."""
        items = yield from self.ask(line)
        if len(items) != 1:
            raise Trouble(
                f"the controller answers {line!r} with {len(items)} values instead of 1", _ODD_REPLY
            )
        return items[0]

    def numbers(self, line: str, count: int) -> Script[tuple[float, ...]]:
        """Return a reply of `count` numbers; hexadecimal ones begin with $."""
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
        """Return the line that ^B, ^F or ^P gives."""
        self.give_way()
        event = yield AskControl(character)
        match event:
            case Answer(items=(text,)):
                return text
            case _:
                raise _lost(event)

    def control(self, character: str) -> Script[None]:
        """Send a control character without a reply."""
        event = yield Control(character)
        if not isinstance(event, Taken):
            raise _lost(event)

    def write(self, lines: tuple[str, ...]) -> Script[Written]:
        """Write lines by WRITEBUFFER. The returned event says if the controller has accepted all of them."""
        self.give_way()
        event = yield Write(lines)
        if not isinstance(event, Written):
            raise _lost(event)
        return event

    # stops: they are sent even if an order in `watch` has come

    def hold(self, system: int, within: float) -> Script[None]:
        """Send H to a coordinate system, which stops the motion on the path by bringing its time base to 0.
        If the controller doesn't accept H, hold all coordinate systems.

        Args:
            system: number of the coordinate system.
            within: duration of the hold [s].
        """
        event = yield Ask(f"&{system}H")
        match event:
            case Answer(error=None):
                self.settled = self.now + within
            case Answer() | Busy():
                # The controller accepts control characters at any time.
                yield from self.hold_all(within)
            case _:
                raise _lost(event)

    def hold_all(self, within: float) -> Script[None]:
        """Send ^O, or ^A if someone has ordered an abort."""
        if Abort() in self.orders:
            yield from self.abort()
            return
        yield from self.control(HOLD_ALL)
        self.settled = self.now + within

    def abort(self) -> Script[None]:
        """Send ^A: abort all motors, each by itself."""
        yield from self.control(ABORT_ALL)
        self.settled = -math.inf


_NUMBER = re.compile(r"\$[0-9A-Fa-f]+|[+-]?(?:\d+\.?\d*|\.\d+)")


def number_in(text: str) -> float:
    """Parse a number in the controller's notation.

    Raises:
        ValueError: it is no number.
    """
    if not _NUMBER.fullmatch(text):
        raise ValueError(f"{text!r} isn't a number")
    return float(int(text[1:], 16)) if text.startswith("$") else float(text)


def _lost(event: object) -> Lost:
    """Return the reason why the connection is no longer usable."""
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
