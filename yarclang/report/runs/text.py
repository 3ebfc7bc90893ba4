"""A run in lines of text: what is told, and the one line that changes while it moves.

Live and recorded runs look the same: a `View` takes what is told and where the robot is, and gives the line.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from heapq import merge
from typing import Protocol

from yarclang.frozen import frozen
from yarclang.lasting import Lasting, known
from yarclang.report.pictures.plot import printable
from yarclang.report.runs.course import outcome_text
from yarclang.report.runs.log import RecordedRun
from yarclang.report.runs.messages import Outcome, Pass, Told
from yarclang.robot.model import Array
from yarclang.runtime.notices import Changed, Notice, Progress, Remark
from yarclang.runtime.signals import InputChanged, OutputSet, WaitBegan, WaitEnded, signal_text
from yarclang.runtime.state import State

PLAIN_EACH = 5.0
"""Where no line can change, how often another one is written for a command that goes on [s]."""


class HasJoints(Protocol):
    """What is to be known of a robot, live or recorded, to write its joint positions."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """In the order of the chain."""

    @property
    def axis_units(self) -> Array:
        """(n,) in SI."""


@frozen(eq=False)
class View:
    """What the line that changes shows: of a job that takes `lasting`, its `state`, the last `progress`, and the actual
    joint positions `joints` (n,) [rad or m].

    Each method gives the view behind something.
    """

    robot: HasJoints
    lasting: Lasting
    state: State = State.DISCONNECTED
    progress: Progress | None = None
    joints: Array | None = None

    def behind(self, notice: Notice) -> View:
        """After something was told."""
        match notice:
            case Changed(state=state):
                return replace(self, state=state)
            case Progress():
                return replace(self, progress=notice)
            case _:
                return self

    def at(self, joints: Array) -> View:
        """After the robot was seen at a joint position (n,) [rad or m]: `sample.joints(robot)`."""
        return replace(self, joints=joints)

    def performing(self, lasting: Lasting) -> View:
        """After another job was begun, which takes `lasting`."""
        return replace(self, lasting=lasting, progress=None)

    @property
    def line(self) -> str:
        """`P0010 MOVEL_RPY_LSPB  12.3 s of 40.0 s, 27.7 s left  J1 10.00 J2 -3.50 ...`."""
        parts = [] if self.state is State.MOVE else [self.state.value]
        if self.progress is not None:
            parts.append(progress_text(self.progress, self.lasting))
        if self.joints is not None:
            parts.append(joints_text(self.robot, self.joints))
        return printable("  ".join(parts))


def notice_text(notice: Notice) -> str:
    """A notice as a line of its own; empty for a sample."""
    match notice:
        case Changed(state=state, why=why):
            return printable(f"{state.value}: {why}" if why else state.value)
        case Remark(text=text, warning=warning):
            return printable(f"warning: {text}" if warning else text)
        case Progress():
            return printable(progress_text(notice))
        case OutputSet() | WaitBegan() | WaitEnded() | InputChanged():
            return printable(signal_text(notice))
        case _:
            return ""


def progress_text(progress: Progress, lasting: Lasting | None = None) -> str:
    """The command, how far the program is, how long all of it takes, and how long it still takes at the present override."""
    of = f" of {lasting.text(time_text)}" if lasting is not None else ""
    times = f"{time_text(progress.done)}{of}, {time_text(progress.left)} left"
    return f"{progress.command}  {times}" if progress.command else times


def joints_text(robot: HasJoints, joints: Array) -> str:
    """`J1 10.00 J2 -3.50`: joint positions (n,) [rad or m] in deg and mm."""
    values = (joints / robot.axis_units).round(2) + 0.0  # no minus before a zero
    return " ".join(f"{name} {value:.2f}" for name, value in zip(robot.joint_names, values, strict=True))


def time_text(seconds: float) -> str:
    """12.3 s, 3 min 05 s, 2 h 03 min."""
    if round(seconds, 1) < 100.0:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02} s"
    minutes = whole // 60
    return f"{minutes // 60} h {minutes % 60:02} min"


def over(line: str, width: int) -> str:
    """What to write on a terminal of `width` columns to put a line in the place of the one that changes."""
    return f"\r\x1b[K{line[: max(width - 1, 0)]}"


def head_text(run: RecordedRun) -> str:
    """Which run this is."""
    pace = "" if run.pace == 1.0 else f", {run.pace:g} times as fast as real time"
    started = run.started[:19].replace("T", " ")
    return printable(f"{run.program} on {run.robot.name} at {run.controller}, {started} UTC{pace}")


def _is_usual(one: Told) -> bool:
    """Return True for a state between a WAIT and the next motion that needs no line of its own."""
    return isinstance(one, Changed) and not one.why and one.state in (State.STOP, State.INIT, State.MOVE)


@frozen(eq=False)
class Moment:
    """A moment of a recorded run, at `time` [s]: the view behind it, and the line that was told in it, or nothing."""

    time: float
    view: View
    line: str


def moments_of(run: RecordedRun) -> Iterator[Moment]:
    """A recorded run as it happened."""
    view, between = View(run.robot, run.lasting), False
    told: Iterator[tuple[float, Told | int]] = ((one.time, one) for one in run.told)
    seen: Iterator[tuple[float, Told | int]] = ((float(time), row) for row, time in enumerate(run.times))
    # of what has one time, what is told comes last: how it ended, above all
    for time, one in merge(seen, told, key=lambda pair: pair[0]):
        line = ""
        match one:
            case int():
                view = view.at(run.actual[one])
            case Pass():
                view = view.performing(run.lasting if one.of_program else known(one.duration))
            case Outcome():
                line = printable(outcome_text(run)[0])
            case _:
                view = view.behind(one)
                silent = isinstance(one, Progress) or (between and _is_usual(one))
                line = "" if silent else notice_text(one)
                if isinstance(one, WaitBegan):
                    between = True
                elif isinstance(one, Changed) and one.state is State.MOVE:
                    between = False
        yield Moment(time, view, line)
