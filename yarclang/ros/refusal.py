"""Reasons why a goal isn't run, for the terminal and for robot_status."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.findings import number_of
from yarclang.runtime.actions import Trouble

UNNAMED = 9999
"""Error code of a refusal that isn't caused by a finding, and so has no finding's code. The numbers of all
findings are smaller.
"""


@dataclass(frozen=True, slots=True)
class Refusal:
    """Reason why a goal isn't run.

    Attributes:
        code: code of the finding (an error that yarclang reports); empty if there is none.
        what: the reason, in one sentence.
        help: the remedy; may be empty.
    """

    code: str
    what: str
    help: str = ""

    @property
    def number(self) -> int:
        """Error code of robot_status: the finding's number."""
        number = number_of(self.code)
        return UNNAMED if number is None else number

    def __str__(self) -> str:
        """Format the reason for a terminal."""
        code = f"[{self.code}] " if self.code else ""
        return f"{code}{self.what}" + (f"\n  help: {self.help}" if self.help else "")


def refusal_of(trouble: Trouble) -> Refusal:
    """Convert an exception of the coordinator to a refusal of a goal."""
    return Refusal(trouble.code, trouble.what, trouble.remedy)
