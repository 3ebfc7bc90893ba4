"""Show a long list page by page, filtered by a word."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass(slots=True)
class Listing:
    """A long list, shown page by page and filtered by a word.

    Attributes:
        rows: all rows.
        size: number of rows on a page.
        word: filter: only rows that contain this word are shown, regardless of case.
        page: number of the shown page, from 0.
        chosen: numbers of the rows that contain the word.
    """

    rows: Sequence[str]
    size: int
    word: str = ""
    page: int = 0
    chosen: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.choose(self.word)

    @property
    def pages(self) -> int:
        """Return the number of pages, at least one."""
        return max(-(-len(self.chosen) // self.size), 1)

    @property
    def shown(self) -> list[int]:
        """Return the numbers of the rows on the current page."""
        first = self.page * self.size
        return self.chosen[first : first + self.size]

    def choose(self, word: str) -> None:
        """Show the rows that contain a word, beginning with the first page."""
        self.word, self.page = word.strip(), 0
        lower = self.word.lower()
        self.chosen = [number for number, row in enumerate(self.rows) if lower in row.lower()]

    def turn(self, pages: int) -> None:
        """Turn a number of pages, but not beyond the first or the last page."""
        self.page = min(max(self.page + pages, 0), self.pages - 1)

    def follow(self, row: int) -> None:
        """Turn to the page with a row. If the row is filtered out, don't turn."""
        at = bisect_left(self.chosen, row)
        if at < len(self.chosen) and self.chosen[at] == row:
            self.page = at // self.size
