"""Faults inside meshes of text: corners that are no numbers, faces that name corners which aren't there."""

from __future__ import annotations

import re
from xml.parsers import expat

import numpy as np

_NOT_FINITE = re.compile(r"nan|inf", re.IGNORECASE)
_INTEGER = re.compile(rb"[-+]?[0-9]+")
_CORNER = re.compile(rb"^[ \t\r\f\v]*v[ \t]", re.MULTILINE)
_FACE = re.compile(rb"^[ \t\r\f\v]*fo?[ \t]([^\n]*)", re.MULTILINE)
_BESIDE = re.compile(rb"/[^ \t\r\n\f\v]*")
_LONGEST_NUMBER = 20


def obj_fault(content: bytes) -> str:
    """Return the end of a sentence that names the first face with a corner that isn't there; empty without one.

    Args:
        content: of an OBJ file. Its corners are numbered from 1, or from the last one backwards with -1.
    """
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


def dae_has_odd_corners(content: bytes) -> bool:
    """Return True if a position of a sound COLLADA file is no finite number. Normals may be anything."""
    odd: set[str] = set()  # ids of the sources with such a number
    positions: set[str] = set()
    source = ""
    text: list[str] | None = None

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal source, text
        name = tag.rpartition(" ")[2]
        if name == "source":
            source = attributes.get("id", "")
        elif name == "float_array":
            text = []
        elif name == "input" and attributes.get("semantic") == "POSITION":
            positions.add(attributes.get("source", "").removeprefix("#"))

    def end(tag: str) -> None:
        nonlocal text
        if tag.rpartition(" ")[2] == "float_array" and text is not None:
            if _NOT_FINITE.search("".join(text)):
                odd.add(source)
            text = None

    def data(found: str) -> None:
        if text is not None:
            text.append(found)

    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler, parser.EndElementHandler, parser.CharacterDataHandler = begin, end, data
    parser.Parse(content, True)
    return bool(odd & positions)
