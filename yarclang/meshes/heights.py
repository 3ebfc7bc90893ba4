"""Height fields: readers of tables of heights, and the closed mesh of the body below such a field."""

from __future__ import annotations

import io
import re
import tokenize
import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from yarclang.meshes.text import numbers
from yarclang.meshes.voxels import TooMany

Array = NDArray[np.float64]

_KINDS = "fiu"
"""Kinds of numpy's number types that heights may have: floats and integers."""


def heights_of(suffix: str, content: bytes) -> Array | str:
    """Return the heights of a file (rows, columns) in the file's own unit, or the end of a sentence that
    names a fault.

    Heights that a sensor hasn't measured are NaN.

    Args:
        suffix: suffix of the file's name, in any case, with its dot: .npy or .csv.
        content: the file.
    """
    found = (_of_numpy if suffix.lower() == ".npy" else _of_text)(content)
    if not isinstance(found, str) and min(found.shape) < 2:
        rows, columns = found.shape
        return f"has {rows} x {columns} heights, but needs at least two rows and two columns"
    return found


def _of_numpy(content: bytes) -> Array | str:
    file = io.BytesIO(content)
    try:
        version = np.lib.format.read_magic(file)
        read: Callable[..., tuple[tuple[int, ...], bool, np.dtype]] = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }[version]
        with warnings.catch_warnings():
            # numpy parses a damaged header as Python code, which may cause warnings
            warnings.simplefilter("ignore")
            shape, by_columns, kind = read(file)
    except (ValueError, KeyError, EOFError, OSError, SyntaxError, TypeError, tokenize.TokenError):
        return "isn't a file of numpy's array format (.npy)"
    if len(shape) != 2 or min(shape) < 0:
        return f"has an array of {len(shape)} dimensions instead of two (rows and columns)"
    if kind.kind not in _KINDS or kind.itemsize == 0:
        return "has values that aren't numbers"
    body = memoryview(content)[file.tell() :]
    if len(body) != shape[0] * shape[1] * kind.itemsize:
        return (
            f"has {len(body):,} bytes of values, but its shape needs {shape[0] * shape[1] * kind.itemsize:,}"
        )
    values = np.frombuffer(body, kind).reshape(shape, order="F" if by_columns else "C")
    return np.ascontiguousarray(values, dtype=np.float64)


def _of_text(content: bytes) -> Array | str:
    lines = [
        one
        for one in content.removeprefix(b"\xef\xbb\xbf").splitlines()
        if one.strip()[:1] not in (b"", b"#")
    ]
    if not lines:
        return "has no line with heights"
    between = next((one for one in (b";", b",") if one in lines[0]), None)
    rows = [re.split(rb"[ \t]+", one.strip()) if between is None else one.split(between) for one in lines]
    width = len(rows[0])
    for number, row in enumerate(rows):
        if len(row) != width:
            return f"has {width} values in its first row, but {len(row)} in row {number + 1}"
    values = []
    for number, row in enumerate(rows):
        found = numbers(b" ".join(one.strip() or b"nan" for one in row))
        if found is None or len(found) != width:
            return f"has a value in row {number + 1} that isn't a number"
        values.append(found)
    return np.array(values)


def below(heights: Array, spacing: float, every: int, most: int) -> Array | TooMany:
    """Return the closed triangles (T, 3, 3) of the body below a height field, or `TooMany` if there are too
    many.

    The height in row i and column j is at y = i times the spacing, x = j times the spacing. Four neighbouring
    heights can be joined by two different pairs of triangles. The surface of the body is the upper pair, so
    that it is nowhere below a linearly interpolated surface. A height without a neighbour becomes a plateau
    that extends to the positions where its neighbours would be.

    Args:
        heights: (rows, columns); NaN for unknown heights. At least one is finite.
        spacing: distance between neighbouring heights.
        every: edge length of the mesh's cells, as a number of spacings. Each corner of the mesh has the
            largest height of the cells around it.
        most: largest number of triangles.
    """
    from scipy.ndimage import maximum_filter

    every = min(every, max(heights.shape) - 1)
    known = np.isfinite(heights)
    lowest = np.where(known, heights, -np.inf)
    cells = [-(-(size - 1) // every) for size in heights.shape]
    grown = [(0, count * every + 1 - size) for count, size in zip(cells, heights.shape, strict=True)]
    lowest = np.pad(lowest, grown, constant_values=-np.inf)
    around = maximum_filter(lowest, 2 * every + 1, mode="constant", cval=-np.inf)
    nodes = (np.where(np.isfinite(lowest), lowest, around) if every == 1 else around)[::every, ::every]
    # a cell exists if any height in it or on its edges is known
    sums = np.pad(np.isfinite(lowest).astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    begin = [np.arange(count) * every for count in cells]
    top, left = begin[0][:, None], begin[1][None]
    bottom, right = top + every + 1, left + every + 1
    is_there = sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left] > 0
    edges = np.pad(is_there, 1)
    sides = [
        is_there & ~edges[1 + down : 1 + down + cells[0], 1 + over : 1 + over + cells[1]]
        for down, over in ((-1, 0), (0, 1), (1, 0), (0, -1))
    ]
    count = 4 * int(is_there.sum()) + 2 * sum(int(one.sum()) for one in sides)
    if count > most:
        return TooMany(count)
    wide = every * spacing
    floor = float(heights[known].min()) - wide
    surface = _upwards(nodes)
    row, column = np.nonzero(is_there)

    def corner(which: NDArray[np.bool_] | None, down: int, over: int, *, deep: bool = False) -> Array:
        rows, columns = (row, column) if which is None else np.nonzero(which)
        high = np.full(len(rows), floor) if deep else surface[rows + down, columns + over]
        return np.stack(((columns + over) * wide, (rows + down) * wide, high), axis=1)

    a, b, c, d = (corner(None, *at) for at in _CORNERS)
    ridge = (a[:, 2] + d[:, 2] >= b[:, 2] + c[:, 2])[:, None, None]
    parts = [
        np.where(ridge, np.stack((a, b, d), axis=1), np.stack((a, b, c), axis=1)),
        np.where(ridge, np.stack((a, d, c), axis=1), np.stack((b, d, c), axis=1)),
    ]
    a, b, c, d = (corner(None, *at, deep=True) for at in _CORNERS)
    parts += [np.stack((a, d, b), axis=1), np.stack((a, c, d), axis=1)]
    for side, (begins, ends) in zip(sides, _SIDES, strict=True):
        one, other = corner(side, *begins), corner(side, *ends)
        under, next_to_it = corner(side, *begins, deep=True), corner(side, *ends, deep=True)
        parts += [np.stack((other, one, under), axis=1), np.stack((other, under, next_to_it), axis=1)]
    return np.concatenate(parts)


_CORNERS = ((0, 0), (0, 1), (1, 0), (1, 1))
"""Row and column of each corner of a cell, relative to its first corner."""
_SIDES = (((0, 0), (0, 1)), ((0, 1), (1, 1)), ((1, 1), (1, 0)), ((1, 0), (0, 0)))
"""Both corners of each side of a cell, counterclockwise seen from above; the first side is that of the
lower row.
"""


def _upwards(values: Array) -> Array:
    """Round values up to numbers that single precision represents."""
    with np.errstate(over="ignore"):
        short = values.astype(np.float32)
    short = np.where(short < values, np.nextafter(short, np.float32(np.inf)), short)
    return short.astype(np.float64)
