"""What URDFs of the world have and a robot's own URDF must not: put right in the text before it is read.

Only what says the same afterwards is changed, or what is a picture, and each change is said.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from yarclang.frozen import frozen
from yarclang.robot.checklist.item import listed
from yarclang.robot.urdf import MOST_LINKS, MOVING
from yarclang.robot.urdf_xml import Element, UrdfText, parse_xml
from yarclang.source import SourceFile

THIN = 1e-3
"""A side of length 0 of a box that collides becomes this long [m]: never less than it was."""

PLACEHOLDER = 1.0
"""Where all joints have the same effort, and none a greater one than this, nobody has looked one up [N m or N]."""

_STRAY = re.compile(
    r"<xacro:(?:property|arg)\b(?:[^<>\"']|\"[^\"<]*\"|'[^'<]*')*(?:/>|>\s*</xacro:(?:property|arg)\s*>)"
)
_REFERENCES = {"parent": "link", "child": "link", "mimic": "joint"}


@frozen
class Mended:
    """The text, and what was changed in it, one sentence each."""

    source: SourceFile
    notes: tuple[str, ...]


def mend(source: SourceFile) -> Mended:
    """Return a URDF with plain names and shapes; one that is no XML comes back as it is, for its reader to say why."""
    text, stray = source.text, 0
    if "<xacro:" in text:
        plain, stray = _STRAY.subn(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
        if stray and "<xacro:" not in plain and "${" not in plain and "$(" not in plain:
            text = plain
        else:
            stray = 0
    urdf = UrdfText(SourceFile(source.name, text))
    parse_xml(urdf)
    if (
        urdf.root is None
        or urdf.findings
        or max(len(urdf.root.all(tag)) for tag in ("link", "joint")) > MOST_LINKS
    ):
        return Mended(source, ())
    mending = _Mending(urdf)
    mending.names(urdf.root)
    mending.shapes(urdf.root)
    mending.efforts(urdf.root)
    if stray:
        mending.notes.append(
            f"{stray} <xacro:property> that nothing uses {'are' if stray > 1 else 'is'} left out"
        )
    if not mending.notes:
        return Mended(source, ())
    return Mended(SourceFile(source.name, mending.text()), tuple(mending.notes))


class _Mending:
    """Edits of a text, and what is said of them."""

    def __init__(self, urdf: UrdfText) -> None:
        self.urdf = urdf
        self.edits: dict[tuple[int, int], str] = {}
        self.notes: list[str] = []

    def text(self) -> str:
        """Return the text with all edits; where one lies in another, the outer one counts."""
        parts, at = [], 0
        for (start, end), new in sorted(self.edits.items(), key=lambda edit: (edit[0][0], -edit[0][1])):
            if start >= at:
                parts += [self.urdf.text[at:start], new]
                at = end
        return "".join((*parts, self.urdf.text[at:]))

    def names(self, root: Element) -> None:
        """Give links and joints names of ASCII letters, digits, and . _ -."""
        for tag in ("link", "joint"):
            elements = root.all(tag)
            old = [one.attributes.get("name", "") for one in elements]
            taken, new = set(old), {}
            for number, name in enumerate(old, 1):
                if name and name not in new and not re.fullmatch(r"[A-Za-z0-9_.\-]+", name):
                    plain = re.sub(r"[^A-Za-z0-9_.\-]+", "_", name)
                    plain = plain if re.search(r"[A-Za-z]", plain) else f"{tag}_{number}"
                    free, count = plain, 2
                    while free in taken:
                        free, count = f"{plain}_{count}", count + 1
                    taken.add(free)
                    new[name] = free
            if not new:
                continue
            for one in elements:
                self._rename(one, "name", new)
            for joint in root.all("joint"):
                for child in joint.children:
                    if _REFERENCES.get(child.tag) == tag:
                        self._rename(child, tag, new)
            shown = [f"{_printable(name)} is {plain}" for name, plain in new.items()]
            self.notes.append(f"names of {tag}s with other letters than robots have: {listed(shown)}")

    def _rename(self, place: Element, attribute: str, new: dict[str, str]) -> None:
        name = place.attributes.get(attribute)
        if name in new:
            self._set(place, attribute, new[name])

    def _set(self, place: Element, attribute: str, value: str) -> None:
        pattern = re.compile(rf"""\s{attribute}\s*=\s*("[^"]*"|'[^']*')""")
        match = pattern.search(self.urdf.text, place.start, place.end)
        if match:
            self.edits[match.span(1)] = f'"{value}"'

    def shapes(self, root: Element) -> None:
        """Take out pictures without a size and second materials; boxes that collide get a thickness."""
        gone = materials = thick = 0
        for link in root.all("link"):
            for body in (*link.all("visual"), *link.all("collision")):
                for extra in body.all("material")[1:]:
                    materials += self._remove(extra)
                box = next((one for shape in body.all("geometry")[:1] for one in shape.all("box")), None)
                sizes = _sizes(box)
                if box is None or not sizes or min(sizes) < 0.0 or min(sizes) > 0.0:
                    continue
                if body.tag == "visual" or max(sizes) == 0.0:
                    gone += self._remove(body)
                else:
                    self._set(box, "size", " ".join(f"{max(size, THIN):.12g}" for size in sizes))
                    thick += 1
        for count, what in (
            (gone, "boxes without a size, which show and hit nothing, are left out"),
            (materials, "second materials of a <visual>, which readers ignore, are left out"),
            (thick, f"collision boxes with a side of 0 are {THIN * 1e3:g} mm thick there"),
        ):
            if count:
                self.notes.append(f"{count} {what}")

    def _remove(self, element: Element) -> bool:
        end = element.end
        if self.urdf.text[end - 2 : end] != "/>":
            closing = re.compile(rf"</{element.tag}\s*>").search(self.urdf.text, end)
            if closing is None:
                return False
            end = closing.end()
        self.edits[element.start, end] = re.sub(r"[^\n]", "", self.urdf.text[element.start : end])
        return True

    def efforts(self, root: Element) -> None:
        """Give efforts that are placeholders as 0, which says that none is known."""
        limits = [
            limit
            for joint in root.all("joint")
            if joint.attributes.get("type") in MOVING and joint.first("mimic") is None
            for limit in joint.all("limit")[:1]
        ]
        values = {limit.attributes.get("effort", "").strip() for limit in limits}
        if len(limits) < 2 or len(values) != 1:
            return
        value = next(iter(_numbers(values.pop())), 0.0)
        if not 0.0 < value <= PLACEHOLDER:
            return
        for limit in limits:
            self._set(limit, "effort", "0")
        self.notes.append(
            f"all joints have the effort {value:g}, a placeholder: no effort is known, and torques aren't checked. "
            "Give effort in [joints.NAME] of robot.toml"
        )


def _sizes(box: Element | None) -> tuple[float, ...]:
    return tuple(_numbers(box.attributes.get("size", ""))) if box is not None else ()


def _numbers(text: str) -> Iterator[float]:
    for part in text.split():
        if not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", part, re.ASCII):
            return
        yield float(part)


def _printable(name: str) -> str:
    """Return a name as a terminal may have it: without line ends and marks that turn the direction of writing."""
    plain = "".join(one if one.isprintable() else "?" for one in name)
    return plain if len(plain) <= 40 else f"{plain[:37]}..."
