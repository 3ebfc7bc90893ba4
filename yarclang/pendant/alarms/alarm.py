"""Records of alarms."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

Source = Literal["state", "run", "message", "motors", "guard", "coordinator", "audit", "disk", "alarms"]
"""Origin of an alarm. `run` and `message` report events; each other source reports all of its alarms that
hold at the time.
"""

MOST_WHAT, MOST_REMEDY, MOST_NAME = 2000, 1000, 300
"""Longest texts of an alarm: its fault, its remedy, and names [characters]."""


@dataclass(frozen=True, slots=True)
class Raised:
    """The cause of an alarm.

    Attributes:
        source: its origin.
        what: what is wrong and why, in words.
        code: code of the finding; empty if there is none.
        remedy: what to do; empty if unknown.
    """

    source: Source
    what: str
    code: str = ""
    remedy: str = ""

    @property
    def key(self) -> tuple[str, str]:
        """Key by which a repeated alarm is recognized."""
        return self.source, self.what

    def cleaned(self) -> Raised:
        """Return the cause with printable texts of limited length."""
        return Raised(
            self.source,
            printable(self.what, MOST_WHAT) or "no reason given",
            printable(self.code, 10),
            printable(self.remedy, MOST_REMEDY),
        )

    def with_more(self, other: Raised) -> Raised:
        """Return the cause with details from a second report: the longer text, and the code or remedy if it
        was missing.
        """
        longer = other.what if len(other.what) > len(self.what) else self.what
        return replace(self, what=longer, code=self.code or other.code, remedy=self.remedy or other.remedy)


@dataclass(frozen=True, slots=True)
class Stood:
    """State of the robot at an alarm.

    Attributes:
        program: the running program; empty if none was running.
        file: its file in the project; empty if unknown.
        line: line of the command, from 1; 0 if unknown.
        command: the command that was executed.
        joints: name, position and unit of each joint [deg or mm]; empty if unknown.
        flange: (16,) base_from_flange, row by row [m]; None if unknown.
        owner: the owner of the robot; empty if nobody.
    """

    program: str = ""
    file: str = ""
    line: int = 0
    command: str = ""
    joints: tuple[tuple[str, float, str], ...] = ()
    flange: tuple[float, ...] | None = None
    owner: str = ""

    def with_more(self, other: Stood) -> Stood:
        """Return the state, with a missing command and line taken from another state. The event at the end of
        a program names the command at which a fault occurred.
        """
        return replace(self, command=other.command or self.command, line=other.line or self.line)


@dataclass(frozen=True, slots=True)
class Alarm:
    """An alarm with its history. Times are of day [s since 1970].

    Attributes:
        number: number of the alarm, from 1, in the order of the alarms.
        raised: its cause.
        stood: the state of the robot.
        time: time of the first occurrence.
        last: time of the last occurrence.
        count: number of occurrences.
        ended: time at which the cause went away; None while it holds.
        acknowledged: time of the acknowledgement; None if there is none.
        by: the user who has acknowledged it.
    """

    number: int
    raised: Raised
    stood: Stood
    time: float
    last: float
    count: int = 1
    ended: float | None = None
    acknowledged: float | None = None
    by: str = ""

    @property
    def holds(self) -> bool:
        """True while the cause of the alarm holds."""
        return self.ended is None

    @property
    def is_open(self) -> bool:
        """True if the alarm holds or hasn't been acknowledged."""
        return self.holds or self.acknowledged is None


def printable(text: str, most: int) -> str:
    """Return a text as one line of at most `most` characters, without invisible characters and without
    control characters for the writing direction.
    """
    cut = text[: most + 1]
    shown = "".join(one if one.isprintable() else " " for one in cut).strip()
    return shown if len(shown) <= most else f"{shown[: most - 1]}…"
