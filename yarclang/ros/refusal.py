"""Why a goal isn't carried out, as people and robot_status are told."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.findings import number_of
from yarclang.runtime.actions import Trouble

UNNAMED = 9999
"""The error code of what has no finding's code: every finding's number is below."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """A reason.

    Attributes:
        code: of a finding; empty: none fits.
        what: one sentence.
        help: what to do; may be empty.
    """

    code: str
    what: str
    help: str = ""

    @property
    def number(self) -> int:
        """The error code of robot_status: the finding's number."""
        number = number_of(self.code)
        return UNNAMED if number is None else number

    def __str__(self) -> str:
        """As a terminal shows it."""
        code = f"[{self.code}] " if self.code else ""
        return f"{code}{self.what}" + (f"\n  help: {self.help}" if self.help else "")


def refusal_of(trouble: Trouble) -> Refusal:
    """Return a trouble as a refusal."""
    return Refusal(trouble.code, trouble.what, trouble.remedy)
