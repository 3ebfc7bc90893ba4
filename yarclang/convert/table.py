"""Read CSV texts: divide a text into the cells of a table, and read the numbers in the cells."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from yarclang.diagnostics import Collector
from yarclang.hir import Array
from yarclang.source import SourceFile, Span

DELIMITERS = (";", "\t", ",")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_COMMA = re.compile(r"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?", re.ASCII)
LARGEST = 1e9
"""Largest absolute value of a number."""


@dataclass(frozen=True, slots=True)
class Table:
    """The cells of a CSV table.

    Attributes:
        source: the file.
        delimiter: its delimiter.
        header: cells of the header.
        header_line: line of the header.
        rows: cells of the rows; each row has as many cells as the header.
        lines: line of each row.
    """

    source: SourceFile
    delimiter: str
    header: tuple[str, ...]
    header_line: int
    rows: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...]

    def line_span(self, row: int) -> Span:
        """Return the position of a row's line in the text."""
        return self.source.whole_line(self.lines[row])


def read_table(source: SourceFile, findings: Collector) -> Table | None:
    """Read the cells of a CSV text; return None, with a finding, if it has mistakes.

    The first line with text is the header. It may begin with #. All later lines that are empty or begin with
    # are ignored.
    """
    lines = list(source.lines)
    first = next((number for number, line in enumerate(lines) if line.strip(" \t#;,")), None)
    if first is None:
        findings.add("Y1504", "the table is empty", None, "check which file was given")
        return None
    lines[first] = lines[first].lstrip().removeprefix("#")
    delimiter = max(DELIMITERS, key=lines[first].count)
    header: tuple[str, ...] = ()
    rows: list[tuple[str, ...]] = []
    numbers: list[int] = []
    ragged: list[tuple[int, int]] = []
    reader = csv.reader((f"{line}\n" for line in lines[first:]), delimiter=delimiter, strict=True)
    try:
        for cells in reader:
            row = tuple(cell.strip() for cell in cells)
            if not any(row) or (header and row[0].startswith("#")):
                continue
            if not header:
                header = row
                continue
            while len(row) > len(header) and not row[-1]:
                row = row[:-1]
            if len(row) != len(header):
                ragged.append((first + reader.line_num, len(row)))
                continue
            rows.append(row)
            numbers.append(first + reader.line_num)
    except csv.Error as error:
        line = first + reader.line_num
        findings.add(
            "Y1504",
            f"the table can't be read from here on: {error}",
            source.whole_line(line),
            "check for a quote that isn't closed",
        )
        return None
    if ragged:
        line, count = ragged[0]
        more = _more(len(ragged), "line")
        message = f"this line has {count} cell{'s' * (count != 1)}, but the header has {len(header)}{more}"
        findings.add("Y1504", message, source.whole_line(line), "give every line one cell for each column")
        return None
    if not rows:
        span = source.whole_line(first + 1)
        findings.add("Y1504", "the table has a header but no row", span, "check which file was given")
        return None
    return Table(source, delimiter, header, first + 1, tuple(rows), tuple(numbers))


def numbers_of(table: Table, columns: Sequence[int], findings: Collector) -> Array | None:
    """Return columns of a table as numbers (rows, columns). A decimal comma is allowed if the delimiter isn't
    a comma.

    Return None, with a finding, if cells aren't numbers. The finding is at the first of these cells, and
    states how many others there are.
    """
    values = np.empty((len(table.rows), len(columns)))
    bad: list[tuple[int, int]] = []
    commas: tuple[int, int] | None = None
    points: tuple[int, int] | None = None
    for at, column in enumerate(columns):
        for number, row in enumerate(table.rows):
            cell = row[column]
            if _NUMBER.fullmatch(cell):
                if "." in cell and points is None:
                    points = number, column
            elif table.delimiter != "," and _COMMA.fullmatch(cell):
                if commas is None:
                    commas = number, column
                cell = cell.replace(",", ".")
            else:
                bad.append((number, column))
                continue
            value = float(cell)
            if abs(value) > LARGEST:
                bad.append((number, column))
            values[number, at] = value
    if bad:
        number, column = min(bad)
        cell = table.rows[number][column]
        shown = f"{cell[:40]!r}" if cell else "an empty cell"
        message = f"{shown} in column {table.header[column]!r} isn't a number{_more(len(bad), 'cell')}"
        help_ = f"write finite numbers up to {LARGEST:g} without a unit; units go into the header"
        findings.add("Y1505", message, table.line_span(number), help_)
        return None
    if commas and points:
        comma, point = (table.rows[number][column] for number, column in (commas, points))
        message = (
            f"numbers are written both with a decimal comma ({comma}) and with a decimal point ({point})"
        )
        help_ = "write all with a point, and without separators of thousands"
        findings.add("Y1505", message, table.line_span(commas[0]), help_)
        return None
    return values


def _more(count: int, what: str) -> str:
    """Return the end of a message about a mistake that states how many further cells or lines have this
    mistake; empty if there are none.
    """
    return f" (and {count - 1:,} more {what}{'s' * (count > 2)})" if count > 1 else ""
