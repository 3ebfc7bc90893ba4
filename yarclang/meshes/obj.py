"""Find faults in OBJ files: corners that aren't numbers, faces with corners that don't exist."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from yarclang.meshes.text import integers, pieces, table
from yarclang.meshes.wording import ODD_CORNER

_NOT_FINITE = re.compile(rb"^[ \t]*v[ \t][^\n]*(?:nan|inf)", re.IGNORECASE | re.MULTILINE)
_INTEGER = re.compile(rb"[-+]?[0-9]+")
_PLACE = re.compile(rb"^[ \t]*v[ \t]([^\r\n]*)", re.MULTILINE)
_LOST = re.compile(
    rb"^(?:[ \t]+(?:v|f|fo)[ \t]|[ \t]*[VF][ \t]"
    rb"|v[ \t]+(?=[^ \t])(?!(?:(?:[-+]?[0-9]|[-+]\.[0-9])[0-9.eE+-]*[ \t]+){2}(?:[-+]?[0-9]|[-+]\.[0-9])))",
    re.MULTILINE,
)
"""Start of a line that coal's reader skips silently. A face is then missing, or faces get wrong corners.

The reader reads -.5 as a number, but not .5.
"""
_UNUSUAL = re.compile(rb"^[ \t]*(?!(?:v|vt|vn|f|g|o|s|usemtl|mtllib)[ \t]|[#\s]|\Z)", re.MULTILINE)
"""Start of a line that contains something other than corners, faces, their names or their appearance."""
_RETURN = re.compile(rb"\r(?!\n)")
"""A carriage return that coal's reader takes as the end of a line, although no line feed follows."""
_CORNER = re.compile(rb"^[ \t\r\f\v]*v[ \t]", re.MULTILINE)
_FACE = re.compile(rb"^[ \t\r\f\v]*fo?[ \t]([^\n]*)", re.MULTILINE)
_BESIDE = re.compile(rb"/[^ \t\r\n\f\v]*")
_LONGEST_NUMBER = 20
_LONGEST_LINE = 40


def obj_fault(content: bytes) -> str:
    """Return the end of a sentence that names the fault that makes an OBJ file useless as a body; empty if
    there is none.

    Args:
        content: the file. Its corners are numbered from 1, or backwards from the last one, which is -1.
    """
    if obj_corners(content) is not None:
        return ""
    if _NOT_FINITE.search(content):
        return ODD_CORNER
    joined = content.replace(b"\\\r\n", b"  ").replace(b"\\\n", b" ")
    if lost := _LOST.search(joined):
        skipped = (
            joined[lost.start() :].split(b"\n", 1)[0].rstrip()[:_LONGEST_LINE].decode("ascii", "replace")
        )
        return (
            f"has the line '{_printable(skipped)}', which readers skip: a corner is v with three numbers, "
            "a face is f, both without leading blanks, and each number has a digit before its point"
        )
    if _is_plain(content):
        return ""
    lines = joined.split(b"\n")
    total = sum(words[:1] == [b"v"] for words in (line.split(maxsplit=1) for line in lines))
    seen = 0
    for line in lines:
        words = line.split()
        if words[:1] == [b"v"]:
            seen += 1
        if words[:1] not in ([b"f"], [b"fo"]):
            continue
        for word in words[1:]:
            if word.startswith(b"#"):
                break
            text = word.partition(b"/")[0]
            number = _integer(text)
            if number is None or not (1 <= number <= total or -seen <= number <= -1):
                shown = (
                    text[:_LONGEST_NUMBER].decode() if _INTEGER.fullmatch(text) else "that isn't an integer"
                )
                return f"has a face with the corner {shown}, but {total:,} corners"
    return ""


def obj_corners(content: bytes) -> NDArray[np.float64] | None:
    """Return the corners (n, 3) that faces of an OBJ file use, in the file's own unit.

    Return None for a file with a fault or with unusual content: each corner must have three numbers, and the
    faces must number the corners from 1.
    """
    rows: list[NDArray[np.float64]] = []
    used: list[NDArray[np.int64]] = []
    for piece in pieces(content):
        if b"\\" in piece or _RETURN.search(piece) or _UNUSUAL.search(piece) or _LOST.search(piece):
            return None
        found = table(_PLACE.findall(piece), 3)
        named = integers(_BESIDE.sub(b"", b" ".join(_FACE.findall(piece))))
        if found is None or named is None:
            return None
        rows.append(found)
        used.append(named)
    if not rows:
        return None
    corners, places = np.concatenate(rows), np.concatenate(used)
    if not len(places) or places.min() < 1 or places.max() > len(corners):
        return None
    is_used = np.zeros(len(corners), np.bool_)
    is_used[places - 1] = True
    chosen: NDArray[np.float64] = corners[is_used]
    return chosen


def obj_triangles(content: bytes) -> NDArray[np.float64] | None:
    """Return the triangles (T, 3, 3) of an OBJ file, in the file's own unit.

    Return None if `obj_corners` returns None, or if a face has more than three corners.
    """
    rows: list[NDArray[np.float64]] = []
    used: list[NDArray[np.float64]] = []
    for piece in pieces(content):
        if b"\\" in piece or _RETURN.search(piece) or _UNUSUAL.search(piece) or _LOST.search(piece):
            return None
        found = table(_PLACE.findall(piece), 3)
        named = table([_BESIDE.sub(b"", one) for one in _FACE.findall(piece)], 3)
        if found is None or named is None:
            return None
        rows.append(found)
        used.append(named)
    if not rows:
        return None
    corners, faces = np.concatenate(rows), np.concatenate(used)
    if not len(faces) or (faces != np.floor(faces)).any() or faces.min() < 1 or faces.max() > len(corners):
        return None
    chosen: NDArray[np.float64] = corners[faces.astype(np.int64) - 1]
    return chosen


def _is_plain(content: bytes) -> bool:
    """Return True if all faces number their corners from 1, and all these corners exist.

    This is true for nearly all files. This check takes a tenth of the time that checking each face takes.
    """
    if b"\\" in content:
        return False
    corners = len(_CORNER.findall(content))
    named = _BESIDE.sub(b"", b" ".join(_FACE.findall(content)))
    try:
        numbers = np.array(named.split(), dtype=np.int64)
    except (ValueError, OverflowError):
        return False
    return not len(numbers) or bool(numbers.min() >= 1 and numbers.max() <= corners)


def _printable(text: str) -> str:
    return "".join(one if one.isprintable() else "?" for one in text)


def _integer(text: bytes) -> int | None:
    short = len(text) <= _LONGEST_NUMBER and _INTEGER.fullmatch(text)
    return int(text) if short else None
