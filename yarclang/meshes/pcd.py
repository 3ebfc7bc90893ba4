"""Reader of PCD files, the point clouds of PCL: text, binary, and compressed."""

from __future__ import annotations

import re
import struct

import numpy as np
from numpy.typing import NDArray

from yarclang.meshes.wording import cut_off

_HEADER = re.compile(
    rb"((?:[ \t]*(?:#|[A-Z])[^\n]*\n|[ \t\r]*\n){1,60}?)DATA[ \t]+(ascii|binary_compressed|binary)[ \t]*\r?\n"
)
_LONGEST_HEADER = 20_000
_KINDS = {
    ("F", "4"): "<f4",
    ("F", "8"): "<f8",
    **{(sign, str(size)): f"<{sign.lower()}{size}" for sign in "IU" for size in (1, 2, 4, 8)},
}
_HERE = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
_MOST_NUMBERS = 1_000


class _FaultError(Exception):
    """Exception for a fault in the file. Its text is the end of a sentence that names the fault."""


def pcd_points(content: bytes) -> NDArray[np.float64] | str:
    """Return the points (N, 3) of a PCD file in the file's own unit, or the end of a sentence that names a
    fault.

    Points that the sensor didn't see are NaN.

    Args:
        content: the file. Fields other than x, y and z are ignored.
    """
    header = _HEADER.match(content[:_LONGEST_HEADER])
    if header is None:
        return "has no header of a PCD file"
    try:
        columns, count = _columns(header[1].decode("ascii", "replace"))
        body = memoryview(content)[header.end() :]
        if header[2] == b"ascii":
            return _text(bytes(body), columns, count)
        return _binary(body, columns, count) if header[2] == b"binary" else _compressed(body, columns, count)
    except _FaultError as fault:
        return str(fault)


def _columns(text: str) -> tuple[list[tuple[str, str]], int]:
    """Return the name and the type of each number that a point has, and the number of points.

    Raises:
        _FaultError: if the header is wrong.
    """
    said = {}
    for words in map(str.split, text.splitlines()):
        if words and not words[0].startswith("#"):
            said[words[0]] = words[1:]
    names = said.get("FIELDS", [])
    sizes, kinds = said.get("SIZE", []), said.get("TYPE", [])
    counts = said.get("COUNT", ["1"] * len(names))
    if not names or not len(names) == len(sizes) == len(kinds) == len(counts):
        raise _FaultError("has a header whose FIELDS, SIZE, TYPE and COUNT don't match")
    columns = []
    for name, size, kind, count in zip(names, sizes, kinds, counts, strict=True):
        if (kind, size) not in _KINDS or not re.fullmatch(r"[0-9]{1,3}", count):
            raise _FaultError(f"has a field {name[:20]} of a type that PCD doesn't have")
        columns += [(name if count == "1" else "_", _KINDS[kind, size])] * int(count)
    if any([name for name, _ in columns].count(axis) != 1 for axis in "xyz") or len(columns) > _MOST_NUMBERS:
        raise _FaultError("has points without exactly one x, y and z")
    _stands_at_its_origin(said.get("VIEWPOINT"))
    number = "".join(said.get("POINTS", []))
    if not re.fullmatch(r"[0-9]{1,10}", number):
        raise _FaultError("doesn't say how many POINTS it has")
    return columns, int(number)


def _stands_at_its_origin(viewpoint: list[str] | None) -> None:
    """Check that the viewpoint is the origin. Readers of PCD files disagree about the meaning of other
    viewpoints.

    Raises:
        _FaultError: if it isn't the origin.
    """
    try:
        pose = _HERE if viewpoint is None else [float(one) for one in viewpoint]
    except ValueError:
        pose = []
    if pose != _HERE:
        raise _FaultError(
            "has a VIEWPOINT other than 0 0 0 1 0 0 0, which readers interpret differently: save it with "
            "0 0 0 1 0 0 0"
        )


def _text(body: bytes, columns: list[tuple[str, str]], count: int) -> NDArray[np.float64]:
    words = body.split()
    if len(words) != count * len(columns):
        raise _FaultError(
            f"has {len(words):,} numbers instead of the {count * len(columns):,} of {count:,} points"
        )
    try:
        rows = np.array(words).astype(np.float64).reshape(count, len(columns))
    except ValueError:
        raise _FaultError("has a word that isn't a number") from None
    names = [name for name, _ in columns]
    found: NDArray[np.float64] = rows[:, [names.index(axis) for axis in "xyz"]]
    return found


def _binary(body: memoryview, columns: list[tuple[str, str]], count: int) -> NDArray[np.float64]:
    kind = np.dtype([(str(at), one) for at, (_, one) in enumerate(columns)])
    if len(body) < count * kind.itemsize:
        raise _FaultError(cut_off(f"{len(body):,} bytes of points", f"{count * kind.itemsize:,}"))
    rows = np.frombuffer(body, kind, count) if count else np.zeros(0, kind)
    names = [name for name, _ in columns]
    with np.errstate(invalid="ignore"):  # signalling NaNs must not cause warnings
        return np.stack([rows[str(names.index(axis))].astype(np.float64) for axis in "xyz"], axis=1)


def _compressed(body: memoryview, columns: list[tuple[str, str]], count: int) -> NDArray[np.float64]:
    """Return the points of a PCD file in compressed form, which stores the numbers of all points field by
    field.
    """
    if len(body) < 8:
        raise _FaultError(cut_off(f"{len(body)} bytes of points", "at least 8"))
    packed, size = struct.unpack_from("<II", body)
    widths = [np.dtype(kind).itemsize for _, kind in columns]
    if size != count * sum(widths):
        raise _FaultError(
            f"has points of {size:,} bytes instead of the {count * sum(widths):,} of {count:,} points"
        )
    if len(body) - 8 < packed:
        raise _FaultError(cut_off(f"{len(body) - 8:,} bytes of points", f"{packed:,}"))
    plain = _unpacked(bytes(body[8 : 8 + packed]), size)
    found = np.empty((count, 3))
    at = 0
    for (name, kind), width in zip(columns, widths, strict=True):
        if name in ("x", "y", "z"):
            with np.errstate(invalid="ignore"):  # signalling NaNs must not cause warnings
                found[:, "xyz".index(name)] = np.frombuffer(plain, kind, count, at) if count else 0.0
        at += count * width
    return found


def _unpacked(packed: bytes, size: int) -> bytes:
    """Decompress LZF data, which consists of literal bytes and of references that repeat earlier bytes."""
    found = bytearray()
    at, end = 0, len(packed)
    try:
        while at < end and len(found) <= size:
            control = packed[at]
            at += 1
            if control < _LITERAL:
                found += packed[at : at + control + 1]
                at += control + 1
                continue
            length = control >> 5
            if length == _LONG:
                length += packed[at]
                at += 1
            start = len(found) - ((control & (_LITERAL - 1)) << 8) - packed[at] - 1
            at += 1
            length += 2
            if start < 0:
                raise _FaultError("has compressed points that are damaged")
            piece = found[start : start + length]
            # the repeated bytes may overlap the bytes that they produce
            found += (piece * (length // len(piece) + 1))[:length]
    except IndexError:
        raise _FaultError("has compressed points that are damaged") from None
    if len(found) != size:
        raise _FaultError("has compressed points that are damaged")
    return bytes(found)


_LITERAL, _LONG = 32, 7
"""Control bytes of LZF data: a byte below `_LITERAL` gives a number of literal bytes; other bytes contain a
length. If this length is `_LONG`, the next byte is added to it.
"""
