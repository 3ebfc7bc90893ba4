"""Find the positions of the keys and values of a TOML text, because tomllib returns values without positions.

The text is one that tomllib accepts, so the scanner only finds positions and checks nothing.
"""

from __future__ import annotations

import bisect

from yarclang.frozen import frozen
from yarclang.source import SourceFile, Span

Path = tuple[str | int, ...]
"""Path of a key or value from the top of the file: keys, and indices (from 0) in arrays."""

_BARE_END = frozenset(" \t\n=.]#,}")
_SCALAR_END = frozenset("\n#,]}")


@frozen
class Places:
    """The positions of the keys and values of a TOML text.

    Attributes:
        keys: position of each key, or of the header of a table.
        values: position of each value.
    """

    keys: dict[Path, Span]
    values: dict[Path, Span]

    def of_value(self, path: Path) -> Span:
        """Return the position of the value at `path`. If this value has no position, return the position of
        the innermost value or key that encloses it.
        """
        return self._nearest(path, (self.values, self.keys))

    def of_key(self, path: Path) -> Span:
        """Return the position of the key at `path`, or of the innermost key that encloses it."""
        return self._nearest(path, (self.keys, self.values))

    def _nearest(self, path: Path, tables: tuple[dict[Path, Span], ...]) -> Span:
        for size in range(len(path), 0, -1):
            for table in tables:
                if path[:size] in table:
                    return table[path[:size]]
        return Span.on_line(1, 1, 1)


def find_places(source: SourceFile) -> Places:
    """Return the positions of all keys and values of a text that tomllib accepts."""
    scanner = _Scanner(source.text.replace("\r\n", "\n"))
    scanner.document()
    return Places(scanner.keys, scanner.values)


class _Scanner:
    """Scanner that finds all positions of a TOML text in one pass. After each method, `at` is the place after
    the text that the method has read.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.starts = [0, *(at + 1 for at, letter in enumerate(text) if letter == "\n")]
        self.keys: dict[Path, Span] = {}
        self.values: dict[Path, Span] = {}
        self.counts: dict[Path, int] = {}

    def document(self) -> None:
        table: Path = ()
        while True:
            self.skip()
            if self.at >= len(self.text):
                return
            if self.text[self.at] == "[":
                table = self.header()
            else:
                self.pair(table)

    def header(self) -> Path:
        """Read a header `[a.b]` or `[[a.b]]`; return the path of its table, with the index in an array of
        tables.
        """
        array = self.text.startswith("[[", self.at)
        self.at += 2 if array else 1
        self.skip()
        start = self.at
        path = self.key((), resolve=True)
        if array:
            number = self.counts.get(path, 0)
            self.counts[path] = number + 1
            end = start + len(self.text[start : self.at].rstrip())
            self.keys.setdefault((*path, number), self.span(start, end))
            path = (*path, number)
        self.at += 2 if array else 1
        return path

    def pair(self, table: Path) -> None:
        """Read `key = value`."""
        path = self.key(table, resolve=False)
        self.at += 1  # the equals sign
        self.skip()
        self.value(path)

    def key(self, table: Path, *, resolve: bool) -> Path:
        """Read a key with or without dots, up to the equals sign or bracket after it, and return its path.

        Args:
            table: path of the table.
            resolve: True for a key in a header. In a header, the name of an array of tables denotes its last
                table.
        """
        path = table
        while True:
            self.skip()
            start = self.at
            if self.text[self.at] in "\"'":
                name = self.string()
            else:
                while self.at < len(self.text) and self.text[self.at] not in _BARE_END:
                    self.at += 1
                name = self.text[start : self.at]
            path = (*path, name)
            self.keys.setdefault(path, self.span(start, self.at))
            self.skip()
            if self.at >= len(self.text) or self.text[self.at] != ".":
                return path
            self.at += 1
            if resolve and path in self.counts:
                path = (*path, self.counts[path] - 1)

    def value(self, path: Path) -> None:
        start = self.at
        letter = self.text[start] if start < len(self.text) else ""
        if letter == "[":
            self.array(path)
        elif letter == "{":
            self.inline_table(path)
        elif letter in ('"', "'"):
            self.string()
        else:
            while self.at < len(self.text) and self.text[self.at] not in _SCALAR_END:
                self.at += 1
        end = self.at
        while end > start and self.text[end - 1] in " \t":
            end -= 1
        self.values[path] = self.span(start, end)

    def array(self, path: Path) -> None:
        self.at += 1
        number = 0
        while self.more("]"):
            self.value((*path, number))
            number += 1

    def inline_table(self, path: Path) -> None:
        self.at += 1
        while self.more("}"):
            self.pair(path)

    def more(self, closing: str) -> bool:
        """Read the commas before an item, or the closing bracket; return True if an item follows."""
        self.skip()
        while self.text.startswith(",", self.at):
            self.at += 1
            self.skip()
        if self.at >= len(self.text) or self.text[self.at] == closing:
            self.at += 1
            return False
        return True

    def string(self) -> str:
        """Read a string of any of the four kinds; return its text, with escapes as they are written."""
        quote = self.text[self.at]
        long = self.text.startswith(quote * 3, self.at)
        mark = quote * 3 if long else quote
        self.at += len(mark)
        start = self.at
        while self.at < len(self.text) and not self.text.startswith(mark, self.at):
            self.at += 2 if quote == '"' and self.text[self.at] == "\\" else 1
        content = self.text[start : self.at]
        self.at += len(mark)
        while long and self.text.startswith(quote, self.at):  # a long string may end in up to two quotes
            self.at += 1
        return content

    def skip(self) -> None:
        """Skip blanks, line ends and comments in the text."""
        while self.at < len(self.text):
            if self.text[self.at] == "#":
                end = self.text.find("\n", self.at)
                self.at = len(self.text) if end < 0 else end
            elif self.text[self.at] in " \t\n":
                self.at += 1
            else:
                return

    def span(self, start: int, end: int) -> Span:
        line, column = self.place(start)
        end_line, end_column = self.place(end)
        return Span(line, column, end_line, end_column)

    def place(self, at: int) -> tuple[int, int]:
        line = bisect.bisect_right(self.starts, at)
        return line, at - self.starts[line - 1] + 1
