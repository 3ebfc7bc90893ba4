"""Messages about logs of runs."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message

Place = Literal["project", "logs"]
"""Folder that contains a log: the project's folder, or the folder into which this robot's runs are logged."""


class RunListed(Message):
    """Summary of a log; times in UTC."""

    place: Place
    file: str
    """Path of the log in the folder `place`."""
    size: int
    changed: str
    state: Literal["whole", "under way", "cut off", "unreadable"]
    """`under way`: the log is still being written. `cut off`: the end of the log is missing. `unreadable`:
    the file isn't a log of a run, or has an unknown format.
    """
    program: str
    robot: str
    controller: str
    client: str
    """User who ordered the first motion; empty: the log doesn't contain it."""
    started: str
    duration_s: float | None
    well: bool | None
    """True if the run was completed; null: the log doesn't contain this."""
    what: str
    """Reason for a failure."""
    code: str


class RunList(Message):
    """Logs of runs; the log that was changed last comes first. `cut` is true if there are more."""

    runs: tuple[RunListed, ...]
    cut: bool
    folder: str
    """Folder in which this robot's motions are logged; empty: not known here."""


class RunJoint(Message):
    """A joint as it was described during the run. Limits are in the joint's unit; null if there is none."""

    name: str
    unit: str
    lower: float | None
    upper: float | None


class RunLines(Message):
    """Plotted lines of a log. `values` has one row for each joint or motor, with one value for each time."""

    title: str
    unit: str
    times: tuple[float, ...]
    """Times of the values [s since the log was opened]."""
    names: tuple[str, ...]
    values: tuple[tuple[float, ...], ...]
    breaks: tuple[int, ...]
    """Indices in `times` at which a new pass of a repeated program begins. There, the plotted line is
    interrupted.
    """


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
    """A time interval in which a signal keeps its value: the value, the begin and the end [s since the log
    was opened].
    """

    from_s: float
    to_s: float
    value: float


class RunWait(Message):
    """A wait for an input, with its begin and end [s since the log was opened]. `met` is true if the input
    got the wanted value.
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
    """Content of a log. Its time is divided into a thousand intervals. Of each plotted line, only the
    smallest and the largest value in each interval are contained.
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
    """Remarks about parts of the log that are unreliable or missing, with the reasons."""
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
