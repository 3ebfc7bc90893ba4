"""Format a run as lines of text: reports, and one status line that changes during the motion.

Live and recorded runs look alike: a `View` processes reports and positions, and returns the status line.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from heapq import merge
from typing import Protocol

from yarclang.frozen import frozen
from yarclang.lasting import Lasting, known
from yarclang.report.pictures.style import printable
from yarclang.report.runs.course import outcome_text
from yarclang.report.runs.log import RecordedRun
from yarclang.report.runs.messages import Outcome, Pass, Told
from yarclang.robot.model import Array
from yarclang.runtime.notices import Changed, Notice, Progress, Remark
from yarclang.runtime.signals import InputChanged, OutputSet, WaitBegan, WaitEnded, signal_text
from yarclang.runtime.state import State

PLAIN_EACH = 5.0
"""Time between two status lines of a long command [s], if the output isn't a terminal on which one line can
be changed.
"""


class HasJoints(Protocol):
    """Interface of a robot, live or recorded, for formatting its joint positions."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names in the order of the chain."""

    @property
    def axis_units(self) -> Array:
        """Axis units (n,) in SI."""


@frozen(eq=False)
class View:
    """The content of the status line of a run. The methods return a new View, with the content after an
    event.

    Attributes:
        robot: robot with joint names and units.
        lasting: duration of the job.
        state: state of the robot.
        progress: the latest report of progress.
        joints: (n,) actual positions [rad or m].
    """

    robot: HasJoints
    lasting: Lasting
    state: State = State.DISCONNECTED
    progress: Progress | None = None
    joints: Array | None = None

    def behind(self, notice: Notice) -> View:
        """Return the view after a report has come."""
        match notice:
            case Changed(state=state):
                return replace(self, state=state)
            case Progress():
                return replace(self, progress=notice)
            case _:
                return self

    def at(self, joints: Array) -> View:
        """Return the view after a new joint position (n,) [rad or m]: `sample.joints(robot)`."""
        return replace(self, joints=joints)

    def performing(self, lasting: Lasting) -> View:
        """Return the view after the beginning of another job, whose duration is `lasting`."""
        return replace(self, lasting=lasting, progress=None)

    @property
    def line(self) -> str:
        """Return the status line:
        `P0010 MOVEL_RPY_LSPB  12.3 s of 40.0 s, 27.7 s left  J1 10.00 J2 -3.50 ...`.
        """
        parts = [] if self.state is State.MOVE else [self.state.value]
        if self.progress is not None:
            parts.append(progress_text(self.progress, self.lasting))
        if self.joints is not None:
            parts.append(joints_text(self.robot, self.joints))
        return printable("  ".join(parts))


def notice_text(notice: Notice) -> str:
    """Return a report as a complete line; empty for a sample."""
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
    """Return the current command, the program's progress and duration [s], and the remaining time at the
    current override, in words.
    """
    of = f" of {lasting.text(time_text)}" if lasting is not None else ""
    times = f"{time_text(progress.done)}{of}, {time_text(progress.left)} left"
    return f"{progress.command}  {times}" if progress.command else times


def joints_text(robot: HasJoints, joints: Array) -> str:
    """Format joint positions (n,) [rad or m] in deg and mm: `J1 10.00 J2 -3.50`."""
    values = (joints / robot.axis_units).round(2) + 0.0  # adding 0.0 removes the sign of zero
    return " ".join(f"{name} {value:.2f}" for name, value in zip(robot.joint_names, values, strict=True))


def time_text(seconds: float) -> str:
    """Format a time: 12.3 s, 3 min 05 s, 2 h 03 min."""
    if round(seconds, 1) < 100.0:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02} s"
    minutes = whole // 60
    return f"{minutes // 60} h {minutes % 60:02} min"


def over(line: str, width: int) -> str:
    """Return the text that replaces the status line on a terminal of `width` columns."""
    return f"\r\x1b[K{line[: max(width - 1, 0)]}"


def head_text(run: RecordedRun) -> str:
    """Return the heading of a run."""
    pace = "" if run.pace == 1.0 else f", {run.pace:g} times as fast as real time"
    started = run.started[:19].replace("T", " ")
    return printable(f"{run.program} on {run.robot.name} at {run.controller}, {started} UTC{pace}")


def _is_usual(report: Told) -> bool:
    """Return True for a change of state that always occurs between a WAIT and the next motion. No line is
    printed for such a change.
    """
    return (
        isinstance(report, Changed)
        and not report.why
        and report.state in (State.STOP, State.INIT, State.MOVE)
    )


@frozen(eq=False)
class Moment:
    """A moment of a recorded run, as it is replayed as text.

    Attributes:
        time: time of the moment [s].
        view: the status line after this moment.
        line: report at this moment; empty if there is none.
    """

    time: float
    view: View
    line: str


def moments_of(run: RecordedRun) -> Iterator[Moment]:
    """Yield the moments of a recorded run."""
    view, between = View(run.robot, run.lasting), False
    told: Iterator[tuple[float, Told | int]] = ((moment.time, moment) for moment in run.told)
    seen: Iterator[tuple[float, Told | int]] = ((float(time), row) for row, time in enumerate(run.times))
    # at equal times, reports come after samples, so that the outcome is last
    for time, moment in merge(seen, told, key=lambda pair: pair[0]):
        line = ""
        match moment:
            case int():
                view = view.at(run.actual[moment])
            case Pass():
                view = view.performing(run.lasting if moment.of_program else known(moment.duration))
            case Outcome():
                line = printable(outcome_text(run)[0])
            case _:
                view = view.behind(moment)
                silent = isinstance(moment, Progress) or (between and _is_usual(moment))
                line = "" if silent else notice_text(moment)
                if isinstance(moment, WaitBegan):
                    between = True
                elif isinstance(moment, Changed) and moment.state is State.MOVE:
                    between = False
        yield Moment(time, view, line)
