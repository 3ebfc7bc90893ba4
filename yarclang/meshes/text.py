"""Numbers in the lines of large text files. They are read into arrays piece by piece, to bound memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

_PIECE = 8_000_000
"""Bytes that are read at once."""


def pieces(content: bytes) -> Iterator[bytes]:
    """Yield the content of a file in blocks that end at line ends."""
    at = 0
    while at < len(content):
        end = content.find(b"\n", at + _PIECE) + 1
        yield content[at : end or len(content)]
        at = end or len(content)


def numbers(text: bytes) -> NDArray[np.float64] | None:
    """Return the numbers of a text, separated by blanks; None if a word isn't a number."""
    return _read(text, np.dtype(np.float64))


def integers(text: bytes) -> NDArray[np.int64] | None:
    """Return the integers of a text, separated by blanks; None if a word isn't an integer.

    Integers beyond 64 bits saturate.
    """
    return _read(text, np.dtype(np.int64))


def _read(text: bytes, kind: np.dtype[Any]) -> NDArray[Any] | None:
    words = _words(text)
    try:
        found: NDArray[Any] = np.fromstring(text, kind, sep=" ") if words else np.zeros(0, kind)
    except (ValueError, DeprecationWarning):  # some versions of numpy raise; others drop the rest of the text
        return None
    # Numpy reads 1.5-2 as two numbers: check that each word has given one number.
    return found if len(found) == words else None


def _words(text: bytes) -> int:
    """Return the number of words of a text. Splitting the text would take more time and memory."""
    each = np.frombuffer(text, np.uint8)
    inside = (each != 32) & ((each < 9) | (each > 13))
    return int(np.count_nonzero(inside[1:] & ~inside[:-1])) + int(inside[:1].sum())


def table(lines: Sequence[bytes], width: int) -> NDArray[np.float64] | None:
    """Return the numbers in the lines of a text as a table (n, width); None if a line has more or fewer
    numbers, or a number that isn't finite.
    """
    if not lines:
        return np.zeros((0, width))
    found = numbers(b" nan ".join((*lines, b"")))  # a NaN marks the end of each line
    if found is None or len(found) != len(lines) * (width + 1):
        return None
    rows = found.reshape(-1, width + 1)
    # Beyond the range of single precision, coal reads infinity.
    is_known = (np.abs(rows[:, :width]) <= np.finfo(np.float32).max).all()
    return rows[:, :width] if is_known and np.isnan(rows[:, width]).all() else None
