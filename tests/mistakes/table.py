"""The mistakes of mistakes.txt, which explains their format."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

HEAD = "DEFAULT {TCP} [5] (mm,deg,s) {B}"
TAKEN = "-"
"""Stands in place of required words if the language accepts the text as it is."""


@dataclass(frozen=True)
class Mistake:
    """A mistake of the table.

    Attributes:
        name: short description.
        lines: lines of the program, with the place of the mistake between « and ».
        says: groups of alternative words; a good answer contains one of each group.
        repair: lines that replace the marked line in the one likely repair; empty if none is likely, or if
            more than one is.
    """

    name: str
    lines: tuple[str, ...]
    says: tuple[tuple[str, ...], ...]
    repair: tuple[str, ...]

    @property
    def is_taken(self) -> bool:
        """True if the text is no mistake, because the language accepts it."""
        return self.says == ((TAKEN,),)

    @property
    def text(self) -> str:
        """The program without the marks « and »."""
        return "\n".join(self.lines).replace("«", "").replace("»", "") + "\n"

    @property
    def place(self) -> tuple[int, int, int, int]:
        """Line, column, end line and end column of the marked place."""
        row = next(row for row, line in enumerate(self.lines) if "«" in line)
        begin = self.lines[row].index("«")
        return row + 1, begin + 1, row + 1, self.lines[row].index("»")

    @property
    def repaired(self) -> str | None:
        """The program after the one likely repair, or None."""
        if not self.repair:
            return None
        row = self.place[0] - 1
        return "\n".join((*self.lines[:row], *self.repair, *self.lines[row + 1 :])) + "\n"


def _read(block: str) -> Mistake:
    title, *lines = block.split("\n")
    name, _, words = title.partition(": ")
    program = tuple(line for line in lines if not line.startswith("=> "))
    program = program[1:] if program[0] == "bare" else (HEAD, *program)
    says = tuple(tuple(group.split("|")) for group in words.split(" & "))
    return Mistake(name, program, says, tuple(line[3:] for line in lines if line.startswith("=> ")))


_BLOCKS = Path(__file__).with_name("mistakes.txt").read_text(encoding="utf-8").strip("\n").split("\n\n")

MISTAKES = tuple(_read(block) for block in _BLOCKS[2:] if not block.startswith("# "))
