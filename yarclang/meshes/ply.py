"""Read PLY files, and find faults in them."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.meshes.wording import NO_TRIANGLE, ODD_CORNER, lost_corner

_HEADER = re.compile(
    rb"ply\s*?\nformat[ \t]+(?P<form>ascii|binary_little_endian|binary_big_endian)[ \t]+\S+\s*?\n(?P<lines>(?:[^\n]*\n)*?)end_header\r?\n"  # noqa: E501
)
_LONGEST_HEADER = 100_000
_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
        "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4", "double": "f8",
        "float64": "f8",
}  # fmt: skip
_AT_ONCE = 1_000_000
"""Largest number of list entries that are read at once, to bound memory."""
_CORNERS = ("vertex_indices", "vertex_index")


class _FaultError(Exception):
    """Exception for a fault in the file. Its text is the end of a sentence that names the fault."""


@frozen
class _Property:
    """A property of each entry of a PLY element: a number, or a list of numbers.

    Attributes:
        name: its name.
        kind: type of a number.
        length: type of the length of a list; empty for a single number.
    """

    name: str
    kind: str
    length: str = ""


@frozen
class _Element:
    """An element of a PLY file: a table of entries, such as the table of all corners.

    Attributes:
        name: its name.
        count: number of entries.
        properties: the properties of each entry.
    """

    name: str
    count: int
    properties: tuple[_Property, ...]


def read_ply(content: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64]] | str:
    """Return corners (V, 3) and triangles (T, 3) of a PLY file, or the end of a sentence that names a fault.

    Faces with more than three corners are divided into triangles from their first corner. The triangles cover
    the face; if the face isn't convex, they cover more.

    Args:
        content: the file, text or binary. Anything but positions of corners and faces is ignored.
    """
    try:
        return _look(*_opened(content))
    except _FaultError as fault:
        return str(fault)


def ply_points(content: bytes) -> NDArray[np.float64] | str:
    """Return the corners (V, 3) of a PLY file without its faces, or the end of a sentence that names a fault.

    Args:
        content: the file, text or binary. Points that the sensor didn't see may be NaN.
    """
    try:
        elements, source = _opened(content)
        for element in elements:
            if element.name == "vertex":
                return _corners_of(element, source)
            for _ in _lists(element, source):
                pass
    except _FaultError as fault:
        return str(fault)
    return "has no points"


def _opened(content: bytes) -> tuple[list[_Element], _Numbers]:
    """Return the elements that a PLY file's header declares, and a reader of the numbers after the header.

    Raises:
        _FaultError: if the header is wrong, or a word isn't a number.
    """
    header = _HEADER.match(content[:_LONGEST_HEADER])
    if header is None:
        raise _FaultError("has no header of a PLY file")
    elements = _elements(header["lines"].decode("ascii", "replace"))
    if header["form"] == b"ascii":
        return elements, _Text(content[header.end() :])
    order = "<" if header["form"] == b"binary_little_endian" else ">"
    return elements, _Binary(content, header.end(), order)


def _corners_of(element: _Element, source: _Numbers) -> NDArray[np.float64]:
    """Return the positions (V, 3) of the corners of a PLY file.

    Raises:
        _FaultError: if the file has no corners, or if they have no x, y and z.
    """
    names = [one.name for one in element.properties]
    if not {"x", "y", "z"} <= set(names) or any(one.length for one in element.properties):
        raise _FaultError("has corners without x, y and z")
    rows = source.rows(element.count, [one.kind for one in element.properties])
    return rows[:, [names.index(axis) for axis in "xyz"]]


def ply_fault(content: bytes) -> str:
    """Return the end of a sentence that names the fault that makes a PLY file useless as a body; empty if
    there is none.
    """
    read = read_ply(content)
    return read if isinstance(read, str) else ""


def _elements(text: str) -> list[_Element]:
    found: list[_Element] = []
    for words in map(str.split, text.splitlines()):
        match words:
            case ["element", name, count] if re.fullmatch(r"[0-9]{1,10}", count):
                found.append(_Element(name, int(count), ()))
            case ["property", "list", length, kind, name] if found and {length, kind} <= _TYPES.keys():
                if _TYPES[length][0] == "f":
                    raise _FaultError(f"has a list {name[:20]} whose length isn't an integer")
                found[-1] = _with(found[-1], _Property(name, _TYPES[kind], _TYPES[length]))
            case ["property", kind, name] if found and kind in _TYPES:
                found[-1] = _with(found[-1], _Property(name, _TYPES[kind]))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise _FaultError("has a line in its header that PLY doesn't have")
    return found


def _with(element: _Element, more: _Property) -> _Element:
    return _Element(element.name, element.count, (*element.properties, more))


class _Numbers:
    """Reader of the numbers of a file, from its beginning to its end."""

    def rows(self, count: int, kinds: list[str]) -> NDArray[np.float64]:
        """Read the next entries as an array (count, columns); the types of the columns are `kinds`.

        Raises:
            _FaultError: if the file ends too early.
        """
        raise NotImplementedError

    def width(self, kind: str) -> int:
        """Return how many positions in the file a number takes: its bytes, or 1 in a text file, where words
        are counted.
        """
        raise NotImplementedError

    def starts(
        self, count: int, before: int, length: str, item: int, after: int
    ) -> tuple[list[int], list[int]]:
        """Skip the next entries, and return the positions in the file and the lengths of their lists.
        Positions are counted as by `width`.

        Args:
            count: number of entries, which have one list each.
            before: number of positions that an entry takes before its list.
            length: type of the length of a list.
            item: number of positions that each number of the list takes.
            after: number of positions that an entry takes after its list.

        Raises:
            _FaultError: if the file ends too early, or if the length of a list isn't allowed.
        """
        raise NotImplementedError

    def gather(self, starts: NDArray[np.int64], length: int, kind: str) -> NDArray[np.float64]:
        """Return the lists that begin at given positions in the file, as (entries, length). All of them have
        the same length and type.
        """
        raise NotImplementedError


class _Text(_Numbers):
    def __init__(self, content: bytes) -> None:
        try:
            self.numbers = np.array(content.split()).astype(np.float64)
        except ValueError:
            raise _FaultError("has a word that isn't a number") from None
        self.place = 0

    def rows(self, count: int, kinds: list[str]) -> NDArray[np.float64]:
        end = self.place + count * len(kinds)
        if end > len(self.numbers):
            raise _FaultError(f"is cut off: it has {len(self.numbers):,} numbers, and should have more")
        found = self.numbers[self.place : end].reshape(count, len(kinds))
        self.place = end
        return found

    def width(self, kind: str) -> int:
        del kind  # each number is one word
        return 1

    def starts(
        self, count: int, before: int, length: str, item: int, after: int
    ) -> tuple[list[int], list[int]]:
        del length, item
        numbers, at = self.numbers.tolist(), self.place
        begins, lengths = [], []
        try:
            for _ in range(count):
                size = int(numbers[at + before])
                if size < 0 or size != numbers[at + before]:
                    raise _FaultError(f"has a list of the length {numbers[at + before]:g}")
                begins.append(at + before + 1)
                lengths.append(size)
                at += before + 1 + size + after
        except (IndexError, ValueError, OverflowError):
            raise _FaultError(f"is cut off: it has {len(numbers):,} numbers, and should have more") from None
        if at > len(numbers):
            raise _FaultError(f"is cut off: it has {len(numbers):,} numbers, and should have more")
        self.place = at
        return begins, lengths

    def gather(self, starts: NDArray[np.int64], length: int, kind: str) -> NDArray[np.float64]:
        del kind
        found: NDArray[np.float64] = self.numbers[starts[:, None] + np.arange(length)]
        return found


class _Binary(_Numbers):
    def __init__(self, content: bytes, place: int, order: str) -> None:
        self.content, self.place, self.order = content, place, order

    def rows(self, count: int, kinds: list[str]) -> NDArray[np.float64]:
        kind = np.dtype([(str(at), self.order + one) for at, one in enumerate(kinds)])
        end = self.place + count * kind.itemsize
        if end > len(self.content):
            raise _FaultError(f"is cut off: it has {len(self.content):,} bytes, and should have more")
        read = np.frombuffer(self.content, kind, count, self.place) if count and kinds else np.zeros(0, kind)
        self.place = end
        found = np.empty((count, len(kinds)))
        for at in range(len(kinds)):
            found[:, at] = read[str(at)] if count else 0.0
        return found

    def width(self, kind: str) -> int:
        return np.dtype(kind).itemsize

    def starts(
        self, count: int, before: int, length: str, item: int, after: int
    ) -> tuple[list[int], list[int]]:
        reader = struct.Struct(self.order + np.dtype(length).char)
        content, at = self.content, self.place
        begins, lengths = [], []
        try:
            for _ in range(count):
                (size,) = reader.unpack_from(content, at + before)
                if size < 0:
                    raise _FaultError(f"has a list of the length {size}")
                begin = at + before + reader.size
                begins.append(begin)
                lengths.append(size)
                at = begin + size * item + after
        except struct.error:
            at = len(content) + 1
        if at > len(content):
            raise _FaultError(f"is cut off: it has {len(content):,} bytes, and should have more")
        self.place = at
        return begins, lengths

    def gather(self, starts: NDArray[np.int64], length: int, kind: str) -> NDArray[np.float64]:
        width = self.width(kind) * length
        raw = np.frombuffer(self.content, np.uint8)[starts[:, None] + np.arange(width)]
        return np.ascontiguousarray(raw).view(self.order + kind).astype(np.float64)


def _look(elements: list[_Element], source: _Numbers) -> tuple[NDArray[np.float64], NDArray[np.int64]] | str:
    corners = np.zeros((0, 3))
    faces: list[NDArray[np.int64]] = []
    for element in elements:
        if element.name == "tristrips":
            return "has strips of triangles, which aren't read here"
        if element.name == "vertex":
            corners = _corners_of(element, source)
            if not np.isfinite(corners).all():
                return ODD_CORNER
            continue
        for name, values in _lists(element, source):
            if element.name != "face" or name not in _CORNERS or not values.size:
                continue
            wrong = ~((values >= 0) & (values < len(corners)))
            if wrong.any():
                first = values[wrong][0]
                return lost_corner(int(first), len(corners)) if np.isfinite(first) else ODD_CORNER
            # a fan of triangles from the first corner of each face
            sides = range(1, values.shape[1] - 1)
            faces.extend(values[:, [0, side, side + 1]].astype(np.int64) for side in sides)
    return (corners, np.concatenate(faces)) if faces else NO_TRIANGLE


def _lists(element: _Element, source: _Numbers) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield the lists of all entries of an element: the name of their property, and the lists of several
    entries as rows (entries, length).

    If each entry has only one list, all lists of equal length are read together.
    """
    places = [at for at, one in enumerate(element.properties) if one.length]
    if len(places) != 1:
        for _ in range(element.count if places else 0):
            yield from _entry(element, source)
        if not places:
            source.rows(element.count, [one.kind for one in element.properties])
        return
    listed = element.properties[places[0]]
    before, after = (
        sum(source.width(one.kind) for one in part)
        for part in (element.properties[: places[0]], element.properties[places[0] + 1 :])
    )
    found = source.starts(element.count, before, listed.length, source.width(listed.kind), after)
    starts, lengths = (np.array(part, dtype=np.int64) for part in found)
    for length in np.unique(lengths).tolist():
        chosen = starts[lengths == length]
        step = max(1, _AT_ONCE // max(1, length))
        for begin in range(0, len(chosen), step):
            yield listed.name, source.gather(chosen[begin : begin + step], length, listed.kind)


def _entry(element: _Element, source: _Numbers) -> list[tuple[str, NDArray[np.float64]]]:
    """Return the lists of the next entry of an element, with the names of their properties."""
    found = []
    for one in element.properties:
        if not one.length:
            source.rows(1, [one.kind])
            continue
        length = float(source.rows(1, [one.length])[0, 0])
        if not (length >= 0.0 and length == int(length)):
            raise _FaultError(f"has a list of the length {length:g}")
        found.append((one.name, source.rows(int(length), [one.kind]).T))
    return found
