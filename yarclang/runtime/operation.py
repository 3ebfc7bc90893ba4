"""State that all scripts of a run share, for any kind of controller: the run's clock, state, orders and
notices. No I/O.

The driver of a script sets `now` before each step. Orders wait here until the script handles them. The
questions that scripts ask are in the package of their kind of controller, beside this module.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Protocol

from yarclang.runtime.notices import (
    Abort,
    Changed,
    Fail,
    Hold,
    Notice,
    Order,
    Question,
    Remark,
    Stop,
    ValuesWanted,
    Wanted,
)
from yarclang.runtime.state import Event, State, after

SILENCE = 0.4
"""Longest silence of this computer before its controller holds the motion [s]. It applies until the
inspection has measured the connection.
"""

URGENT = (Hold, Stop, Abort, Fail)
"""Orders that are handled as soon as the awaited reply has come."""

LONGEST_SLEEP = 10.0
"""Longest suspension of this process after which a motion continues by itself [s]. After a longer one, the
motion is held until a person resumes it.
"""

WAKING = 1.0
"""Time after a long suspension in which orders to continue don't count [s]: they were given before or during
the suspension, when nobody could see their effect.
"""

UNATTENDED = "the robot was unattended meanwhile: inspect it, then continue with Enter or `yarc resume`"
"""Remark after a long suspension of this process."""

POSITIONS_EACH = 0.04
"""Time between two position queries [s]: 25 Hz, unless someone wants them more often."""


class Interrupted(Exception):  # noqa: N818 - an event that scripts unwind for
    """Raised instead of sending a request when an urgent order of a person has come."""


class MotorState(Protocol):
    """The state of a motor, as reported by its controller."""

    @property
    def closed_loop(self) -> bool:
        """Return True if the motor's loop is closed."""

    @property
    def homed(self) -> bool:
        """Return True if the motor's position is valid."""

    @property
    def trouble(self) -> str:
        """Return the reason why the motor can't move, in words; empty if it can."""

    @property
    def flags(self) -> tuple[str, ...]:
        """Return the motor's status flags, by their names in the manual."""


class Operation:
    """One run against one controller.

    Attributes:
        state: state of the run; see `yarclang.runtime.state`.
        orders: orders of people, oldest first.
        notices: notices to be sent, oldest first; the sender removes them.
        watch: kinds of orders that interrupt a script at its next request, so that a stop waits for at most
            one reply.
        override: requested override; 1 means 100 %. It applies to all later jobs, too.
        longest_sleep: a jump of the clock by more than this [s] means that this process was suspended.
        slept: size of such a jump [s]; 0 once it was handled.
        woke: time of the last such jump [s].
        positions_each: time between two position queries [s], if the connection is fast enough.
        silence: longest silence of this computer before its controller holds the motion [s].
        wanted_silence: value of `silence` that a person has chosen [s]; None if nobody has.
        slowest: duration of the slowest reply since the last inspection began [s].
        latest: duration of the last reply [s].
        motors: the motors' last reported states, in the robot's order.
        ahead: last count of lines in the controller's buffer; None if nothing is streamed.
        outputs: names of outputs, by their variables; only outputs with a name are listed.
        searches: True if a motor searches its home: no hold stops the search, only an abort.
        wants: values that the program accepts from other programs; None if it accepts none, or if they have
            come and aren't handled yet.
        asked_for: number of requests for values so far.
        unattended: True if nobody is there to resume the motion. A hold that no person has ordered then ends
            the run.
    """

    def __init__(self, now: float = 0.0) -> None:
        self._now = now
        self.longest_sleep = LONGEST_SLEEP
        self.slept = 0.0
        self.woke = -math.inf
        self.state = State.DISCONNECTED
        self.orders: deque[Order] = deque()
        self.notices: deque[Notice] = deque()
        self.watch: tuple[type[Order], ...] = ()
        self.override = 1.0
        self.positions_each = POSITIONS_EACH
        self.silence = SILENCE
        self.wanted_silence: float | None = None
        self.slowest = 0.0
        self.latest = 0.0
        self.motors: Sequence[MotorState] = ()
        self.ahead: int | None = None
        self.outputs: dict[str, str] = {}
        self.searches = False
        self.unattended = False
        self.wants: Wanted | None = None
        self.asked_for = 0

    @property
    def now(self) -> float:
        """Return the host's clock [s]."""
        return self._now

    @now.setter
    def now(self, now: float) -> None:
        # Between two steps of a script there is at most one reply or a short wait: after a larger jump of the
        # clock, this process must have been suspended.
        asleep, self._now = now - self._now, now
        if asleep > self.longest_sleep:
            self.sleep(asleep)

    def sleep(self, seconds: float) -> None:
        """Record that this process was suspended for a long time [s], until now."""
        self.slept, self.woke = max(self.slept, seconds), self._now

    def stay_awake(self) -> None:
        """Forget a suspension before the present script, while nothing was under way."""
        self.slept, self.woke = 0.0, -math.inf

    def ignores_resume(self) -> bool:
        """Return True, and report it, if an order to continue doesn't count, because it was given while this
        process was suspended.
        """
        if self._now - self.woke >= WAKING:
            return False
        self.remark(
            "an order to continue is ignored, because it was given while this process was suspended",
            warning=True,
        )
        return True

    def go(
        self, event: Event, reason: str = "", code: str = "", remedy: str = "", asks: Question | None = None
    ) -> None:
        """Change the state of the run according to the transition table, and report the new state.

        Args:
            event: the event that changes the state.
            reason: reason in words.
            code: code of the finding, if something went wrong.
            remedy: what a person should do, if something went wrong.
            asks: question to the operator.
        """
        before, self.state = self.state, after(self.state, event)
        if self.state is not before or reason:
            self.notices.append(Changed(self.now, self.state, reason, code, remedy, asks))

    def remark(self, text: str, *, warning: bool = False, begins_pass: bool = False) -> None:
        """Send a remark.

        Args:
            text: the remark.
            warning: True if someone should react.
            begins_pass: True if a loop repeats.
        """
        self.notices.append(Remark(self.now, text, warning, begins_pass))

    def want(self, wanted: Wanted | None) -> None:
        """Accept values from other programs from now on, or no longer (None)."""
        if wanted is not None or self.wants is not None:
            self.wants = wanted
            self.notices.append(ValuesWanted(self.now, wanted))

    def give_way(self) -> None:
        """Interrupt the script if a person has given an order of a kind in `watch`.

        Raises:
            Interrupted: there is such an order.
        """
        if any(isinstance(order, self.watch) for order in self.orders):
            raise Interrupted
