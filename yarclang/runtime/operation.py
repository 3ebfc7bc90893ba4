"""What all scripts of a run share, whatever the controller: its clock, its state, its orders, what it tells. No I/O.

Whoever drives a script sets `now` before each step. Orders wait here until the script looks at them. How a controller is asked is in the rooms of its kind.
"""

from __future__ import annotations

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
"""For how long this computer may be silent, before its controller holds [s], until a look has found what the link allows."""

URGENT = (Hold, Stop, Abort, Fail)
"""Orders that don't wait for anything but the reply that is on its way."""

LONGEST_SLEEP = 10.0
"""A process that stood still for longer doesn't go on with a motion by itself [s]."""

POSITIONS_EACH = 0.04
"""Time between two looks at the positions [s]: 25 Hz, if nobody wants them more often."""


class Interrupted(Exception):  # noqa: N818 - an event that scripts unwind for
    """An order that can't wait has come: nothing was asked."""


class MotorState(Protocol):
    """A motor, as its controller has told of it."""

    @property
    def closed_loop(self) -> bool:
        """True if its loop is closed."""

    @property
    def homed(self) -> bool:
        """True if its position means something."""

    @property
    def trouble(self) -> str:
        """What keeps it from moving, in words; empty where nothing does."""

    @property
    def flags(self) -> tuple[str, ...]:
        """What the controller says of it, by the names that its manual has."""


class Operation:
    """One run against one controller.

    Attributes:
        state: see `yarclang.runtime.state`.
        orders: what people want, oldest first.
        notices: what is to be told, oldest first; whoever tells it takes it away.
        watch: orders that interrupt a script at its next request, so that a stop never waits for more than one reply.
        override: the pace that people want, 1 at 100 %; it stays from one job to the next.
        longest_sleep: when the clock jumps by more [s], this process stood still.
        slept: by how much it has jumped then [s]; 0 once that was looked at.
        positions_each: time between two looks at the positions [s], if the link allows.
        silence: for how long this computer may be silent, before its controller holds [s].
        wanted_silence: that time, if a person has chosen it [s].
        slowest: the slowest reply since the last look began [s].
        latest: how long the last reply took [s].
        motors: the motors as they were heard of last, in the robot's order.
        ahead: lines in the controller's buffer as they were counted last; None if nothing is streamed.
        outputs: the names of outputs, by their variables; those of others aren't known.
        searches: whether a motor searches its home: no hold stops it, only an abort.
        wants: values that the program takes from outside; None: none, or they were given and not looked at yet.
        asked_for: how often values were wanted.
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
        """The host's clock [s]."""
        return self._now

    @now.setter
    def now(self, now: float) -> None:
        # between two steps of a script lies one reply, or a short wait
        if now - self._now > self.longest_sleep:
            self.slept = max(self.slept, now - self._now)
        self._now = now

    def go(
        self, event: Event, why: str = "", code: str = "", remedy: str = "", asks: Question | None = None
    ) -> None:
        """Change the state as the table says, and tell it.

        Args:
            event: that changes it.
            why: in words.
            code: of the finding, if something went wrong.
            remedy: what to do then.
            asks: what the operator is asked for.
        """
        before, self.state = self.state, after(self.state, event)
        if self.state is not before or why:
            self.notices.append(Changed(self.now, self.state, why, code, remedy, asks))

    def remark(self, text: str, *, warning: bool = False, begins_pass: bool = False) -> None:
        """Tell something."""
        self.notices.append(Remark(self.now, text, warning, begins_pass))

    def want(self, wanted: Wanted | None) -> None:
        """Take values from outside from now on, or none any more."""
        if wanted is not None or self.wants is not None:
            self.wants = wanted
            self.notices.append(ValuesWanted(self.now, wanted))

    def give_way(self) -> None:
        """Let an order that is watched for come first.

        Raises:
            Interrupted: there is one.
        """
        if any(isinstance(order, self.watch) for order in self.orders):
            raise Interrupted
