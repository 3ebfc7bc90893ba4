"""What was looked at on a controller before anything moves: what was found and wanted, and the remedy where they differ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from yarclang.robot.model import Array

Kind = Literal["number", "bits", "definition", "address", "listing"]
Verdict = Literal["ok", "warning", "error"]


@dataclass(frozen=True, slots=True)
class Item:
    """One thing that the controller must have been told.

    `question` is asked; `wanted` is what it should answer, compared as `kind` says: as a number, by its bits (all that are
    wanted are set), as an axis definition, as the address of an M-variable, or as a program's listing.
    """

    subject: str
    question: str
    wanted: str
    kind: Kind
    remedy: str


@dataclass(frozen=True, slots=True)
class Checked:
    """What was found of one thing."""

    subject: str
    found: str
    wanted: str
    verdict: Verdict
    remedy: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Inspection:
    """All that was looked at. `joints` (n,) [rad or m] is where the robot is commanded to be, if that is known; `idle`: no program runs."""

    checked: tuple[Checked, ...]
    joints: Array | None
    idle: bool = True

    @property
    def errors(self) -> tuple[Checked, ...]:
        """What keeps a program from being run."""
        return tuple(one for one in self.checked if one.verdict == "error")
