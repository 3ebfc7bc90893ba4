"""Messages about logs of runs."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message

Place = Literal["project", "logs"]
"""Folder of a log: the project's folder, or the folder in which this robot's motions are logged."""


class RunListed(Message):
    """Summary of a log; times in UTC."""

    place: Place
    file: str
    """Path of the log in the folder `place`."""
    size: int
    changed: str
    state: Literal["whole", "under way", "cut off", "unreadable"]
    """`under way`: the log is being written; `cut off`: its end is missing; `unreadable`: it is no log of a
    run, or has another format.
    """
    program: str
    robot: str
    controller: str
    client: str
    """User who ordered the first motion; empty: the log doesn't contain it."""
    started: str
    duration_s: float | None
    well: bool | None
    """True if the run came to its end; null: the log doesn't contain it."""
    what: str
    """Reason for a failure."""
    code: str


class RunList(Message):
    """Logs, the one that changed last first. `cut` is true if there are more."""

    runs: tuple[RunListed, ...]
    cut: bool
    folder: str
    """Folder in which this robot's motions are logged; empty: not known here."""


class RunJoint(Message):
    """A joint as it was during the run. Limits are in its unit; null if there is none."""

    name: str
    unit: str
    lower: float | None
    upper: float | None


class RunLines(Message):
    """Lines over the time of the log. `values` has one row per joint or motor, with one value per time."""

    title: str
    unit: str
    times: tuple[float, ...]
    """Times of the values [s since the log was opened]."""
    names: tuple[str, ...]
    values: tuple[tuple[float, ...], ...]
    breaks: tuple[int, ...]
    """Indices in `times` at which another pass begins: no line is drawn to them from the time before."""


class RunSpan(Message):
    """A state, with its begin and end [s since the log was opened]."""

    state: str
    from_s: float
    to_s: float


class RunEvent(Message):
    """A message of the run, with its time [s since the log was opened]."""

    time_s: float
    text: str
    warning: bool


class RunStretch(Message):
    """A value of a signal, with its begin and end [s since the log was opened]."""

    from_s: float
    to_s: float
    value: float


class RunWait(Message):
    """A wait for an input, with its begin and end [s since the log was opened]. `met` is true if the input
    came.
    """

    from_s: float
    to_s: float
    met: bool


class RunSignal(Message):
    """An input or output."""

    name: str
    is_input: bool
    stretches: tuple[RunStretch, ...]
    waits: tuple[RunWait, ...]


class RunWay(Message):
    """Path of the robot: times [s], and the joint positions at each time [deg or mm]."""

    times: tuple[float, ...]
    joints: tuple[tuple[float, ...], ...]


class RunShown(Message):
    """Content of a log. Lines are thinned to the smallest and the largest value of each of a thousand
    intervals.
    """

    program: str
    robot: str
    controller: str
    version: str
    started: str
    pace: float
    end_s: float
    outcome: str
    well: bool | None
    code: str
    remedy: str
    notes: tuple[str, ...]
    """Unreliable or missing parts of the log, with reasons."""
    joints: tuple[RunJoint, ...]
    lines: tuple[RunLines, ...]
    planned: RunLines | None
    """Commanded positions of the joints; null: not known."""
    states: tuple[RunSpan, ...]
    signals: tuple[RunSignal, ...]
    events: tuple[RunEvent, ...]
    more_events: int
    """Number of events that are left out of the list."""
    way: RunWay
