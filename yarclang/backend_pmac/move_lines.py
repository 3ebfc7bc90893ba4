"""Move lines as text. Whole-array operations format all numbers of many commands at once."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

_ROWS_AT_ONCE = 4096
# Two expressions, applied in sequence (zeros, then the point), take half the time of a single one for both.
_ZEROS = re.compile(r"0+(?=[A-Z\n])")
_POINT = re.compile(r"\.(?=[A-Z\n])")


def move_lines(axes: Sequence[str], decimals: int, commands: Sequence[NDArray[np.float64]]) -> Iterator[str]:
    """Yield the move lines of each command of the program.

    Args:
        axes: the letter of each axis.
        decimals: largest number of decimals; trailing zeros aren't written.
        commands: for each command, its points (k, axes) [axis units], rounded to `decimals`.
    """
    block: list[NDArray[np.float64]] = []
    rows = 0
    for values in commands:
        block.append(values)
        rows += len(values)
        if rows >= _ROWS_AT_ONCE:
            yield from _split(_lines(axes, decimals, np.concatenate(block)), block)
            block, rows = [], 0
    if block:
        yield from _split(_lines(axes, decimals, np.concatenate(block)), block)


def _split(text: bytes, commands: Sequence[NDArray[np.float64]]) -> Iterator[str]:
    """Split a text at commands: yield as many lines as each command has points."""
    ends = np.flatnonzero(np.frombuffer(text, np.uint8) == _LINE_FEED) + 1
    begin, lines = 0, 0
    for values in commands:
        lines += len(values)
        end = int(ends[lines - 1]) if lines else 0
        yield text[begin:end].decode("ascii")
        begin = end


_LINE_FEED, _MINUS, _POINT_BYTE, _ZERO = b"\n-.0"

_MOST = 4e9
"""Largest number, in units of the last decimal, that the fast path formats."""


def _lines(axes: Sequence[str], decimals: int, values: NDArray[np.float64]) -> bytes:
    """Return move lines, formatted with whole-array operations.

    Args:
        axes: the letter of each axis.
        decimals: maximum number of decimals.
        values: (k, axes) points [axis units].
    """
    size = np.abs(values)
    scale = 10.0**decimals
    if not (size.size and 0 < decimals <= 9 and size.max() * scale < _MOST):
        return _printed(axes, decimals, values)
    # The value is the float nearest to a number with `decimals` decimals, so value times `scale` is an
    # integer up to rounding.
    whole = np.rint(size * scale)
    if not np.array_equal(whole / scale, size):
        return _printed(axes, decimals, values)
    left = whole.astype(np.uint32)
    digits = decimals + len(str(int(whole.max()) // 10**decimals))
    # Each number gets an axis letter, a sign, digits with a point, and a line end. Unwanted characters are
    # masked out afterwards.
    text = np.empty((*values.shape, digits + 4), np.uint8)
    kept = np.empty(text.shape, np.bool_)
    text[:, :, 0], kept[:, :, 0] = [ord(axis) for axis in axes], True
    text[:, :, 1], kept[:, :, 1] = _MINUS, np.signbit(values)
    text[:, :, -1], kept[:, :, -1] = _LINE_FEED, False
    kept[:, -1, -1] = True
    counts = np.zeros(values.shape, np.bool_)
    place = digits + 2
    for _ in range(decimals):
        left, digit = _last_digit(left)
        counts |= digit != 0
        text[:, :, place], kept[:, :, place] = digit + _ZERO, counts
        place -= 1
    text[:, :, place], kept[:, :, place] = _POINT_BYTE, counts
    kept[:, :, place - 1] = True
    for ahead in range(place - 1, 1, -1):
        if ahead < place - 1:
            kept[:, :, ahead] = left != 0
        left, digit = _last_digit(left)
        text[:, :, ahead] = digit + _ZERO
    return text[kept].tobytes()


def _last_digit(numbers: NDArray[np.uint32]) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]:
    """Return integers without their last digit, and that digit."""
    rest = numbers // np.uint32(10)
    return rest, (numbers - rest * np.uint32(10)).astype(np.uint8)


def _printed(axes: Sequence[str], decimals: int, values: NDArray[np.float64]) -> bytes:
    """Return move lines by formatting each number on its own. This is slower, but numbers may have any
    size.
    """
    row = "".join(f"{axis}%.{decimals}f" for axis in axes) + "\n"
    text = (row * len(values)) % tuple(values.ravel().tolist())
    return _POINT.sub("", _ZEROS.sub("", text)).encode("ascii")
