"""An alarm as a record."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

Source = Literal["state", "run", "message", "motors", "guard", "coordinator", "audit", "disk", "alarms"]
"""Who tells of an alarm. All that one source tells at a time holds at that time, except for `run` and `message`: those only happen."""

MOST_WHAT, MOST_REMEDY, MOST_NAME = 2000, 1000, 300
"""Longest texts of an alarm [characters]."""


@dataclass(frozen=True, slots=True)
class Raised:
    """Something that is wrong.

    Attributes:
        source: who tells it.
        what: what is wrong and why, in words.
        code: of the finding; empty: it is none.
        remedy: what to do; empty: not known.
    """

    source: Source
    what: str
    code: str = ""
    remedy: str = ""

    @property
    def key(self) -> tuple[str, str]:
        """By which the same alarm is known again."""
        return self.source, self.what

    def cleaned(self) -> Raised:
        """Return it with texts that can be shown and have a bounded length."""
        return Raised(
            self.source,
            printable(self.what, MOST_WHAT) or "nobody says what",
            printable(self.code, 10),
            printable(self.remedy, MOST_REMEDY),
        )

    def with_more(self, other: Raised) -> Raised:
        """Return it with what another one tells of the same thing: the longer text, and the code and the remedy if they are missing."""
        longer = other.what if len(other.what) > len(self.what) else self.what
        return replace(self, what=longer, code=self.code or other.code, remedy=self.remedy or other.remedy)


@dataclass(frozen=True, slots=True)
class Stood:
    """Where the robot was when something happened.

    Attributes:
        program: what was under way; empty: nothing was.
        file: its file in the project; empty: not known.
        line: of the command, from 1; 0: not known.
        command: that was carried out.
        joints: by their names, with the unit [deg or mm]; empty: not known.
        flange: (16,) base_from_flange, row by row [m]; None: not known.
        owner: who owned the robot; empty: nobody.
    """

    program: str = ""
    file: str = ""
    line: int = 0
    command: str = ""
    joints: tuple[tuple[str, float, str], ...] = ()
    flange: tuple[float, ...] | None = None
    owner: str = ""

    def with_more(self, other: Stood) -> Stood:
        """Return it with the command and the line that another one knows: the end of a program tells which one a fault is about."""
        return replace(self, command=other.command or self.command, line=other.line or self.line)


@dataclass(frozen=True, slots=True)
class Alarm:
    """What happened, when and where, and what became of it. Times are those of day [s since 1970].

    Attributes:
        number: from 1, in the order in which alarms came.
        raised: what is wrong.
        stood: where the robot was.
        time: when it came first.
        last: when it came last.
        count: how often it came.
        ended: since when it doesn't hold any more; None: it holds.
        acknowledged: when somebody did; None: nobody has.
        by: who has acknowledged it.
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
        """True as long as what is wrong is."""
        return self.ended is None

    @property
    def is_open(self) -> bool:
        """True if it holds, or nobody has acknowledged it."""
        return self.holds or self.acknowledged is None


def printable(text: str, most: int) -> str:
    """Return a text in one line without characters that can't be seen or turn the direction of writing, cut to a length."""
    cut = text[: most + 1]
    shown = "".join(one if one.isprintable() else " " for one in cut).strip()
    return shown if len(shown) <= most else f"{shown[: most - 1]}…"
