"""How much of a program's loops and calls is carried out: all of it, unless there are errors, or only a first look is wanted."""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.diagnostics import Collector, has_errors
from yarclang.progress import tell

ENOUGH_WITH_ERRORS = 10_000
"""Lines in loops and SUBs that are carried out of a program with errors."""

ENOUGH_WITH_SYNTAX_ERRORS = 1_000
"""The same of a program with lines that can't be read: nobody knows what these would do in a loop."""

_EVERY = 64
"""Lines between two looks at the findings."""


class Extent:
    """Counts the lines that are carried out.

    Once there are enough of them, a loop makes no further round, and a SUB is carried out once more at most.

    Args:
        collectors: the findings of each file so far.
        enough: lines in loops and SUBs, whatever is found; None: all of them.
    """

    def __init__(self, collectors: Sequence[Collector], enough: int | None) -> None:
        self.is_reached = False
        """True if there are enough lines."""
        self._collectors = collectors
        self._enough = enough
        self._looked_at: dict[Collector, int] = {}
        self._lines = 0
        self._again = 0
        self._expected = 0
        self._next = _EVERY

    def add(self, lines: int, *, again: bool) -> None:
        """Count some lines; `again` if they are in a loop or a SUB, and so may be carried out often."""
        self._lines += lines
        if again:
            self._again += lines
        if self._lines >= self._next:
            self._look()

    def expect(self, lines: int) -> None:
        """Take it that so many lines follow."""
        self._expected = self._lines + lines

    def expect_syntax_errors(self) -> None:
        """Take it that there are lines that can't be read."""
        self._limit(ENOUGH_WITH_SYNTAX_ERRORS)

    def reach(self) -> None:
        """Take it that there are enough lines."""
        self.is_reached = True

    def _look(self) -> None:
        self._next = self._lines + _EVERY
        # outside of loops and SUBs nobody has counted what follows
        tell("checking", self._lines, self._expected if self._expected > self._lines else 0)
        if any(map(self._has_new_errors, self._collectors)):
            self._limit(ENOUGH_WITH_ERRORS)
        if self._enough is not None and self._again > self._enough:
            self.reach()

    def _has_new_errors(self, collector: Collector) -> bool:
        known = self._looked_at.get(collector, 0)
        self._looked_at[collector] = len(collector.found)
        return has_errors(collector.found[known:])

    def _limit(self, enough: int) -> None:
        self._enough = enough if self._enough is None else min(enough, self._enough)
