"""Find the lines of a text that an edit has left unchanged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Unchanged:
    """The lines that an older and a newer text have in common.

    Attributes:
        first: number of common lines at the beginning.
        last: number of common lines at the end.
        before: number of lines of the older text.
        after: number of lines of the newer text.
    """

    first: int
    last: int
    before: int
    after: int

    def now(self, line: int) -> int | None:
        """Convert the number of a line in the older text to its number in the newer text; None if the line
        was changed.
        """
        if line <= self.first:
            return line
        return line + self.after - self.before if line > self.before - self.last else None

    def then(self, line: int) -> int | None:
        """Convert the number of a line in the newer text to its number in the older text; None if the line
        was changed.
        """
        return Unchanged(self.first, self.last, self.after, self.before).now(line)


def unchanged(before: Sequence[str], after: Sequence[str]) -> Unchanged:
    """Compare the lines of an older and a newer text."""
    shortest = min(len(before), len(after))
    first = next((n for n in range(shortest) if before[n] != after[n]), shortest)
    rest = shortest - first
    last = next((n for n in range(rest) if before[-1 - n] != after[-1 - n]), rest)
    return Unchanged(first, last, len(before), len(after))
