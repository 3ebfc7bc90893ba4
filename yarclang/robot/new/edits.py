"""Edit the text of a URDF element by element, and describe the edits for the user."""

from __future__ import annotations

import re

from yarclang.robot.urdf_xml import Element, UrdfText


class Edits:
    """Edits of a URDF's text, and a sentence about each kind of edit."""

    def __init__(self, urdf: UrdfText) -> None:
        self._urdf = urdf
        self._edits: dict[tuple[int, int], str] = {}
        self.notes: list[str] = []

    def text(self) -> str:
        """Return the text with all edits. Of nested edits, the outer one applies."""
        parts, at = [], 0
        for (start, end), new in sorted(self._edits.items(), key=lambda edit: (edit[0][0], -edit[0][1])):
            if start >= at:
                parts += [self._urdf.text[at:start], new]
                at = end
        return "".join((*parts, self._urdf.text[at:]))

    def put(self, place: Element, attribute: str, value: str) -> None:
        """Set the value of an element's attribute, and add the attribute if the element doesn't have it."""
        pattern = re.compile(rf"""\s{attribute}\s*=\s*("[^"]*"|'[^']*')""")
        match = pattern.search(self._urdf.text, place.start, place.end)
        if match:
            self._edits[match.span(1)] = f'"{value}"'
        else:
            after = place.start + 1 + len(place.tag)
            self._edits[after, after] = f' {attribute}="{value}"'

    def remove(self, element: Element) -> bool:
        """Remove an element. Its line breaks are kept, so that later lines keep their numbers. Return False
        if the end of the element isn't found.
        """
        end = element.end
        if self._urdf.text[end - 2 : end] != "/>":
            closing = re.compile(rf"</{element.tag}\s*>").search(self._urdf.text, end)
            if closing is None:
                return False
            end = closing.end()
        self._edits[element.start, end] = re.sub(r"[^\n]", "", self._urdf.text[element.start : end])
        return True

    def count(self, number: int, kind: str) -> None:
        """Add a sentence with the number of edits of a kind, if there are any."""
        if number:
            self.notes.append(f"{number} {kind}")
