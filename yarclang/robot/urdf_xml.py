"""Parse the XML of a URDF: its elements with their positions in the text, and the numbers in their
attributes.
"""

from __future__ import annotations

import bisect
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from yarclang.diagnostics import Diagnostic
from yarclang.source import SourceFile, Span
from yarclang.subjects import Subject

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_LARGEST, _LARGEST_LIMIT = 1e6, 1e30
"""Largest absolute values of numbers, which prevent overflow. The second applies to elements that state
limits, where files write large numbers if there is no limit.
"""
_DEEPEST = 16
_MOST_ELEMENTS = 100_000
"""The largest number of elements of a file, which allows a hundred for each of a thousand links."""


@dataclass(slots=True)
class Element:
    """An XML element of the URDF; its opening tag is text[start:end]."""

    tag: str
    attributes: dict[str, str]
    start: int
    end: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> list[Element]:
        """Return the child elements with a tag."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> Element | None:
        """Return the first child element with a tag. Further children with this tag are ignored."""
        return next(iter(self.all(tag)), None)


class UrdfText:
    """The text of a URDF, its root element, and the findings about it.

    `kind` is the word that findings use for the file.
    """

    def __init__(self, source: SourceFile, kind: str = "a URDF") -> None:
        self.source = source
        self.kind = kind
        self.findings: list[Diagnostic] = []
        self.root: Element | None = None
        text = source.text.replace("\r\n", "\n").replace("\r", "\n")
        self.text = text
        self.starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def offset(self, line: int, column: int) -> int:
        """Return the offset in the text at a line and a column, both counted from 1."""
        return self.starts[min(line, len(self.starts)) - 1] + column - 1

    def say(
        self,
        code: str,
        message: str,
        remedy: str,
        place: Element,
        attribute: str = "",
        subject: Subject | None = None,
    ) -> None:
        """Add a finding at an element's tag, or at one of its attributes.

        Args:
            code: the finding's code.
            message: a sentence that names the object, the number, and the limit.
            remedy: what to do.
            place: the element.
            attribute: one of the element's attributes, or empty for its tag.
            subject: the name that the finding is about.
        """
        # "?" replaces characters that would break the message on a terminal: line ends, and the invisible
        # marks that change the writing direction
        message = "".join(one if one.isprintable() else "?" for one in message)
        start, end = place.start, place.end
        if attribute:
            match = self._attribute(place, attribute)
            if match:
                start, end = match.span(1)
        if start >= len(self.text):  # after the last line: show its end
            start = end = len(self.text.rstrip("\n"))
        first = bisect.bisect_right(self.starts, start)
        last = bisect.bisect_right(self.starts, end)
        span = Span(first, start - self.starts[first - 1] + 1, last, end - self.starts[last - 1] + 1)
        self.findings.append(Diagnostic(code, message, self.source, span, remedy, subject=subject))

    def numbers(
        self, place: Element | None, attribute: str, count: int, default: Sequence[float] | None = None
    ) -> tuple[float, ...] | None:
        """Return the numbers in an attribute of an element. If they are wrong, report it and return None.

        Args:
            place: the element. If it is None, the result is `default`.
            attribute: the attribute. If the element doesn't have it, the result is `default`, or a finding if
                there is no default.
            count: how many numbers there must be.
            default: the numbers to return instead.
        """
        if place is None or (attribute not in place.attributes and default is not None):
            return tuple(default) if default is not None else None
        if attribute not in place.attributes:
            self.say(
                "Y1342",
                f"<{place.tag}> has no {attribute}.",
                f'Write <{place.tag} {attribute}="...">.',
                place,
            )
            return None
        match = self._attribute(place, attribute)
        text = match.group(3) if match else place.attributes[attribute]
        most = _LARGEST_LIMIT if place.tag in ("limit", "safety_controller") else _LARGEST
        parts = [part for part in text.split(" ") if part]
        good = len(parts) == count and all(
            _NUMBER.fullmatch(part) and abs(float(part)) <= most for part in parts
        )
        if not good:
            wanted = "one finite number" if count == 1 else f"{count} finite numbers with blanks between them"
            shown = repr(text if len(text) <= 40 else text[:37] + "...")
            message = f"{attribute} of <{place.tag}> is {shown}, but must be {wanted}, none beyond {most:g}."
            remedy = f'Write for example {attribute}="{" ".join(["0.1"] * count)}".'
            self.say("Y1345", message, remedy, place, attribute)
            return None
        return tuple(float(part) for part in parts)

    def once(self, place: Element, tags: Iterable[str]) -> None:
        """Report each child element that repeats one of these tags. Readers of URDFs silently ignore such
        a child.
        """
        for tag in tags:
            for extra in place.all(tag)[1:]:
                self.say(
                    "Y1361", f"A second <{tag}> in the same <{place.tag}>.", "Remove one of the two.", extra
                )

    def _attribute(self, place: Element, attribute: str) -> re.Match[str] | None:
        pattern = re.compile(rf"""\s{re.escape(attribute)}\s*=\s*((["'])(.*?)\2)""", re.DOTALL)
        return pattern.search(self.text, place.start, place.end)


class _EnoughError(Exception):
    """Exception that ends the parse after a finding."""


def parse_xml(urdf: UrdfText) -> None:
    """Build the tree of XML elements under `urdf.root`. A text that isn't XML, or isn't a URDF, is reported
    as a finding.
    """
    parser = expat.ParserCreate("utf-8")
    stack: list[Element] = []
    count = 0
    text = urdf.text

    def here() -> int:
        return urdf.offset(parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def refuse(message: str, remedy: str) -> None:
        start = here()
        urdf.say("Y1341", message, remedy, Element("", {}, start, _tag_end(text, start)))
        raise _EnoughError

    def start(tag: str, attributes: dict[str, str]) -> None:
        if tag.startswith("xacro:"):
            refuse(
                f"<{tag}> is xacro, a language that writes URDF.",
                "Run xacro, and give the URDF that it writes.",
            )
        if len(stack) >= _DEEPEST:
            refuse(
                f"Elements are nested more than {_DEEPEST} deep.",
                "Nest them less deep: a URDF needs at most five levels.",
            )
        nonlocal count
        count += 1
        if count > _MOST_ELEMENTS:
            refuse(
                f"The file has more than {_MOST_ELEMENTS:,} elements.",
                "Keep only the links of the arm and of the bodies on it.",
            )
        at = here()
        element = Element(tag, attributes, at, _tag_end(text, at))
        if stack:
            stack[-1].children.append(element)
        else:
            urdf.root = element
        stack.append(element)

    def doctype(*_: Any) -> None:
        refuse(f"The file has a DOCTYPE, which {urdf.kind} can't have.", "Remove the DOCTYPE.")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _tag: stack.pop()
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(text, True)
    except _EnoughError:
        urdf.root = None
    except (expat.ExpatError, ValueError, LookupError) as error:
        line, column = getattr(error, "lineno", 1), getattr(error, "offset", 0)
        at = urdf.offset(line, column + 1)
        message = str(error).split(":")[0].capitalize()
        place = Element("", {}, at, at + 1)
        urdf.root = None
        urdf.say("Y1340", f"{message}: this is not XML.", "Correct the XML at this place.", place)


def _tag_end(text: str, start: int) -> int:
    """Return the offset at which the XML tag that begins at `start` ends."""
    match = re.compile(r"""(?:[^>"']|"[^"]*"|'[^']*')*>?""").match(text, start)
    return match.end() if match else start
