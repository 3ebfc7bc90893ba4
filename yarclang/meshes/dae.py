"""Find faults in COLLADA files."""

from __future__ import annotations

from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from yarclang.meshes.text import integers, numbers
from yarclang.meshes.wording import NO_TRIANGLE, ODD_CORNER, lost_corner

_BUFFER = 1_000_000
"""Size of the pieces of text that the parser delivers [bytes]."""
_FACES = ("triangles", "polylist", "polygons", "tristrips", "trifans")
_NO_FACES = ("lines", "linestrips")


def dae_fault(content: bytes) -> str:
    """Return the end of a sentence that names the fault that makes a COLLADA file useless as a body; empty if
    there is none.

    Args:
        content: the file. Normals, colours and other content for pictures only aren't checked.
    """
    reading = _Reading()
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.buffer_text = True
    parser.buffer_size = _BUFFER
    parser.StartDoctypeDeclHandler = _refuse
    parser.StartElementHandler, parser.EndElementHandler = reading.begin, reading.end
    parser.CharacterDataHandler = reading.data
    try:
        parser.Parse(content, True)
    except ValueError:
        return "is XML with a DOCTYPE"
    except expat.ExpatError as error:
        return f"is cut off or damaged (XML, line {error.lineno}: {expat.ErrorString(error.code)})"
    return reading.fault()


def _refuse(*_: object) -> None:
    raise ValueError("a DOCTYPE")


class _Faces:
    """The faces in an XML element such as <triangles>, as groups of index numbers.

    Attributes:
        vertices: id of the <vertices> element that the faces use.
        place: position of the corner's index in a group of numbers.
        group: how many numbers a group has.
        lists: the numbers.
    """

    def __init__(self) -> None:
        self.vertices = ""
        self.place = 0
        self.group = 1
        self.lists: list[NDArray[np.float64] | NDArray[np.int64]] = []


class _Reading:
    """Collector of the corners (by the ids of their sources) and faces of a COLLADA file, from the events of
    an XML parser.
    """

    def __init__(self) -> None:
        self.texts: dict[str, str] = {}  # coordinates, normals, colours, by the id of the <source>
        self.strides: dict[str, int] = {}
        self.counts: dict[str, int] = {}
        self.positions: dict[str, str] = {}  # source of each <vertices>
        self.faces: list[_Faces] = []
        self._source = self._vertices = ""
        self._faces: _Faces | None = None
        self._text: list[str] | None = None

    def begin(self, tag: str, attributes: dict[str, str]) -> None:
        """Handle the start of an XML element."""
        name = tag.rpartition(" ")[2]
        if name == "source":
            self._source = attributes.get("id", "")
        elif name == "accessor":
            self.strides[self._source] = _integer(attributes.get("stride", "1"))
            self.counts[self._source] = _integer(attributes.get("count", "0"))
        elif name == "vertices":
            self._vertices = attributes.get("id", "")
        elif name in (*_FACES, *_NO_FACES):
            self._faces = _Faces()
            if name in _FACES:
                self.faces.append(self._faces)
        elif name == "input":
            self._input(attributes)
        elif name == "float_array" or (name in ("p", "ph") and self._faces is not None):
            self._text = []

    def _input(self, attributes: dict[str, str]) -> None:
        source = attributes.get("source", "").removeprefix("#")
        if attributes.get("semantic") == "POSITION" and self._faces is None:
            self.positions[self._vertices] = source
        elif self._faces is not None:
            place = _integer(attributes.get("offset", "0"))
            self._faces.group = max(self._faces.group, place + 1)
            if attributes.get("semantic") == "VERTEX":
                self._faces.vertices, self._faces.place = source, place

    def end(self, tag: str) -> None:
        """Handle the end of an XML element."""
        name = tag.rpartition(" ")[2]
        if name in (*_FACES, *_NO_FACES):
            self._faces = None
        if self._text is None or name not in ("float_array", "p", "ph"):
            return
        text = "".join(self._text)
        self._text = None
        if name == "float_array":
            self.texts[self._source] = text
        elif self._faces is not None:
            whole = integers(text.encode())
            self._faces.lists.append(_numbers(text) if whole is None else whole)

    def data(self, found: str) -> None:
        """Handle the next characters of an XML element's text."""
        if self._text is not None:
            self._text.append(found)

    def fault(self) -> str:
        """Return the end of a sentence that names the first fault; empty if there is none."""
        found = {
            source: _numbers(self.texts[source]) for source in self.positions.values() if source in self.texts
        }
        for source in dict.fromkeys(self.positions.values()):
            places = found.get(source)
            if places is not None and not np.isfinite(places).all():
                return ODD_CORNER
            stride = max(self.strides.get(source, 3), 1)
            needed = self.counts.get(source, 0) * stride
            if places is not None and needed > len(places):
                return (
                    f"is cut off: it has {len(places):,} numbers for its corners, and should have {needed:,}"
                )
        used = 0
        for faces in self.faces:
            used += sum(len(numbers) for numbers in faces.lists)
            source = self.positions.get(faces.vertices, "")
            places = found.get(source)
            if places is None:
                continue
            corners = len(places) // max(self.strides.get(source, 3), 1)
            corners = min(corners, self.counts.get(source, corners))
            for named in faces.lists:
                of_corners = named[faces.place :: faces.group]
                wrong = ~((of_corners >= 0.0) & (of_corners < corners))
                if wrong.any():
                    first = of_corners[wrong][0]
                    if not np.isfinite(first):
                        return "has a face with a corner that is no integer"
                    return lost_corner(int(first), corners)
        return "" if used else NO_TRIANGLE


def _numbers(text: str) -> NDArray[np.float64]:
    """Return the numbers of a text; if any word isn't a number, all of them are NaN."""
    found = numbers(text.encode())
    if found is not None:
        return found
    words = text.split()
    try:
        return np.array(words, dtype=np.float64)
    except ValueError:
        return np.full(len(words), np.nan)


def _integer(text: str) -> int:
    short = text.strip()
    return int(short) if short.isascii() and short.isdigit() and len(short) < 10 else 0
