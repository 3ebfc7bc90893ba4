"""Implement `yarc exec`: a program runs without a terminal. Events are written as JSON lines, and signals of
the operating system are orders.
"""

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
from queue import SimpleQueue
from typing import Any

from yarclang.cli.attaching import Place, attached
from yarclang.cli.terminal import SILENT
from yarclang.coordinator.attached import Attached, Here
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.replies import Ended, LogTold, ProgramDescribed
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.subscription import Subscription
from yarclang.diagnostics import Diagnostic
from yarclang.report.cell import cell_text
from yarclang.report.finding import finding_json
from yarclang.runtime.actions import Lost, Trouble

_LAST_WORDS = 5.0
"""Longest time that the command waits at its end for a reader to read the last lines [s]."""


class Lines:
    """JSON lines on standard output. A separate thread writes them, so that a slow or closed reader doesn't
    delay the robot.

    Events that arrive during a write wait in the coordinator's stream of events, whose length is limited.
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
        """Queue a line."""
        self._queue.put((self._line(content), lambda: None))

    def close(self) -> None:
        """Write the remaining lines, if the reader still reads."""
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
                    gone = True  # the run continues without readers
            with contextlib.suppress(RuntimeError):  # the event loop has ended
                written()
        if gone:
            with contextlib.suppress(OSError):  # leave nothing for the interpreter to flush
                os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def findings_line(found: tuple[Diagnostic, ...]) -> dict[str, Any]:
    """Return the event that lists a program's findings."""
    return {"event": "findings", "findings": [finding_json(one) for one in found]}


def refused_line(what: str, remedy: str, code: str = "") -> dict[str, Any]:
    """Return the last event of a program that wasn't started."""
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


def log_line(log: LogTold | None, lines: Lines) -> tuple[str | None, bool]:
    """Report a problem with a log that was closed, if there is one.

    Returns:
        The path of the log, for the last event, and True if there is no problem.
    """
    if log is None:
        return None, True
    if log.problem:
        lines.say({"event": "message", "text": f"{log.problem}; {log.help}", "warning": True})
    return None if log.lost else log.path, not log.problem


def execute(
    loaded: Loaded | orders.Load, name: str, place: Place, options: dict[str, Any], lines: Lines
) -> int:
    """Run a program for `yarc exec`.

    Args:
        loaded: the program, or the order by which the coordinator loads it.
        name: name of the program for people.
        place: controller or running coordinator of the robot.
        options: options of the command line.
        lines: output of events.

    Returns:
        The exit status.
    """
    return status_of(_execute(loaded, name, place, options, lines), lines)


def status_of(work: Coroutine[Any, Any, int], lines: Lines) -> int:
    """Run a coroutine that uses a robot, and return the exit status. If it fails, write the reason as the
    last line.
    """
    try:
        return asyncio.run(work)
    except Trouble as trouble:
        lines.say(refused_line(trouble.what, trouble.remedy, trouble.code))
    except asyncio.CancelledError:
        what = "given up: the process that serves the robot doesn't answer, so the robot's state is unknown"
        lines.say(refused_line(what, "inspect the robot", "Y1606"))
    except Lost as lost:
        lines.say(refused_line(f"the connection was lost: {lost}", "inspect the robot", "Y1606"))
    return 1


async def _execute(
    loaded: Loaded | orders.Load, name: str, place: Place, options: dict[str, Any], lines: Lines
) -> int:
    signals = Signals()
    whose = loaded.program.robot if isinstance(loaded, Loaded) else None
    with signals:
        async with attached(place, whose, "exec", options, what=name) as robot:
            if place.served is not None and (cell := robot.welcome.status.cell) is not None:
                lines.say({"event": "message", "text": cell_text(cell), "warning": False})
            await robot.ask(orders.Own(shared=True))
            signals.attached = robot
            stream = await robot.listen(positions=options["positions"])
            telling = asyncio.create_task(tell(stream, lines))
            try:
                ended = await _run(robot, loaded, options, signals, lines)
            finally:
                stream.close()
                await asyncio.wait((telling,), timeout=_LAST_WORDS)
            released = await robot.ask(orders.Release())
    path, sound = log_line(released.log, lines)
    if ended is None:
        return 1
    status = int(not (ended.well and sound))
    lines.say({"event": "ended", "status": status, **_ended(ended), "log": path})
    return status


def _ended(ended: Ended) -> dict[str, Any]:
    """Return the fields that describe an end in the last line."""
    content = ended.to_json()
    return {key: content[key] for key in ("well", "what", "help", "code", "command", "done_s", "joints")}


async def _run(
    robot: Attached, loaded: Loaded | orders.Load, options: dict[str, Any], signals: Signals, lines: Lines
) -> Ended | None:
    """Run a program, and return its end. If it wasn't started, report that and return None."""
    if isinstance(loaded, Loaded):
        assert isinstance(robot, Here)  # a program loaded in this process runs in this process
        program = robot.desk.keep(loaded)
    else:
        made = await robot.ask(loaded)
        if made.findings:
            lines.say({"event": "findings", "findings": [_finding(one) for one in made.findings]})
        if made.program is None:
            lines.say(refused_line("the program has errors; nothing moved", "see the findings"))
            return None
        program = made.program
        if refused := not_repeated(program, options):
            lines.say(refused)
            return None
    state = robot.welcome.status.state
    if signals.ended:
        return Ended(well=False, what="stopped before it began; nothing moved", state=state)
    order = orders.Run(
        program=program.number,
        approach=options["approach"] or program.begins_within,
        times=options["times"],
    )
    try:
        return await robot.ask(order)
    except Trouble as trouble:
        is_elsewhere = trouble.remedy == orders.APPROACH_FIRST
        remedy = "--approach moves there slowly, certified" if is_elsewhere else trouble.remedy
        return Ended(
            well=False, what=trouble.what, help=remedy or None, code=trouble.code or None, state=state
        )


def _finding(one: Finding) -> dict[str, Any]:
    content = one.to_json()
    del content["text"]
    return content


def not_repeated(program: ProgramDescribed, options: dict[str, Any]) -> dict[str, Any] | None:
    """Return the event that refuses to repeat a program. Return None if no repetition was requested, or if
    the program can be repeated.
    """
    if options["times"] <= 1 or not program.not_looped:
        return None
    what = f"{program.name} can't be repeated, since it doesn't end where it starts: {program.not_looped}"
    return refused_line(what, "add a last motion to its start")


async def tell(stream: Subscription, lines: Lines) -> None:
    """Write events as lines. Wait after each line until it is written."""
    async for event in stream:
        await lines.put(event.to_json())


class Signals:
    """Handlers of the operating system's signals.

    A termination (SIGTERM, SIGINT or SIGQUIT) stops the robot on its path, and then ends the command. A
    second termination ends the command even if the coordinator doesn't answer. Ctrl-Z holds.

    Args:
        ended: function that is called at each termination.

    Attributes:
        attached: client for orders; None before there is one.
        ended: True after a termination.
    """

    def __init__(self, ended: Callable[[], object] = lambda: None) -> None:
        self._tell_end = ended
        self.attached: Attached | None = None
        self._task: asyncio.Task[Any] | None = None
        self.ended = False

    def __enter__(self) -> Signals:
        loop = asyncio.get_running_loop()
        self._task = asyncio.current_task()
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGQUIT):
            loop.add_signal_handler(number, self._end)
        loop.add_signal_handler(signal.SIGTSTP, self._hold)
        return self

    def __exit__(self, *_: object) -> None:
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGQUIT, signal.SIGTSTP):
            loop.remove_signal_handler(number)

    def _end(self) -> None:
        if (
            self.ended
            and self.attached is not None
            and self.attached.silence > SILENT
            and self._task is not None
        ):
            # the coordinator doesn't answer, so it can't stop the robot and end this task
            self._task.cancel()
            return
        self.ended = True
        self._tell_end()
        if self.attached is not None:
            self.attached.send(orders.Stop())

    def _hold(self) -> None:
        """Hold the robot, since this process is about to be suspended and then can't supervise it."""
        if self.attached is not None:
            self.attached.send(orders.Hold())
