"""Mend the text of a user's URDF before it is read, so that it meets yarclang's rules for the URDF of a
robot.

Each change preserves the meaning or affects only pictures, and is reported.
"""

from __future__ import annotations

import re

from yarclang.frozen import frozen
from yarclang.robot.checklist.item import listed
from yarclang.robot.new.edits import Edits
from yarclang.robot.new.mending_shapes import mend_materials, mend_shapes
from yarclang.robot.new.numbers import numbers
from yarclang.robot.urdf import MOST_LINKS, MOVING
from yarclang.robot.urdf_xml import Element, UrdfText, parse_xml
from yarclang.source import SourceFile

PLACEHOLDER = 1.0
"""If all joints have the same effort, and it is no larger than this, it counts as a placeholder [N m or N].
"""

LARGE = 1e9
"""Value that replaces an infinite limit [rad or m, or per s]."""

_ENDLESS = re.compile(r"[+-]?(?:inf(?:inity)?|\d(?:\.\d*)?e\+?[1-9]\d{1,2})", re.IGNORECASE | re.ASCII)
_NUMBERS = re.compile(r"""\s(?:xyz|rpy|size|scale|rgba)\s*=\s*(?:"[^"<]*"|'[^'<]*')""")
_STRAY = re.compile(
    r"<xacro:(?:property|arg)\b(?:[^<>\"']|\"[^\"<]*\"|'[^'<]*')*(?:/>|>\s*</xacro:(?:property|arg)\s*>)"
)
_REFERENCES = {"parent": "link", "child": "link", "mimic": "joint"}


@frozen
class Mended:
    """The text of a URDF after it was mended.

    Attributes:
        source: the text.
        notes: one sentence for each kind of change.
    """

    source: SourceFile
    notes: tuple[str, ...]


def mend(source: SourceFile) -> Mended:
    """Return a URDF with its names, limits, shapes and colours mended. A text that isn't XML is returned
    unchanged; the reader reports it then.
    """
    text, stray = source.text, 0
    if "<xacro:" in text:
        plain, stray = _STRAY.subn(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
        if stray and "<xacro:" not in plain and "${" not in plain and "$(" not in plain:
            text = plain
        else:
            stray = 0
    text, wrapped = _unwrapped(text)
    urdf = UrdfText(SourceFile(source.name, text))
    parse_xml(urdf)
    if (
        urdf.root is None
        or urdf.findings
        or max(len(urdf.root.all(tag)) for tag in ("link", "joint")) > MOST_LINKS
    ):
        return Mended(source, ())
    edits = Edits(urdf)
    _names(edits, urdf.root)
    mend_shapes(edits, urdf.root)
    mend_materials(edits, urdf.root)
    _limits(edits, urdf.root)
    _efforts(edits, urdf.root)
    if stray:
        edits.notes.append(
            f"{stray} <xacro:property> that nothing uses {'are' if stray > 1 else 'is'} left out"
        )
    edits.count(wrapped, "lists of numbers with tabs or line ends have blanks there")
    if not edits.notes:
        return Mended(source, ())
    return Mended(SourceFile(source.name, edits.text()), tuple(edits.notes))


def _unwrapped(text: str) -> tuple[str, int]:
    """Return a URDF's text with tabs and line breaks in lists of numbers replaced by blanks, and how many
    lists were changed. XML makes no difference between these characters.
    """
    count = 0

    def plain(match: re.Match[str]) -> str:
        nonlocal count
        key, mark, value = match[0].partition("=")
        blank = re.sub(r"[\t\r\n]", " ", value)
        count += blank != value
        return f"{key}{mark}{blank}"

    return _NUMBERS.sub(plain, text), count


def _names(edits: Edits, root: Element) -> None:
    """Rename links and joints whose names have other characters than ASCII letters, digits, and . _ -."""
    for tag in ("link", "joint"):
        elements = root.all(tag)
        old = [element.attributes.get("name", "") for element in elements]
        used_names, new = set(old), {}
        for number, name in enumerate(old, 1):
            if name and name not in new and not re.fullmatch(r"[A-Za-z0-9_.\-]+", name):
                plain = re.sub(r"[^A-Za-z0-9_.\-]+", "_", name)
                plain = plain if re.search(r"[A-Za-z]", plain) else f"{tag}_{number}"
                free, count = plain, 2
                while free in used_names:
                    free, count = f"{plain}_{count}", count + 1
                used_names.add(free)
                new[name] = free
        if not new:
            continue
        for element in elements:
            _rename(edits, element, "name", new)
        for joint in root.all("joint"):
            for child in joint.children:
                if _REFERENCES.get(child.tag) == tag:
                    _rename(edits, child, tag, new)
        shown = [f"{_printable(name)} is {plain}" for name, plain in new.items()]
        edits.notes.append(f"names of {tag}s with other letters than robots have: {listed(shown)}")


def _rename(edits: Edits, place: Element, attribute: str, new: dict[str, str]) -> None:
    name = place.attributes.get(attribute)
    if name in new:
        edits.put(place, attribute, new[name])


def _limits(edits: Edits, root: Element) -> None:
    """Replace joint limits that are infinite, or larger than numbers in a URDF may be: efforts by 0, all
    other limits by a large number. Both mean that there is no limit, or that it isn't known.
    """
    count = 0
    for joint in root.all("joint"):
        for limit in joint.all("limit")[:1]:
            for key in ("lower", "upper", "velocity", "effort"):
                if _ENDLESS.fullmatch(value := limit.attributes.get(key, "").strip()):
                    large = -LARGE if value.startswith("-") else LARGE
                    edits.put(limit, key, "0" if key == "effort" else f"{large:g}")
                    count += 1
    edits.count(count, "infinite limits are taken as unknown")


def _efforts(edits: Edits, root: Element) -> None:
    """Replace placeholder efforts by 0, which means that the effort isn't known."""
    limits = [
        limit
        for joint in root.all("joint")
        if joint.attributes.get("type") in MOVING and joint.first("mimic") is None
        for limit in joint.all("limit")[:1]
    ]
    values = {limit.attributes.get("effort", "").strip() for limit in limits}
    if len(limits) < 2 or len(values) != 1:
        return
    value = next(iter(numbers(values.pop())), 0.0)
    if not 0.0 < value <= PLACEHOLDER:
        return
    for limit in limits:
        edits.put(limit, "effort", "0")
    edits.notes.append(
        f"all joints have the effort {value:g}, a placeholder: no effort is known, and torques aren't "
        f"checked. "
        "Give effort in [joints.NAME] of robot.toml"
    )


def _printable(name: str) -> str:
    """Return a name that is safe to print on a terminal: without line breaks and marks that change the
    writing direction.
    """
    plain = "".join(one if one.isprintable() else "?" for one in name)
    return plain if len(plain) <= 40 else f"{plain[:37]}..."
