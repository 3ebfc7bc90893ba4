"""Display of a run on the terminal: a line for each command, and one status line that changes in place."""

from __future__ import annotations

import time
from bisect import bisect_right
from dataclasses import dataclass, replace

import numpy as np

from yarclang.cli.screen import Screen
from yarclang.coordinator.describing import lasting_of, signal_of
from yarclang.coordinator.messages.events import (
    BaseEvent,
    InputChanged,
    OutputSet,
    PartBegan,
    Paused,
    Position,
    ProgressMade,
    StateChanged,
    Told,
    WaitEnded,
)
from yarclang.coordinator.messages.replies import ProgramCommand, ProgramDescribed, Status
from yarclang.coordinator.picture import Picture
from yarclang.lasting import known
from yarclang.report.runs.text import PLAIN_EACH, View, notice_text, time_text
from yarclang.robot.model import Array
from yarclang.runtime.notices import Changed, Progress, Remark
from yarclang.runtime.signals import signal_text
from yarclang.runtime.state import State

_SAME = 1e-6
"""Times that differ by less count as equal [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Axes:
    """Joint names and units of a robot that is known only from the coordinator's messages. Positions in these
    messages are in deg and mm.
    """

    joint_names: tuple[str, ...]

    @property
    def axis_units(self) -> Array:
        """Ones (n,), since positions in messages need no conversion."""
        return np.ones(len(self.joint_names))

    @classmethod
    def of(cls, status: Status) -> Axes:
        """Return the joints whose positions a status contains."""
        return cls(tuple(one.name for one in status.joints))


_MANY, _FEW = 200, 4
"""A program with more than `_MANY` commands counts as long. If at least `_FEW` commands of a long program
have begun since the last output, one line shows them all.
"""
_SELDOM = 1.0
"""Shortest time between two lines about the commands of a long program [s]."""


class Display:
    """Display of a run: a line for each command. On a terminal, there is also a status line that changes in
    place. Elsewhere, a long command gets an additional line from time to time.
    """

    def __init__(self, screen: Screen, picture: Picture, joints: Axes, program: ProgramDescribed) -> None:
        self._screen = screen
        self._picture = picture
        self._joints = joints
        self._program = program
        self._lasting = lasting_of(program.takes)
        self._view = View(joints, self._lasting)
        self._command = ""
        self._instead = ""
        self._behind = 0.0
        self._brief = False
        self._written = 0.0
        self._ahead: list[ProgramCommand] = []
        self._next = 0
        """Index of the command that begins next."""

    def take(self, event: BaseEvent) -> None:
        """Show an event."""
        before = self._view.state
        match event:
            case Position(joints=joints):
                self._view = self._view.at(np.array([joints[name] for name in self._joints.joint_names]))
            case ProgressMade():
                self._view = self._view.behind(self._of_program(_progress(event)))
                self._show_progress()
            case StateChanged(time_s=time, state=state, why=why):
                change = Changed(time, state, why)
                self._view = self._view.behind(change)
                if not self._left_out(change, before):
                    self._screen.say(notice_text(change))
            case Told(time_s=time, text=text, warning=warning):
                self._screen.say(notice_text(Remark(time, text, warning)))
            case OutputSet() | WaitEnded() | InputChanged():
                self._screen.say(signal_text(signal_of(event)))
            case PartBegan():
                self._begin(event)
            case Paused(title=title, number=number, of=of):
                self._screen.say(
                    f"Enter or `yarc resume` for {title} ({number} of {of}), Ctrl-C ends the run"
                )

    def _begin(self, part: PartBegan) -> None:
        """Prepare the display for a job that begins now: the whole program, a part of it, or a motion outside
        of it (to its start, or a way out).
        """
        program = self._program
        beside = part.to_the_start or part.leads_out
        again = part.number > 1 and not beside
        if again and not program.steps:
            self._screen.say(f"pass {part.number}{f' of {part.of}' if part.of else ''}")
        self._instead = part.name if beside else ""
        self._brief = not beside and (again or bool(program.steps))
        self._command = ""
        ends = part.offset_s + part.duration_s
        self._behind = 0.0 if beside else program.duration_s - ends
        self._view = self._view.performing(known(part.duration_s) if beside else self._lasting)
        self._next = 0
        self._ahead = [
            one for one in program.commands if part.offset_s - _SAME <= one.begins_s < ends - _SAME
        ]

    def _of_program(self, progress: Progress) -> Progress:
        """Convert the progress of a job to the progress of the whole program, of which the job may be a
        part.
        """
        left = progress.left + self._behind / max(self._picture.override / 100.0, 0.01)
        return replace(progress, left=left, command=self._instead or progress.command)

    def _show_progress(self) -> None:
        progress = self._view.progress
        now = time.monotonic()
        loading = self._view.state is State.INIT
        begun = [] if loading or progress is None else self._now_begun(progress, now)
        if begun:
            self._written = now
            self._screen.say("\n".join(begun), below=self._view.line)
        elif self._screen.live:
            self._screen.change(self._view.line)
        elif not loading and self._command and now - self._written > PLAIN_EACH:
            self._written = now
            self._screen.say(self._view.line)

    def _now_begun(self, progress: Progress, now: float) -> list[str]:
        """Return a line for each command that has begun since the last call, at `now` [s]."""
        if self._instead:
            begun = [] if self._command else [self._instead]
        elif self._program.by_legs:  # the executed commands aren't known in advance
            command = _command_of(self._program, progress) if progress.command else None
            begun = [self._command_line(command)] if command and progress.command != self._command else []
        else:
            begun = self._begun(progress.done, now)
        self._command = progress.command
        return begun

    def _begun(self, done: float, now: float) -> list[str]:
        """Return lines for the commands that have begun since the last call.

        For a long program, nothing is returned within `_SELDOM` after the last output, unless the program's
        last command has begun. If at least `_FEW` commands of a long program have begun, one line shows them
        all.

        Args:
            done: how far the program is [s].
            now: current time [s].
        """
        count = bisect_right(self._ahead, done + _SAME, self._next, key=lambda one: one.begins_s)
        last = count == len(self._ahead)
        if len(self._ahead) > _MANY and not last and now - self._written < _SELDOM:
            return []
        begun, self._next = self._ahead[self._next : count], count
        if len(self._ahead) <= _MANY or len(begun) < _FEW:
            return [self._command_line(one) for one in begun]
        times = f"{time_text(begun[0].begins_s)} to {time_text(begun[-1].ends_s)}"
        whole = self._lasting.text(time_text)
        return [f"{begun[0].title} to {begun[-1].title}, {len(begun):,} commands  {times} of {whole}"]

    def _command_line(self, command: ProgramCommand) -> str:
        """Return the line that shows a command and its times."""
        begins, ends = time_text(command.begins_s), time_text(command.ends_s)
        return f"{command.title}  {begins} to {ends} of {self._lasting.text(time_text)}"

    def _left_out(self, change: Changed, before: State) -> bool:
        """Return True if no line is printed for a change of the robot's state.

        The end is reported later, with all of its details. After the first motion, ordinary changes are left
        out.
        """
        if change.state is State.FAULT or (change.state is State.STOP and not self._instead):
            return True
        ordinary = before is not State.HOLD and change.state in (State.INIT, State.MOVE)
        left_out = self._brief and ordinary
        # a program that waits for an input, for example, is loaded in several parts: report only the first
        self._brief = self._brief or change.state is State.MOVE
        return left_out


def _progress(event: ProgressMade) -> Progress:
    return Progress(event.time_s, event.done_s, event.left_s, event.command, event.line)


def _command_of(program: ProgramDescribed, progress: Progress) -> ProgramCommand | None:
    """Return the command that is being executed. If several commands have the reported name and line, as in a
    loop, choose by time.
    """
    found = [
        one for one in program.commands if (one.title, one.line) == (progress.command, progress.source_line)
    ]
    return next((one for one in found if one.ends_s > progress.done), found[-1] if found else None)
