"""The terminal that a run was started in: signals and keys that give orders, questions, and the line that changes."""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import signal
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from queue import SimpleQueue
from types import TracebackType

import click

from yarclang.coordinator.ordered import OrderedSession
from yarclang.report.runs.text import PLAIN_EACH, View, notice_text, over, time_text
from yarclang.runtime.feedback import Sample
from yarclang.runtime.job import Job, JobCommand
from yarclang.runtime.notices import (
    Abort,
    Changed,
    Hold,
    Notice,
    Progress,
    Remark,
    Resume,
    Stop,
)
from yarclang.runtime.operation import Operation
from yarclang.runtime.state import State

_WIDTH = 80
"""Columns of a terminal that doesn't say how many it has."""

_SAME = 1e-6
"""Times that are nearer to each other are one [s]."""

_STAYS = "\xa0"
_TOGETHER = re.compile(r"(?<=\d) (?=(?:deg|mm|s|ms|%)\b)|(?<=\bJ\d) (?=[-+]?\d)")
"""A space that no line ends at: between a joint and its value, and a value and its unit."""

_VALUE = re.compile(r"(?:-?\d+\.\d+|left)(?= |$)")
_ENDING = (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


class Screen:
    """Standard error, written by a thread of its own: a terminal that was stopped by Ctrl-S, or is gone, delays no robot."""

    def __init__(self) -> None:
        self.live = sys.stderr.isatty()
        self._shown = False
        self._queue: SimpleQueue[str | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._write, name="screen", daemon=True)
        self._thread.start()

    def say(self, text: str) -> None:
        """Write whole lines; on a terminal, broken where words end."""
        before = "\r\x1b[K" if self._shown else ""
        self._shown = False
        self._queue.put(f"{before}{self._broken(text) if self.live else text}\n")

    def change(self, text: str) -> None:
        """Put a line in the place of the one that changes."""
        if self._queue.empty():
            width = self._width()
            self._queue.put(over(_cut(text, width - 1), width))
            self._shown = True

    def ask(self, text: str) -> None:
        """Write what somebody is to answer behind."""
        self._queue.put(text)

    def close(self) -> None:
        """Write what is left, if the terminal is still there."""
        if self._shown:
            self._queue.put("\n")
            self._shown = False
        self._queue.put(None)
        self._thread.join()

    def _write(self) -> None:
        with contextlib.suppress(OSError, ValueError):  # it is gone
            while (text := self._queue.get()) is not None:
                click.echo(text, err=True, nl=False)

    def _broken(self, text: str) -> str:
        width = self._width()
        lines: list[str] = []
        for line in text.split("\n"):
            indent = " " * (len(line) - len(line.lstrip(" ")) + 4)
            long = click.unstyle(line)
            if len(long) < width or "yarc run" in line:  # what somebody may copy stays whole
                lines.append(line)
            else:
                kept = _TOGETHER.sub(_STAYS, line)
                lines += textwrap.wrap(kept, width - 1, subsequent_indent=indent, break_on_hyphens=False)
        return "\n".join(lines).replace(_STAYS, " ")

    def _width(self) -> int:
        try:
            return os.get_terminal_size(sys.stderr.fileno()).columns or _WIDTH
        except (OSError, ValueError):
            return _WIDTH


def _cut(line: str, width: int) -> str:
    """What of a line fits, to the end of a value: half a number would be another number."""
    if len(line) <= width:
        return line
    ends = [found.end() for found in _VALUE.finditer(line, 0, width + 1) if found.end() <= width]
    return line[: ends[-1]] if ends else line[:width]


class Display:
    """Shows a run: on a terminal with one line that changes, else with a line now and then."""

    def __init__(self, screen: Screen, operation: Operation, program: Job) -> None:
        self._screen = screen
        self._operation = operation
        self._program = program
        self._view = View(program.robot, program.duration)
        self._command = ""
        self._instead = ""
        self._behind = 0.0
        self._brief = False
        self._written = 0.0
        self._ahead: list[JobCommand] = []

    def begin(self, job: Job, *, instead: str = "", brief: bool = False) -> None:
        """From here on, this job is performed.

        Args:
            job: the program, a part of it, or the way to its start.
            instead: what its command is called; empty: as in the program.
            brief: leave out what is told of every job.
        """
        self._instead, self._brief, self._command = instead, brief, ""
        of_program = not instead
        self._behind = self._program.duration - job.offset - job.duration if of_program else 0.0
        self._view = self._view.performing(self._program.duration if of_program else job.duration)
        ends = job.offset + job.duration
        self._ahead = [
            one for one in self._program.commands if job.offset - _SAME <= one.begins < ends - _SAME
        ]

    def take(self, notice: Notice) -> None:
        """Show a notice."""
        before = self._view.state
        match notice:
            case Sample():
                self._view = self._view.at(notice.joints(self._program.robot))
            case Progress():
                self._view = self._view.behind(self._of_program(notice))
                self._show_progress()
            case Changed() | Remark():
                self._view = self._view.behind(notice)
                if not (isinstance(notice, Changed) and self._left_out(notice, before)):
                    self._screen.say(notice_text(notice))

    def _of_program(self, progress: Progress) -> Progress:
        """Progress of a part as that of the whole program."""
        left = progress.left + self._behind / max(self._operation.override, 0.01)
        return replace(progress, left=left, command=self._instead or progress.command)

    def _show_progress(self) -> None:
        if self._screen.live:
            self._screen.change(self._view.line)
        elif self._view.state is not State.INIT and self._view.progress is not None:
            self._show_plain(self._view.progress)

    def _show_plain(self, progress: Progress) -> None:
        """Each command as it begins, and now and then how far a long one is."""
        now = time.monotonic()
        if self._instead:
            begun = [] if self._command else [self._instead]
        elif self._program.legs:  # which commands are executed isn't known before
            command = self._program.command_at(progress.done) if progress.command else None
            begun = [self._command_line(command)] if command and progress.command != self._command else []
        else:
            # at the end, all have begun, also those that nobody was told of
            begun = [self._command_line(one) for one in self._ahead if one.begins <= progress.done + _SAME]
            del self._ahead[: len(begun)]
        self._command = progress.command
        for line in begun:
            self._screen.say(line)
        if begun:
            self._written = now
        elif progress.command and now - self._written > PLAIN_EACH:
            self._written = now
            self._screen.say(self._view.line)

    def _command_line(self, command: JobCommand) -> str:
        """A command, and when it is executed."""
        begins, ends, of = map(time_text, (command.begins, command.ends, self._program.duration))
        return f"{command.title}  {begins} to {ends} of {of}"

    def _left_out(self, change: Changed, before: State) -> bool:
        """How it ends is told when all of it is known. Again and again, only what is out of the ordinary counts."""
        if change.state is State.FAULT or (change.state is State.STOP and not self._instead):
            return True
        ordinary = before is not State.HOLD and change.state in (State.INIT, State.MOVE)
        left_out = self._brief and ordinary
        # a program that waits for an input, say, is loaded leg by leg
        self._brief = self._brief or change.state is State.MOVE
        return left_out


class Terminal:
    """Ctrl-C holds, and aborts the second time; Enter goes on behind a hold; a termination ends on the path.

    Args:
        session: what is ordered.
        screen: where it is told.
        give_up: called where nothing moves yet, and where nothing can be done.

    Attributes:
        performing: whether a job is; before that, there is nothing to hold.
        gave_up: whether somebody gave up a robot that can't be reached.
    """

    def __init__(self, session: OrderedSession, screen: Screen, give_up: Callable[[], object]) -> None:
        self.performing = False
        self.gave_up = False
        self._session = session
        self._screen = screen
        self._give_up = give_up
        self._asked_to_hold = False
        self._asked_to_abort = False
        self._answer: asyncio.Future[str] | None = None
        self._keys = sys.stdin is not None and sys.stdin.isatty()
        session.listen(self._hear)

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

    async def agrees(self, question: str) -> bool:
        """Whether the user says yes. Without a terminal nobody can be asked, and that is wrong usage."""
        if not self._keys:
            raise click.UsageError(f"{question} Nobody can be asked here: give --yes")
        self._screen.ask(f"{question} [y/N]: ")
        self._answer = asyncio.get_running_loop().create_future()
        try:
            return (await self._answer).strip().lower() in ("y", "yes")
        finally:
            self._answer = None

    def _hear(self, notice: Notice) -> None:
        if isinstance(notice, Changed) and notice.state is State.MOVE:
            self._asked_to_hold = False

    def _interrupted(self) -> None:
        """Ctrl-C."""
        state = self._session.operation.state
        if not self.performing:
            self._give_up()
        elif state is State.DISCONNECTED:
            self._while_disconnected()
        elif state not in (State.MOVE, State.HOLD):
            self._session.order(Stop())
        elif not self._asked_to_hold:
            self._asked_to_hold = True
            self._session.order(Hold())
            self._screen.say("holding: Enter or `yarc resume` goes on, `yarc stop` ends, Ctrl-C again aborts")
        else:
            self._session.order(Abort())
            self._screen.say("aborting: each motor stops at once")

    def _while_disconnected(self) -> None:
        if not self._asked_to_abort:
            self._asked_to_abort = True
            self._session.order(Abort())
            self._screen.say(
                "there is no connection; it will be told to abort as soon as there is one; Ctrl-C again gives up"
            )
        else:
            self.gave_up = True
            self._give_up()

    def _suspended(self) -> None:
        """Ctrl-Z: a process that sleeps can't look after a robot."""
        state = self._session.operation.state
        if self.performing and state in (State.MOVE, State.HOLD):
            self._session.order(Hold())
            self._screen.say("this process can't sleep while it drives a robot: holding on the path instead")
        else:
            self._screen.say("this process can't sleep while it drives a robot; Ctrl-C ends it")

    def _terminated(self) -> None:
        if self.performing:
            self._session.order(Stop())
        else:
            self._give_up()

    def _typed(self) -> None:
        """A line, or the end of the terminal."""
        descriptor = sys.stdin.fileno()
        try:
            if os.tcgetpgrp(descriptor) != os.getpgrp():
                return  # it is somebody else's
            data = os.read(descriptor, 4096)
        except OSError:
            data = b""
        if not data and not os.isatty(descriptor):
            asyncio.get_running_loop().remove_reader(sys.stdin)
        if self._answer is not None:
            if not self._answer.done():
                self._answer.set_result(data.decode(errors="replace"))
        elif data and (self._session.paused or self._session.operation.state is State.HOLD):
            self._session.order(Resume())
