"""Handle the terminal of a run: signals and keys that give orders, and questions."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import sys
from collections.abc import Callable
from types import TracebackType
from typing import Any

import click

from yarclang.cli.screen import Screen
from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.events import BaseEvent, StateChanged
from yarclang.coordinator.picture import Picture
from yarclang.runtime.state import State

SILENT = 3.0
"""Time without a message from the coordinator after which the robot's state counts as unknown [s]."""

_ENDING = (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


def has_keys() -> bool:
    """Return True if standard input is a terminal."""
    return sys.stdin is not None and sys.stdin.isatty()


class Terminal:
    """Orders of the user during a run, given by signals and keys.

    Ctrl-C holds the first time and aborts the second time. Enter resumes after a hold. A termination
    (SIGTERM, SIGHUP or SIGQUIT) ends the run on the path.

    Args:
        screen: screen for output.
        give_up: function that is called on Ctrl-C or a termination while no job runs, and on a second Ctrl-C
            while there is no connection.

    Attributes:
        performing: True while a job runs. At other times there is no motion to hold.
        gave_up: True after the user gave up a robot that can't be reached.
    """

    def __init__(self, screen: Screen, give_up: Callable[[], object]) -> None:
        self.performing = False
        self.gave_up = False
        self._attached: Attached | None = None
        self._picture: Picture | None = None
        self._screen = screen
        self._give_up = give_up
        self._asked_to_hold = False
        self._asked_to_abort = False
        self._answer: asyncio.Future[str] | None = None
        self._keys = has_keys()

    def __enter__(self) -> Terminal:
        loop = asyncio.get_running_loop()
        loop.add_signal_handler(signal.SIGINT, self._interrupted)
        loop.add_signal_handler(signal.SIGTSTP, self._suspended)
        for number in _ENDING:
            loop.add_signal_handler(number, self._terminated)
        if self._keys:
            loop.add_reader(sys.stdin, self._typed)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        loop = asyncio.get_running_loop()
        if self._keys:
            loop.remove_reader(sys.stdin)
        for number in (signal.SIGINT, signal.SIGTSTP, *_ENDING):
            loop.remove_signal_handler(number)

    def serve(self, attached: Attached, picture: Picture) -> None:
        """Send the user's orders through a client from now on. `picture` has the state of the client's
        robot.
        """
        self._attached, self._picture = attached, picture

    async def agrees(self, question: str) -> bool:
        """Return True if the user agrees. Without a terminal, a question is a usage error."""
        if not self._keys:
            raise click.UsageError(f"{question} There is no terminal to ask on: give --yes")
        self._screen.ask(f"{question} [y/N]: ")
        self._answer = asyncio.get_running_loop().create_future()
        try:
            return (await self._answer).strip().lower() in ("y", "yes")
        finally:
            self._answer = None

    def hear(self, event: BaseEvent) -> None:
        """Process an event. After a resume, the next Ctrl-C holds again."""
        if isinstance(event, StateChanged) and event.state is State.MOVE:
            self._asked_to_hold = False

    @property
    def _state(self) -> State:
        if self._picture is None or self._attached is None or self._attached.silence > SILENT:
            return State.DISCONNECTED
        return self._picture.state

    def _order(self, order: orders.Order[Any]) -> None:
        if self._attached is not None:
            self._attached.send(order, lambda trouble: self._screen.say(trouble.what))

    def _interrupted(self) -> None:
        """Handle Ctrl-C."""
        state = self._state
        if not self.performing:
            self._give_up()
        elif state is State.DISCONNECTED:
            self._while_disconnected()
        elif state not in (State.MOVE, State.HOLD):
            self._order(orders.Stop())
        elif not self._asked_to_hold:
            self._asked_to_hold = True
            self._order(orders.Hold())
            self._screen.say(
                "holding: continue with Enter or `yarc resume`, end with `yarc stop`, abort with Ctrl-C"
            )
        else:
            self._order(orders.Abort())
            self._screen.say("aborting: each motor stops at once")

    def _while_disconnected(self) -> None:
        if not self._asked_to_abort:
            self._asked_to_abort = True
            self._order(orders.Abort())
            self._screen.say(
                "there is no connection; the abort is sent as soon as there is one. Press Ctrl-C again "
                "to give up"
            )
        else:
            self.gave_up = True
            self._give_up()

    def _suspended(self) -> None:
        """Handle Ctrl-Z: hold, because a suspended process can't supervise a robot."""
        state = self._state
        if self.performing and state in (State.MOVE, State.HOLD):
            self._order(orders.Hold())
            self._screen.say(
                "this process can't be suspended while it drives a robot: holding on the path instead"
            )
        else:
            self._screen.say("this process can't be suspended while it drives a robot; Ctrl-C ends it")

    def _terminated(self) -> None:
        if self.performing:
            self._order(orders.Stop())
        else:
            self._give_up()

    def _typed(self) -> None:
        """Handle a line, or the end of the terminal's input."""
        descriptor = sys.stdin.fileno()
        try:
            if os.tcgetpgrp(descriptor) != os.getpgrp():
                return  # another process is reading the terminal
            data = os.read(descriptor, 4096)
        except OSError:
            data = b""
        if not data and not os.isatty(descriptor):
            asyncio.get_running_loop().remove_reader(sys.stdin)
        if self._answer is not None:
            if not self._answer.done():
                self._answer.set_result(data.decode(errors="replace"))
        elif data and ((self._picture is not None and self._picture.paused) or self._state is State.HOLD):
            self._order(orders.Resume(value=_number_in(data)))


def _number_in(data: bytes) -> int | None:
    """Return the integer that the user typed; None for other text."""
    text = data.decode(errors="replace").strip()
    return int(text) if re.fullmatch(r"[+-]?[0-9]{1,9}", text) else None
