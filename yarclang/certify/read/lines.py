"""The place in a controller text that is read, line by line, and what ends the reading."""

from __future__ import annotations

import re
import unicodedata
from typing import NoReturn

_FOREIGN = re.compile(r"[^\n\x20-\x7e]")
_CONTROLS = {0x09: "tab", 0x0B: "vertical tab", 0x0C: "form feed", 0x0D: "carriage return", 0x85: "next line"}
_CONTROLS |= {0x1C: "file separator", 0x1D: "group separator", 0x1E: "record separator", 0x1B: "escape"}


class Refusal(Exception):  # noqa: N818 - never leaves the reader
    """Line, reason and code of an `Unreadable`."""


def check_characters(text: str) -> None:
    """Refuse any character but printable ASCII and line feed: others end a line for some readers and not for others.

    Raises:
        Refusal: at the first such character; or the text doesn't end with a line feed.
    """
    clean = text.isascii() and text.replace("\n", "").isprintable()  # quicker than the search
    if not clean and (found := _FOREIGN.search(text)):
        place = found.start()
        line, column = text.count("\n", 0, place) + 1, place - text.rfind("\n", 0, place)
        code = ord(found[0])
        name = _CONTROLS.get(code) or unicodedata.name(found[0], "control character").lower()
        if 0xA0 < code <= 0xFF:  # of a file's bytes, each is a character
            name = "byte that is no ASCII"
        raise Refusal(
            line, f"has a {name} (0x{code:02X}) in column {column}: only printable ASCII is allowed", "Y1151"
        )
    if not text.endswith("\n"):
        raise Refusal(text.count("\n") + 1, "doesn't end with a line feed: the text was cut", "Y1151")


class Lines:
    """The place in the text: hands out lines."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._place = 0
        self.line = 1  # of the line that comes next

    @property
    def at_end(self) -> bool:
        """True if all lines were taken."""
        return self._place == len(self._text)

    def peek(self) -> str:
        """The next line, left where it is; empty at the end."""
        return self._text[self._place : self._text.find("\n", self._place)] if not self.at_end else ""

    def skip(self) -> None:
        """Go over a line."""
        self._place = self._text.find("\n", self._place) + 1
        self.line += 1

    def refuse(self, reason: str, *, back: int = 0, code: str = "Y1151") -> NoReturn:
        """Read no further.

        Raises:
            Refusal: for the line that comes next, or `back` lines before it.
        """
        raise Refusal(self.line - back, reason, code)


def shown(line: str) -> str:
    """A line in a message, cut short."""
    return f"'{line[:60]}...'" if len(line) > 63 else f"'{line}'"
