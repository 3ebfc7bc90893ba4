"""Fast reading of the numbers in move lines, eight digits at a time.

A number without its decimal point is an integer below 2^53. Dividing it by a power of ten is one operation on
two exact floats, so the result is correctly rounded, and equal to that of any other correct reader.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.model import Array

_AT_ONCE = 1 << 18
"""Number of characters read in one step, so that intermediate arrays stay in the processor's cache."""

_FEW = 6000
"""Below this number of characters, reading each number by itself is faster."""

_DIGITS = 15
"""Largest number of digits of an integer that a float always represents exactly."""

_LINE_FEED, _POINT, _MINUS, _NINE = b"\n.-9"
_BLANK = {one: " " for one in range(128) if one > _NINE or one == _LINE_FEED}
_POWERS = 10.0 ** np.arange(_DIGITS + 1)


def read_numbers(block: str, axes: int) -> tuple[Array, int]:
    """Read move lines.

    Args:
        block: whole lines, each with a letter and a number `[-]digits[.digits]` for every axis. The caller
            has checked this form.
        axes: count of numbers in a line.

    Returns:
        The numbers (k, axes), and the largest number of decimals.
    """
    if len(block) < _FEW:
        return _read_few(block, axes)
    raw = np.frombuffer(block.encode("ascii"), np.uint8)
    values, decimals, place = list[Array](), 0, 0
    while place < len(raw):
        end = len(raw) if place + _AT_ONCE >= len(raw) else block.rfind("\n", place, place + _AT_ONCE) + 1
        part, most = _read_part(raw[place:end], axes)
        values.append(part)
        decimals, place = max(decimals, most), end
    return (np.concatenate(values) if values else np.empty((0, axes))), decimals


def _read_few(block: str, axes: int) -> tuple[Array, int]:
    """Read numbers one by one."""
    decimals = 0
    while re.search(rf"\.[0-9]{{{decimals + 1}}}", block):
        decimals += 1
    return np.fromstring(block.translate(_BLANK), sep=" ").reshape(-1, axes), decimals


def _read_part(raw: NDArray[np.uint8], axes: int) -> tuple[Array, int]:
    points = raw == _POINT
    marks = _marks(raw, axes)
    begins, ends = marks[:, :-1].ravel() + 1, marks[:, 1:].ravel()
    negative = raw[begins] == _MINUS
    # Without points and minus signs, each number is an integer between two letters; the zeros in front allow
    # windows of eight bytes before the first number.
    bare = np.concatenate((np.zeros(16, np.uint8), raw[~points & (raw != _MINUS)]))
    marks = _marks(bare, axes)
    last = marks[:, 1:].ravel()
    digits = last - marks[:, :-1].ravel() - 1
    decimals = np.zeros(len(digits), np.int64)
    # The decimal points are in the order of the numbers that have one.
    decimals[ends - begins - negative > digits] = np.flatnonzero(points)
    decimals = np.where(decimals > 0, ends - decimals - 1, 0)
    windows = np.lib.stride_tricks.sliding_window_view(bare, 8)
    if digits.max() > _DIGITS:
        return _read_few(raw.tobytes().decode("ascii"), axes)
    whole = _integers(windows, last, np.minimum(digits, 8))
    # Numbers of more than eight digits are read in two parts.
    long = np.flatnonzero(digits > 8)
    whole[long] += 1e8 * _integers(windows, last[long] - 8, digits[long] - 8)
    whole /= _POWERS[decimals]
    return np.where(negative, -whole, whole).reshape(-1, axes), int(decimals.max())


def _marks(raw: NDArray[np.uint8], axes: int) -> NDArray[np.int64]:
    """Return the positions of the letters and the end of each line (k, axes + 1)."""
    return np.flatnonzero((raw > _NINE) | (raw == _LINE_FEED)).reshape(-1, axes + 1)


def _integers(windows: NDArray[np.uint8], ends: NDArray[np.int64], digits: NDArray[np.int64]) -> Array:
    """Return the integers (N,) of up to eight digits that end just before the positions `ends` (N,)."""
    eight = windows[ends - 8].view("<u8")[:, 0]
    # The first digit is in the lowest byte; clear the bytes of characters before it, then keep the value of
    # each digit.
    eight &= _ONES << ((8 - digits) * 8).astype(np.uint64)
    eight &= np.uint64(0x0F0F0F0F0F0F0F0F)
    for factor, width, mask in _PAIRS:
        eight = (eight * factor >> width) & mask
    return eight.astype(np.float64)


_ONES = np.uint64(0xFFFFFFFFFFFFFFFF)
# Join neighbours: digits to pairs, pairs to fours, fours to eight digits.
_PAIRS = (
    (np.uint64(10 * 2**8 + 1), np.uint64(8), np.uint64(0x00FF00FF00FF00FF)),
    (np.uint64(100 * 2**16 + 1), np.uint64(16), np.uint64(0x0000FFFF0000FFFF)),
    (np.uint64(10000 * 2**32 + 1), np.uint64(32), np.uint64(0x00000000FFFFFFFF)),
)
