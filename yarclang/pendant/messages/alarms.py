"""What is said of alarms, and of the findings that their codes name."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from yarclang.coordinator.messages.message import Message
from yarclang.findings import Severity

MOST_NUMBERS = 1000


class JointAt(Message):
    """Where a joint was [deg or mm]."""

    name: str
    value: float
    unit: str


class AlarmShown(Message):
    """An alarm: what went wrong, where the robot was, and what became of it. Times are in UTC."""

    number: int
    time: str
    last: str
    """When it came last."""
    count: int
    """How often it came: the same within a minute is counted."""
    holds: bool
    ended: str | None
    """Since when it doesn't hold any more; null: it holds."""
    acknowledged: str | None
    """When somebody acknowledged it; null: nobody has."""
    by: str
    """Who has acknowledged it; empty: nobody."""
    source: str
    """Who tells of it: `state`, `run`, `message`, `motors`, `guard`, `coordinator`, `audit`, `disk`, `alarms`."""
    code: str
    """Of the finding (GET /api/findings/CODE); empty: it is none."""
    title: str
    """What the code means; empty: there is none."""
    what: str
    remedy: str
    program: str
    """What was under way; empty: nothing was."""
    file: str
    """The program's file in the project; empty: not known."""
    line: int
    """Of the command that was carried out; 0: not known."""
    command: str
    joints: tuple[JointAt, ...]
    flange: tuple[float, ...] | None
    """(4, 4) base_from_flange, row by row [m]."""
    owner: str
    """Who owned the robot; empty: nobody."""


class AlarmList(Message):
    """Alarms, the newest first."""

    alarms: tuple[AlarmShown, ...]
    open: int
    """How many hold or nobody has acknowledged."""
    all: int
    """How many are kept."""
    more: bool
    """True if there are more of these."""
    version: int
    """Another number if any alarm is another one."""
    trouble: str
    """Why alarms can't be written: they are only in memory then; empty: they are written."""


class Acknowledge(Message):
    """Alarms to acknowledge: those of the numbers, and all open ones up to the number `up_to`."""

    numbers: Annotated[
        tuple[int, ...], Field(max_length=MOST_NUMBERS, description=f"at most {MOST_NUMBERS}")
    ] = ()
    up_to: int | None = None


class Acknowledged(Message):
    """How many alarms nobody had acknowledged before."""

    count: int


class FindingShown(Message):
    """What the catalogue says of a code, as `yarc explain`."""

    code: str
    name: str
    severity: Severity
    family: str
    title: str
    why: str
    example: str
    """What is wrong; empty: there is no example."""
    better: str
    """What to write instead; empty: there is no example."""
