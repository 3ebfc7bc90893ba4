"""Records of alarms."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

Source = Literal["state", "run", "message", "motors", "guard", "coordinator", "audit", "disk", "alarms"]
"""Origin of an alarm. The sources `run` and `message` report single events. Each other source reports the
list of all its faults that are present at the moment.
"""

MOST_WHAT, MOST_REMEDY, MOST_NAME = 2000, 1000, 300
"""Longest texts of an alarm: its fault, its remedy, and names [characters]."""


@dataclass(frozen=True, slots=True)
class Raised:
    """The cause of an alarm.

    Attributes:
        source: origin of the alarm.
        what: the fault and its reason, in words.
        code: code of the finding; empty if there is none.
        remedy: what the user should do; empty if unknown.
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
        """Return the cause with texts that are printable and not too long."""
        return Raised(
            self.source,
            printable(self.what, MOST_WHAT) or "no reason given",
            printable(self.code, 10),
            printable(self.remedy, MOST_REMEDY),
        )

    def with_more(self, other: Raised) -> Raised:
        """Return this cause, completed by a second report of the same fault. The longer of the two
        descriptions is used. The code or remedy of the other report is used if this cause has none.
        """
        longer = other.what if len(other.what) > len(self.what) else self.what
        return replace(self, what=longer, code=self.code or other.code, remedy=self.remedy or other.remedy)


@dataclass(frozen=True, slots=True)
class Stood:
    """State of the robot when an alarm occurred.

    Attributes:
        program: the running program; empty if none was running.
        file: file of the program in the project; empty if unknown.
        line: line of the command in the program, from 1; 0 if unknown.
        command: the command that was being executed.
        joints: name, position and unit of each joint [deg or mm]; empty if unknown.
        flange: pose of the flange in {B} as the 16 entries of a 4x4 matrix, row by row [m]; None if unknown.
        owner: name of the client that owned the robot; empty if nobody.
    """

    program: str = ""
    file: str = ""
    line: int = 0
    command: str = ""
    joints: tuple[tuple[str, float, str], ...] = ()
    flange: tuple[float, ...] | None = None
    owner: str = ""

    def with_more(self, other: Stood) -> Stood:
        """Return this state with the command and line of `other`, if `other` contains them. Often only the
        event at the end of a program says at which command a fault occurred.
        """
        return replace(self, command=other.command or self.command, line=other.line or self.line)


@dataclass(frozen=True, slots=True)
class Alarm:
    """An alarm with its history. All times are wall-clock times [s since 1970].

    Attributes:
        number: number of the alarm, counted from 1 in the order in which alarms occur.
        raised: cause of the alarm.
        stood: state of the robot when the alarm occurred.
        time: time of the first occurrence.
        last: time of the last occurrence.
        count: number of occurrences.
        ended: time at which the fault went away; None while it is present.
        acknowledged: time at which a user acknowledged the alarm; None if nobody has.
        by: name of the user who has acknowledged the alarm; empty if nobody has.
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
        """True while the fault of the alarm is present."""
        return self.ended is None

    @property
    def is_open(self) -> bool:
        """True if the fault is still present, or the alarm hasn't been acknowledged."""
        return self.holds or self.acknowledged is None


def printable(text: str, most: int) -> str:
    """Return a text as one line of at most `most` characters, without invisible characters and without
    control characters, such as those that change the writing direction.
    """
    cut = text[: most + 1]
    shown = "".join(one if one.isprintable() else " " for one in cut).strip()
    return shown if len(shown) <= most else f"{shown[: most - 1]}…"
