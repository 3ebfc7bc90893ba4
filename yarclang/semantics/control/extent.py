"""Limit how many lines of loops and calls are carried out.

A program without errors is carried out completely, unless the caller asks only for a quick check.
"""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.diagnostics import Collector, has_errors
from yarclang.progress import tell

ENOUGH_WITH_ERRORS = 10_000
"""Number of lines in loops and SUBs that are carried out in a program with errors."""

ENOUGH_WITH_SYNTAX_ERRORS = 1_000
"""Number of lines in loops and SUBs after which carrying out stops in a program with syntax errors. It is
lower than for other errors, since the effect of a line that can't be parsed is unknown.
"""

_EVERY = 64
"""Number of lines after which the findings are checked for errors again."""


class Extent:
    """Counter of the lines that are carried out, with a limit.

    After the limit is reached, a loop starts no further round, and each SUB is carried out at most once more.

    Args:
        collectors: the findings of each file so far.
        enough: limit of lines in loops and SUBs that also applies without errors; None: no limit.
    """

    def __init__(self, collectors: Sequence[Collector], enough: int | None) -> None:
        self.is_reached = False
        """True after the limit is reached."""
        self._collectors = collectors
        self._enough = enough
        self._looked_at: dict[Collector, int] = {}
        self._lines = 0
        self._again = 0
        self._expected = 0
        self._next = _EVERY

    def add(self, lines: int, *, again: bool) -> None:
        """Count lines.

        Args:
            lines: number of lines.
            again: True for lines in a loop or a SUB, which may be carried out often.
        """
        self._lines += lines
        if again:
            self._again += lines
        if self._lines >= self._next:
            self._look()

    def expect(self, lines: int) -> None:
        """Set the number of lines that follow, for progress reports."""
        self._expected = self._lines + lines

    def expect_syntax_errors(self) -> None:
        """Apply the limit of programs with syntax errors."""
        self._limit(ENOUGH_WITH_SYNTAX_ERRORS)

    def reach(self) -> None:
        """Treat the limit as reached."""
        self.is_reached = True

    def _look(self) -> None:
        self._next = self._lines + _EVERY
        # The number of lines that follow is known only in loops and SUBs. Elsewhere, report a total of 0.
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
