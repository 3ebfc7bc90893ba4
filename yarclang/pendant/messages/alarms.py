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
    """An alarm: the fault, the state of the robot at that time, and its end or acknowledgement. Times are in
    UTC.
    """

    number: int
    time: str
    last: str
    """Time of its last occurrence."""
    count: int
    """Number of occurrences, each at most a minute after the one before."""
    holds: bool
    ended: str | None
    """Time at which the cause of the alarm went away; null: it still holds."""
    acknowledged: str | None
    """Time of its acknowledgement; null: not acknowledged."""
    by: str
    """User who has acknowledged it; empty: nobody."""
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
    """Motion or program under way; empty: none."""
    file: str
    """The program's file in the project; empty: not known."""
    line: int
    """Line of the command that was executed; 0: not known."""
    command: str
    joints: tuple[JointAt, ...]
    flange: tuple[float, ...] | None
    """Matrix (4, 4) base_from_flange, row by row, lengths in m."""
    owner: str
    """Owner of the robot; empty: nobody."""


class AlarmList(Message):
    """Alarms, the newest first."""

    alarms: tuple[AlarmShown, ...]
    open: int
    """Number of alarms that hold or aren't acknowledged."""
    all: int
    """Number of stored alarms."""
    more: bool
    """True if there are more alarms of this kind than listed here."""
    version: int
    """Number that changes whenever an alarm changes."""
    trouble: str
    """Reason why alarms exist only in memory; empty: they are written to disk."""


class Acknowledge(Message):
    """Alarms to acknowledge: those with the given numbers, and all open alarms up to the number `up_to`."""

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
