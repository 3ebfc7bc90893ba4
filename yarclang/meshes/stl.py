"""Read and write STL files, and find faults in them."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from yarclang.meshes.text import pieces, table
from yarclang.meshes.wording import NO_TRIANGLE, ODD_CORNER, cut_off

_HEAD = 84
"""Bytes before the first triangle of a binary file. The last four are the number of triangles."""
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("more", "<u2")])
_NOT_FINITE = re.compile(rb"^[ \t]*vertex[ \t][^\n]*(?:nan|inf)", re.IGNORECASE | re.MULTILINE)
_NAME = re.compile(rb"^([ \t\r\f\v]*(?:end)?solid)\b[^\n]*", re.IGNORECASE | re.MULTILINE)
_VERTEX = re.compile(rb"^[ \t]*vertex[ \t]([^\r\n]*)", re.MULTILINE)
_IN_TRIANGLE = {
    b"facet": 2,
    b"endfacet": 1,
    b"normal": 1,
    b"outer": 1,
    b"loop": 2,
    b"endloop": 1,
    b"vertex": 3,
}
"""Number of times that each word occurs in the text of a triangle, including its occurrences within other
words.

Files in which names of solids contain these words are treated as unusual.
"""
_WORD = re.compile(rb"\b(facet|vertex|endfacet|endsolid)\b", re.IGNORECASE)


def is_binary(content: bytes) -> bool:
    """Return True if the length of an STL file fits the number of triangles that a binary file states in its
    header.
    """
    return len(content) >= _HEAD and len(content) == _HEAD + _TRIANGLE.itemsize * _count(content)


def stl_corners(content: bytes) -> NDArray[np.float64] | None:
    """Return the corners (3 T, 3) of all triangles of an STL file, in the file's own unit.

    Return None for a file with a fault, or with unusual text.
    """
    if not is_binary(content):
        return _text_corners(content)
    corners = np.frombuffer(content, _TRIANGLE, offset=_HEAD)["corners"]
    if not len(corners) or not np.isfinite(corners).all():
        return None
    return corners.reshape(-1, 3).astype(np.float64)


def _text_corners(content: bytes) -> NDArray[np.float64] | None:
    """Return the corners in a text STL file; None if a word of the format doesn't occur exactly as often as
    the number of triangles requires.
    """
    if content[:5] != b"solid" or not content.rstrip().rpartition(b"\n")[2].lstrip().startswith(b"endsolid"):
        return None
    counts = dict.fromkeys(_IN_TRIANGLE, 0)
    rows: list[NDArray[np.float64]] = []
    for piece in pieces(content):
        low = piece.lower()
        for word in counts:
            counts[word] += low.count(word)
        found = table(_VERTEX.findall(piece), 3)
        if found is None:
            return None
        rows.append(found)
    triangles = counts[b"endfacet"]
    if not triangles or counts != {word: times * triangles for word, times in _IN_TRIANGLE.items()}:
        return None
    corners = np.concatenate(rows)
    return corners if len(corners) == 3 * triangles else None


def stl_of(triangles: NDArray[np.float64]) -> bytes:
    """Return a binary STL file of triangles (T, 3, 3). Its normals are zero: readers compute them."""
    records = np.zeros(len(triangles), _TRIANGLE)
    records["corners"] = triangles.reshape(-1, 9)
    return bytes(_HEAD - 4) + len(triangles).to_bytes(4, "little") + records.tobytes()


def stl_fault(content: bytes) -> str:
    """Return the end of a sentence that names the fault that makes an STL file useless as a body; empty if
    there is none.

    Args:
        content: the file, binary or text. Normals aren't checked.
    """
    if is_binary(content):
        corners = np.frombuffer(content, _TRIANGLE, offset=_HEAD)["corners"]
        if not len(corners):
            return NO_TRIANGLE
        return "" if np.isfinite(corners).all() else ODD_CORNER
    if content.lstrip()[:5].lower() != b"solid":
        return damage(content)
    if _text_corners(content) is not None:
        return ""
    if _NOT_FINITE.search(content):
        return ODD_CORNER
    words = [word.lower() for word in _WORD.findall(_NAME.sub(rb"\1", content))]
    facets, ends, corners_ = (words.count(word) for word in (b"facet", b"endfacet", b"vertex"))
    if not facets:
        return NO_TRIANGLE
    if ends < facets or corners_ < 3 * facets:
        found = f"{ends:,} endfacet and {corners_:,} vertex"
        return cut_off(found, f"{facets:,} and {3 * facets:,} for its {facets:,} facet")
    if words[-1] != b"endsolid":
        return "is cut off: it has no endsolid after its last triangle"
    return ""


def damage(content: bytes) -> str:
    """Return the end of a sentence that states how long a binary STL file should be; empty if this isn't
    known.
    """
    if len(content) < _HEAD or content.startswith(b"solid"):
        return ""
    needed = _HEAD + _TRIANGLE.itemsize * _count(content)
    return (
        f"is damaged (a binary STL of {_count(content):,} triangles has {needed:,} bytes, this one has "
        f"{len(content):,})"
    )


def _count(content: bytes) -> int:
    return int.from_bytes(content[_HEAD - 4 : _HEAD], "little")
