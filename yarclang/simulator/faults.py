"""Faults of the controller and of its connection that are injected on purpose, and their notation.

    drop@12.5            close all connections after 12.5 s of the machine's time
    freeze@3:2           answer nothing from 3 s on, for 2 s (without :2 for ever)
    slow:0.02            each reply 0.02 s late; slow@3:0.005-0.02 from 3 s on, by 0.005 to 0.02 s at random
    garble:0.001         one reply of 1000 has a wrong byte; also garble@3:0.001
    busy@4:1             answer lines (GETRESPONSE) with a NUL and don't execute them, for 1 s
    reset@7              reset as by $$$
    following@5:3        motor 3 is 100000 counts from its commanded position; following@5:3,2500: 2500 counts
    limit@5:2+           the positive limit switch of motor 2 is on; limit@5:2- the negative one
    amplifier@6:1        the amplifier of motor 1 fails

Times are in the machine's time, counted from its start. Instead of a time, @line120 means after 120 program
lines have been written to the machine (WRITEBUFFER), when the packet with the last of them arrives. A switch
stays on and an amplifier stays bad until $$$; closing the loop of a motor (J/, A) ends its following error.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from yarclang.simulator.machine import Machine

MOTORS = 32
"""Number of motors of a Turbo PMAC."""

HELD_BACK = 100_000.0
"""Distance by which the fault `following` displaces a motor [counts]: well beyond any sensible error
limit.
"""

Kind: TypeAlias = Literal[
    "drop", "freeze", "slow", "garble", "busy", "reset", "following", "limit", "amplifier"
]


@dataclass(frozen=True, slots=True)
class When:
    """Start of a fault: a time, or a number of program lines. If both are None, the fault starts at once.

    Attributes:
        seconds: the machine's time at which it starts [s].
        lines: number of written program lines after which it starts.
    """

    seconds: float | None = None
    lines: int | None = None

    def is_due(self, now: float, lines: int) -> bool:
        """Return True if the fault is due at a time [s], after a number of written lines."""
        if self.lines is not None:
            return lines >= self.lines
        return self.seconds is None or now >= self.seconds


@dataclass(frozen=True, slots=True)
class Fault:
    """One injected fault. Attributes that don't apply to its kind have no effect.

    Attributes:
        kind: name of the fault, as in the notation.
        when: start of the fault.
        seconds: duration (freeze, busy) or least delay of a reply (slow) [s].
        most: largest delay of a reply (slow) [s].
        share: share of the replies that get a wrong byte (garble).
        motor: number of the motor (following, limit, amplifier).
        side: +1 or -1, the limit switch of the motor (limit).
        counts: distance of the motor from its commanded position (following) [counts].
        text: the fault as it was written.
    """

    kind: Kind
    when: When
    seconds: float = math.inf
    most: float = 0.0
    share: float = 0.0
    motor: int = 0
    side: int = 0
    counts: float = 0.0
    text: str = field(default="", compare=False)


_SHAPE = re.compile(r"(?P<kind>[a-z]+)(?:@(?:line(?P<lines>\d{1,9})|(?P<seconds>[^:]+)))?(?::(?P<rest>.+))?")
_SIDES = {"+": 1, "-": -1}


def parse_fault(text: str) -> Fault:
    """Parse the notation of a fault, such as `drop@12.5`.

    Raises:
        ValueError: the text isn't a fault; the message says why.
    """
    shape = _SHAPE.fullmatch(text.strip().lower())
    if shape is None:
        raise ValueError(f"{text!r} isn't a fault: KIND@SECONDS:VALUE, such as freeze@3:2")
    kind, rest = shape["kind"], shape["rest"]
    if kind not in _READERS:
        raise ValueError(f"{text!r}: there is no fault {kind!r}; there are {', '.join(_READERS)}")
    condition = When(
        None if shape["seconds"] is None else _number(text, shape["seconds"]),
        None if shape["lines"] is None else int(shape["lines"]),
    )
    needs_time, form, values = _READERS[kind]
    if needs_time and condition == When():
        raise ValueError(f"{text!r} must say when it happens: {kind}@SECONDS or {kind}@lineNUMBER")
    found = values.fullmatch(rest or "")
    if found is None:
        raise ValueError(f"{text!r}: it is written {form}")
    return _fault(text, kind, condition, found.groupdict())


_NUMBER = r"[0-9]*\.?[0-9]+"
_NOTHING = re.compile("")
_DURATION = re.compile(f"(?P<seconds>{_NUMBER})?")
_DELAY = re.compile(f"(?P<seconds>{_NUMBER})(?:-(?P<most>{_NUMBER}))?")
_SHARE = re.compile(f"(?P<share>{_NUMBER})")
_MOTOR = re.compile(r"(?P<motor>\d{1,2})")
_HELD = re.compile(f"(?P<motor>\\d{{1,2}})(?:,(?P<counts>-?{_NUMBER}))?")
_SWITCH = re.compile(r"(?P<motor>\d{1,2})(?P<side>[+-])")

_READERS: dict[str, tuple[bool, str, re.Pattern[str]]] = {
    "drop": (True, "drop@SECONDS", _NOTHING),
    "freeze": (True, "freeze@SECONDS or freeze@SECONDS:DURATION", _DURATION),
    "slow": (False, "slow:DELAY or slow:LEAST-MOST, also slow@SECONDS:DELAY", _DELAY),
    "garble": (False, "garble:SHARE, also garble@SECONDS:SHARE", _SHARE),
    "busy": (True, "busy@SECONDS or busy@SECONDS:DURATION", _DURATION),
    "reset": (True, "reset@SECONDS", _NOTHING),
    "following": (True, "following@SECONDS:MOTOR or following@SECONDS:MOTOR,COUNTS", _HELD),
    "limit": (True, "limit@SECONDS:MOTOR+ or limit@SECONDS:MOTOR-", _SWITCH),
    "amplifier": (True, "amplifier@SECONDS:MOTOR", _MOTOR),
}


class Troubles:
    """The faults of one session. This object advances the simulated controller's time, injects faults when
    they are due, and delays or garbles replies.

    Args:
        machine: the controller.
        faults: the faults to inject.
        seed: equal seeds give equal delays and equal wrong bytes.
        tell: function that is called with a line of text for each fault that begins.
    """

    def __init__(
        self,
        machine: Machine,
        faults: Iterable[Fault] = (),
        seed: int = 0,
        tell: Callable[[str], None] | None = None,
    ) -> None:
        self._machine = machine
        self._tell = tell
        self._ahead = list(faults)
        self.any = bool(self._ahead)
        """True if there are any faults."""
        self._begun: list[tuple[Fault, float]] = []
        self._drops = 0
        self._lines = 0
        self._state = (seed * 2 + 1) & _WORD
        self._begin_due()

    @property
    def now(self) -> float:
        """Virtual time of the machine [s]."""
        return self._machine.now

    def advance(self, seconds: float) -> None:
        """Advance the controller's time [s]. Faults that become due in this interval begin at their exact
        times.
        """
        end = self.now + seconds
        while self._ahead:
            times = [fault.when.seconds for fault in self._ahead if fault.when.seconds is not None]
            stop = min((time for time in times if time < end), default=None)
            if stop is None:
                break
            if stop > self.now:
                self._machine.advance(stop - self.now)
            self._begin_due(stop)
        if end > self.now:
            self._machine.advance(end - self.now)
        if self._ahead:
            self._begin_due()

    def lines_written(self, lines: int) -> None:
        """Count program lines that were written to the machine."""
        self._lines += lines
        if lines and self._ahead:
            self._begin_due()

    def dropped(self) -> bool:
        """Return True if connections are to be closed now. Each drop is reported once."""
        drops, self._drops = self._drops, 0
        return drops > 0

    @property
    def frozen(self) -> bool:
        """True if a fault keeps the controller from answering anything now."""
        return any(self._lasts("freeze"))

    @property
    def busy(self) -> bool:
        """True if the machine now answers lines with a NUL and doesn't execute them."""
        return any(self._lasts("busy"))

    def spoil(self, reply: bytes) -> tuple[bytes, float]:
        """Garble a reply if a fault requires it. Return its bytes, and the delay with which it is sent
        [s].
        """
        if not self._begun or not reply:
            return reply, 0.0
        delay = 0.0
        for fault, _ in self._begun:
            if fault.kind == "garble" and self._random() < fault.share:
                place = int(self._random() * len(reply))
                wrong = reply[place] ^ (1 + int(self._random() * 255))
                reply = reply[:place] + bytes((wrong,)) + reply[place + 1 :]
            elif fault.kind == "slow":
                delay += fault.seconds + self._random() * max(0.0, fault.most - fault.seconds)
        return reply, delay

    def _lasts(self, kind: Kind) -> Iterable[bool]:
        return (self.now < since + fault.seconds for fault, since in self._begun if fault.kind == kind)

    def _begin_due(self, now: float | None = None) -> None:
        """Begin the faults that are due.

        `now` [s] is the exact time; the machine's own time may be slightly less by rounding.
        """
        now = self.now if now is None else max(now, self.now)
        due = [fault for fault in self._ahead if fault.when.is_due(now, self._lines)]
        self._ahead = [fault for fault in self._ahead if fault not in due]
        for fault in due:
            self._begin(fault)

    def _begin(self, fault: Fault) -> None:
        machine = self._machine
        if self._tell is not None:
            self._tell(f"fault {fault.text}")
        match fault.kind:
            case "drop":
                self._drops += 1
            case "reset":
                machine.reset()
            case "following":
                machine.disturb(fault.motor, fault.counts)
            case "limit":
                machine.set_limit_switch(fault.motor, fault.side, True)
            case "amplifier":
                machine.fault_amplifier(fault.motor)
            case _:
                self._begun.append((fault, self.now))

    def _random(self) -> float:
        """Return a random number in [0, 1).

        The linear congruential generator (Knuth's MMIX) gives the same numbers with every version of Python
        and its libraries.
        """
        self._state = (self._state * 6364136223846793005 + 1442695040888963407) & _WORD
        return (self._state >> 11) / (1 << 53)


_WORD = (1 << 64) - 1


def _number(text: str, digits: str) -> float:
    if re.fullmatch(_NUMBER, digits) is None:
        raise ValueError(f"{text!r}: {digits!r} isn't a number of seconds, and not line and a number")
    return float(digits)


def _fault(text: str, kind: str, condition: When, values: dict[str, str | None]) -> Fault:
    motor = int(values.get("motor") or 0)
    if "motor" in values and not 1 <= motor <= MOTORS:
        raise ValueError(f"{text!r}: motors are 1 to {MOTORS}")
    share = float(values.get("share") or 0.0)
    if share > 1.0:
        raise ValueError(f"{text!r}: the share of replies is 0 to 1")
    seconds = float(values.get("seconds") or math.inf)
    most = float(values.get("most") or 0.0)
    if most and most < seconds:
        raise ValueError(f"{text!r}: the larger delay comes second")
    return Fault(
        kind,  # type: ignore[arg-type]  # _READERS has only kinds
        condition,
        seconds=seconds,
        most=most,
        share=share,
        motor=motor,
        side=_SIDES.get(values.get("side") or "", 0),
        counts=float(values.get("counts") or HELD_BACK) if kind == "following" else 0.0,
        text=text.strip(),
    )
