"""The mistakes of mistakes.txt, which says how they are written."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

HEAD = "DEFAULT {TCP} [5] (mm,deg,s) {B}"
TAKEN = "-"
"""Instead of words: the language takes it as it is."""


@dataclass(frozen=True)
class Mistake:
    """One mistake.

    Attributes:
        name: what it is, in short.
        lines: the program, with the place between « and ».
        says: what a good answer says: of each group of alternatives one.
        repair: what stands instead of the marked line after the one likely repair; empty: none is likely, or
            more than one.
    """

    name: str
    lines: tuple[str, ...]
    says: tuple[tuple[str, ...], ...]
    repair: tuple[str, ...]

    @property
    def is_taken(self) -> bool:
        """Whether it is no mistake: the language takes it."""
        return self.says == ((TAKEN,),)

    @property
    def text(self) -> str:
        """The program without its mark."""
        return "\n".join(self.lines).replace("«", "").replace("»", "") + "\n"

    @property
    def place(self) -> tuple[int, int, int, int]:
        """Line, column, end line and end column of the mark."""
        row = next(row for row, line in enumerate(self.lines) if "«" in line)
        begin = self.lines[row].index("«")
        return row + 1, begin + 1, row + 1, self.lines[row].index("»")

    @property
    def repaired(self) -> str | None:
        """The program after the one likely repair."""
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
