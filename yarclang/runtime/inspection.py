"""Results of the checks of a controller before anything moves: the found value and the required value of each
setting, and the remedy for each difference.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from yarclang.robot.model import Array

Kind = Literal["number", "bits", "definition", "address", "listing"]
Verdict = Literal["ok", "warning", "error"]


@dataclass(frozen=True, slots=True)
class Item:
    """A setting that the controller must have.

    Attributes:
        subject: the setting, in words.
        question: the line that asks the controller for the setting.
        wanted: the expected answer.
        kind: how answers are compared: as a number, by its bits (all wanted bits are set), as an axis
            definition, as the address of an M-variable, or as the listing of a program.
        remedy: what to do if the answer differs.
    """

    subject: str
    question: str
    wanted: str
    kind: Kind
    remedy: str


@dataclass(frozen=True, slots=True)
class Checked:
    """The result of one check: the found and the required value of a setting or a state, and the verdict."""

    subject: str
    found: str
    wanted: str
    verdict: Verdict
    remedy: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Inspection:
    """All results of an inspection of the controller.

    `joints` (n,) [rad or m] is the commanded position of the robot; None if it isn't known. `idle` is True if
    no program runs.
    """

    checked: tuple[Checked, ...]
    joints: Array | None
    idle: bool = True

    @property
    def errors(self) -> tuple[Checked, ...]:
        """Return the results that prevent a program from being run."""
        return tuple(one for one in self.checked if one.verdict == "error")
