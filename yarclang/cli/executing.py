"""`yarc exec` from the door's side: a program without a terminal, events as JSON lines, signals as orders."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Coroutine
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from yarclang.cli.address import Address
from yarclang.cli.controllers import SIMULATED_REPLY_TIME
from yarclang.cli.ending import Ending
from yarclang.coordinator import events
from yarclang.coordinator.client import Client
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.opened import opened
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.subscription import Subscription
from yarclang.diagnostics import Diagnostic
from yarclang.report.finding import finding_json
from yarclang.runtime.actions import Lost, Trouble
from yarclang.runtime.log import RunLog
from yarclang.runtime.outcome import Ended
from yarclang.runtime.session import REPLY_TIME

_LAST_WORDS = 5.0
"""A reader that takes longer for the last lines doesn't get them [s]."""


class Lines:
    """JSON lines on standard output, written by a thread of its own: a reader that is slow, or gone, delays no robot.

    Events that come while one is being written wait in their bounded stream, not here.
    """

    def __init__(self) -> None:
        self._since = time.monotonic()
        self._queue: SimpleQueue[tuple[str, Callable[[], object]] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._write, name="events", daemon=True)
        self._thread.start()

    async def put(self, content: dict[str, Any]) -> None:
        """Write a line, and wait until it is written."""
        loop = asyncio.get_running_loop()
        written = asyncio.Event()
        self._queue.put((self._line(content), lambda: loop.call_soon_threadsafe(written.set)))
        await written.wait()

    def say(self, content: dict[str, Any]) -> None:
        """Write a line some time."""
        self._queue.put((self._line(content), lambda: None))

    def close(self) -> None:
        """Write what is left, if somebody reads it."""
        self._queue.put(None)
        self._thread.join(_LAST_WORDS)

    def _line(self, content: dict[str, Any]) -> str:
        rest = {key: value for key, value in content.items() if key not in ("event", "time_s")}
        now = round(time.monotonic() - self._since, 4)
        return json.dumps({"event": content["event"], "time_s": now, **rest}) + "\n"

    def _write(self) -> None:
        gone = False
        while (item := self._queue.get()) is not None:
            text, written = item
            if not gone:
                try:
                    sys.stdout.write(text)
                    sys.stdout.flush()
                except (OSError, ValueError):
                    gone = True  # the run goes on without readers
            with contextlib.suppress(RuntimeError):  # the loop has ended
                written()
        if gone:
            with contextlib.suppress(OSError):  # nothing is left for the interpreter to flush
                os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def findings_line(found: tuple[Diagnostic, ...]) -> dict[str, Any]:
    """The event of a program's findings."""
    return {"event": "findings", "findings": [finding_json(one) for one in found]}


def refused_line(what: str, remedy: str, code: str = "") -> dict[str, Any]:
    """The last event of a program that wasn't begun."""
    return {
        "event": "ended",
        "status": 1,
        "well": False,
        "what": what,
        "help": remedy or None,
        "code": code or None,
        "command": None,
        "done_s": 0.0,
        "joints": None,
        "log": None,
    }


def log_told(log: RunLog | None, lines: Lines) -> tuple[str | None, bool]:
    """Tell what is wrong with a closed log, if anything is.

    Returns:
        Where the log is, for the last event, and true if nothing is wrong with it.
    """
    if log is None:
        return None, True
    if log.problem:
        lines.say({"event": "message", "text": f"{log.problem}; {log.remedy}", "warning": True})
    return None if log.loss else str(log.path), not log.problem


def execute(loaded: Loaded, address: Address, options: dict[str, Any], lines: Lines, *, own: bool) -> int:
    """Carry a program out.

    Args:
        loaded: the program.
        address: of the controller.
        options: of the command line.
        lines: where events go.
        own: whether the controller is a simulator of our own.

    Returns:
        The exit status.
    """
    return status_of(_execute(loaded, address, options, lines, own=own), lines)


def status_of(work: Coroutine[Any, Any, int], lines: Lines) -> int:
    """The exit status of work with a robot; what keeps it from being done is the last line."""
    try:
        return asyncio.run(work)
    except Trouble as trouble:
        lines.say(refused_line(trouble.what, trouble.remedy, trouble.code))
    except Lost as lost:
        lines.say(refused_line(f"the connection was lost: {lost}", "look at the robot", "Y1606"))
    return 1


async def _execute(
    loaded: Loaded, address: Address, options: dict[str, Any], lines: Lines, *, own: bool
) -> int:
    robot = loaded.program.robot
    log: Path | None = NO_LOG if options["no_log"] else options["log"]
    signals = Signals()
    with signals:
        async with opened(
            robot,
            address.host,
            address.port,
            folder=Path(),
            name=loaded.name,
            log=log,
            reply_time=SIMULATED_REPLY_TIME if own else REPLY_TIME,
            pace=options["rate"] or 1.0,
        ) as coordinator:
            client = coordinator.attach("exec")
            client.own()
            signals.client = client
            stream = client.events()
            telling = asyncio.create_task(tell(stream, lines, coordinator, positions=options["positions"]))
            try:
                ended = await _run(client, loaded, options, signals)
            finally:
                stream.close()
                await asyncio.wait((telling,), timeout=_LAST_WORDS)
            ended = Ending(loaded, "", None).placed(ended)
            coordinator.engine.ended = ended
    path, sound = log_told(coordinator.engine.run_log, lines)
    status = int(not (ended.well and sound))
    lines.say({"event": "ended", "status": status, **events.ended_json(ended, robot), "log": path})
    return status


async def _run(client: Client, loaded: Loaded, options: dict[str, Any], signals: Signals) -> Ended:
    if signals.ended:
        return Ended(False, "stopped before it began; nothing moved")
    try:
        return await client.run(
            loaded, approach=options["approach"] or loaded.begins_within, times=options["times"]
        )
    except Trouble as trouble:
        remedy = trouble.remedy.replace("approach it first", "--approach moves there slowly, certified")
        return Ended(False, trouble.what, remedy, code=trouble.code)


async def tell(stream: Subscription, lines: Lines, coordinator: Coordinator, *, positions: bool) -> None:
    """Events to lines, as fast as they are read."""
    async for event in stream:
        if positions or not isinstance(event, events.Position):
            await lines.put(events.event_json(event, coordinator.robot))


class Signals:
    """A termination stops the robot on its path, and ends then; Ctrl-Z holds.

    Args:
        ended: called with each termination.

    Attributes:
        client: who orders; None before there is one.
        ended: whether a termination has come.
    """

    def __init__(self, ended: Callable[[], object] = lambda: None) -> None:
        self._tell_end = ended
        self.client: Client | None = None
        self.ended = False

    def __enter__(self) -> Signals:
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGQUIT):
            loop.add_signal_handler(number, self._end)
        loop.add_signal_handler(signal.SIGTSTP, self._hold)
        return self

    def __exit__(self, *_: object) -> None:
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGQUIT, signal.SIGTSTP):
            loop.remove_signal_handler(number)

    def _end(self) -> None:
        self.ended = True
        self._tell_end()
        if self.client is not None:
            self.client.stop()

    def _hold(self) -> None:
        """A process that sleeps can't look after a robot."""
        if self.client is not None:
            self.client.hold()
