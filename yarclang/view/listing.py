"""A long list of which a few rows are shown: those that have a word, page by page."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass(slots=True)
class Listing:
    """`rows` of which `size` are shown at a time; `word` chooses those that have it, in any case."""

    rows: Sequence[str]
    size: int
    word: str = ""
    page: int = 0
    chosen: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.choose(self.word)

    @property
    def pages(self) -> int:
        """How many pages there are; at least one."""
        return max(-(-len(self.chosen) // self.size), 1)

    @property
    def shown(self) -> list[int]:
        """The numbers of the rows on the page."""
        first = self.page * self.size
        return self.chosen[first : first + self.size]

    def choose(self, word: str) -> None:
        """Show the rows that have a word, from the first page."""
        self.word, self.page = word.strip(), 0
        lower = self.word.lower()
        self.chosen = [number for number, row in enumerate(self.rows) if lower in row.lower()]

    def turn(self, pages: int) -> None:
        """Turn pages, not beyond the ends."""
        self.page = min(max(self.page + pages, 0), self.pages - 1)

    def follow(self, row: int) -> None:
        """Turn to the page that has a row; where no row of that number was chosen, stay."""
        at = bisect_left(self.chosen, row)
        if at < len(self.chosen) and self.chosen[at] == row:
            self.page = at // self.size
