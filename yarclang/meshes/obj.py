"""Faults inside OBJ files: corners that are no numbers, faces that name corners which aren't there."""

from __future__ import annotations

import re

import numpy as np

from yarclang.meshes.wording import ODD_CORNER

_NOT_FINITE = re.compile(rb"^[ \t]*v[ \t][^\n]*(?:nan|inf)", re.IGNORECASE | re.MULTILINE)
_INTEGER = re.compile(rb"[-+]?[0-9]+")
_CORNER = re.compile(rb"^[ \t\r\f\v]*v[ \t]", re.MULTILINE)
_FACE = re.compile(rb"^[ \t\r\f\v]*fo?[ \t]([^\n]*)", re.MULTILINE)
_BESIDE = re.compile(rb"/[^ \t\r\n\f\v]*")
_LONGEST_NUMBER = 20


def obj_fault(content: bytes) -> str:
    """Return the end of a sentence that names a corner that is no number, or the first face with a corner that isn't there; empty without one.

    Args:
        content: of an OBJ file. Its corners are numbered from 1, or from the last one backwards with -1.
    """
    if _NOT_FINITE.search(content):
        return ODD_CORNER
    if _is_plain(content):
        return ""
    lines = content.replace(b"\\\r\n", b"  ").replace(b"\\\n", b" ").split(b"\n")
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
                shown = text[:_LONGEST_NUMBER].decode() if _INTEGER.fullmatch(text) else "that is no integer"
                return f"has a face with the corner {shown}, but {total:,} corners"
    return ""


def _is_plain(content: bytes) -> bool:
    """Return True if all faces name corners by numbers from 1, and all of these are there: what nearly all files have, in a tenth of the time of a look at each face."""
    if b"\\" in content:
        return False
    corners = len(_CORNER.findall(content))
    named = _BESIDE.sub(b"", b" ".join(_FACE.findall(content)))
    try:
        numbers = np.array(named.split(), dtype=np.int64)
    except (ValueError, OverflowError):
        return False
    return not len(numbers) or bool(numbers.min() >= 1 and numbers.max() <= corners)


def _integer(text: bytes) -> int | None:
    short = len(text) <= _LONGEST_NUMBER and _INTEGER.fullmatch(text)
    return int(text) if short else None
