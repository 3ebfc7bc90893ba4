"""What is said of logs of runs."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message

Place = Literal["project", "logs"]
"""Where a log lies: in the project, or in the folder where this robot's motions are logged."""


class RunListed(Message):
    """A log in short; times in UTC."""

    place: Place
    file: str
    """Its path there."""
    size: int
    changed: str
    state: Literal["whole", "under way", "cut off", "unreadable"]
    """`under way`: it is being written; `cut off`: its end is missing; `unreadable`: it is no log of a run, or of another format."""
    program: str
    robot: str
    controller: str
    client: str
    """Who ordered the first motion; empty: the log doesn't say."""
    started: str
    duration_s: float | None
    well: bool | None
    """True if the run came to its end; null: the log doesn't say."""
    what: str
    """Why it didn't end well."""
    code: str


class RunList(Message):
    """Logs, those that were changed last first; `cut` is true if there are more."""

    runs: tuple[RunListed, ...]
    cut: bool
    folder: str
    """Where this robot's motions are logged; empty: not known here."""


class RunJoint(Message):
    """A joint as it was then; limits in its unit, null where there is none."""

    name: str
    unit: str
    lower: float | None
    upper: float | None


class RunLines(Message):
    """Lines over the time of the log: `values` has a row a joint or motor, with a value a time."""

    title: str
    unit: str
    times: tuple[float, ...]
    """[s since the log was opened]."""
    names: tuple[str, ...]
    values: tuple[tuple[float, ...], ...]
    breaks: tuple[int, ...]
    """Where in `times` another pass begins: lines aren't drawn across."""


class RunSpan(Message):
    """A state from when to when [s since the log was opened]."""

    state: str
    from_s: float
    to_s: float


class RunEvent(Message):
    """Something that was told, at a time [s since the log was opened]."""

    time_s: float
    text: str
    warning: bool


class RunStretch(Message):
    """A value of a signal, from when to when [s]."""

    from_s: float
    to_s: float
    value: float


class RunWait(Message):
    """A wait for an input, from when to when [s]; `met` is true if it came."""

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
    """Where the robot was: for each time [s], the joints [deg or mm]."""

    times: tuple[float, ...]
    joints: tuple[tuple[float, ...], ...]


class RunShown(Message):
    """What a log shows. Lines are thinned: of each of a thousand intervals, the least and the largest value."""

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
    """What can't be relied on, or isn't shown, and why."""
    joints: tuple[RunJoint, ...]
    lines: tuple[RunLines, ...]
    planned: RunLines | None
    """Where the joints were to be; null: not known."""
    states: tuple[RunSpan, ...]
    signals: tuple[RunSignal, ...]
    events: tuple[RunEvent, ...]
    more_events: int
    """Events that aren't here."""
    way: RunWay
