"""Messages about alarms, and about the findings to which their codes refer."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from yarclang.coordinator.messages.message import Message
from yarclang.findings import Severity

MOST_NUMBERS = 1000


class JointAt(Message):
    """Position of a joint [deg or mm]."""

    name: str
    value: float
    unit: str


class AlarmShown(Message):
    """An alarm: the fault, the state of the robot when it occurred, its end, and its acknowledgement. Times
    are in UTC.
    """

    number: int
    time: str
    last: str
    """Time of the alarm's last occurrence."""
    count: int
    """Number of occurrences. Each was at most a minute after the previous one."""
    holds: bool
    ended: str | None
    """Time at which the fault went away; null: it is still present."""
    acknowledged: str | None
    """Time at which a user acknowledged the alarm; null: nobody has."""
    by: str
    """User who has acknowledged the alarm; empty: nobody."""
    source: str
    """Source of the alarm: `state`, `run`, `message`, `motors`, `guard`, `coordinator`, `audit`, `disk`,
    `alarms`.
    """
    code: str
    """Code of the finding (GET /api/findings/CODE); empty: none."""
    title: str
    """Title of the finding; empty: no code."""
    what: str
    remedy: str
    program: str
    """Program or motion that was running; empty: none."""
    file: str
    """The program's file in the project; empty: not known."""
    line: int
    """Line of the command that was executed; 0: not known."""
    command: str
    joints: tuple[JointAt, ...]
    flange: tuple[float, ...] | None
    """Matrix (4, 4) base_from_flange, row by row, lengths in m."""
    owner: str
    """Client that owned the robot; empty: nobody."""


class AlarmList(Message):
    """Alarms, the newest first."""

    alarms: tuple[AlarmShown, ...]
    open: int
    """Number of alarms whose fault is present or that aren't acknowledged."""
    all: int
    """Number of stored alarms."""
    more: bool
    """True if there are more alarms like these than are listed here."""
    version: int
    """Number that changes whenever an alarm changes."""
    trouble: str
    """Reason why alarms exist only in memory; empty: they are written to disk."""


class Acknowledge(Message):
    """Request to acknowledge alarms: those with the given numbers, and all open alarms with numbers up to
    `up_to`.
    """

    numbers: Annotated[
        tuple[int, ...], Field(max_length=MOST_NUMBERS, description=f"at most {MOST_NUMBERS}")
    ] = ()
    up_to: int | None = None


class Acknowledged(Message):
    """Number of newly acknowledged alarms."""

    count: int


class FindingShown(Message):
    """The catalog entry of a finding's code, as `yarc explain` prints it."""

    code: str
    name: str
    severity: Severity
    family: str
    title: str
    why: str
    example: str
    """Example with the error; empty: none."""
    better: str
    """Corrected example; empty: none."""
