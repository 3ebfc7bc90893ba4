"""Which lines of a text an edit has left alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Unchanged:
    """The lines that two texts have in common: so many at their beginnings (`first`) and at their ends (`last`), of `before` and `after`
    lines.
    """

    first: int
    last: int
    before: int
    after: int

    def now(self, line: int) -> int | None:
        """Where a line of the older text is in the newer one; None where it was changed."""
        if line <= self.first:
            return line
        return line + self.after - self.before if line > self.before - self.last else None

    def then(self, line: int) -> int | None:
        """Where a line of the newer text was in the older one; None where it was changed."""
        return Unchanged(self.first, self.last, self.after, self.before).now(line)


def unchanged(before: Sequence[str], after: Sequence[str]) -> Unchanged:
    """Compare the lines of an older and a newer text."""
    shortest = min(len(before), len(after))
    first = next((n for n in range(shortest) if before[n] != after[n]), shortest)
    rest = shortest - first
    last = next((n for n in range(rest) if before[-1 - n] != after[-1 - n]), rest)
    return Unchanged(first, last, len(before), len(after))
