"""The position in a controller text that is read line by line, and the exception that ends the reading."""

from __future__ import annotations

import re
import unicodedata
from typing import NoReturn

_FOREIGN = re.compile(r"[^\n\x20-\x7e]")
_CONTROLS = {0x09: "tab", 0x0B: "vertical tab", 0x0C: "form feed", 0x0D: "carriage return", 0x85: "next line"}
_CONTROLS |= {0x1C: "file separator", 0x1D: "group separator", 0x1E: "record separator", 0x1B: "escape"}


class Refusal(Exception):  # noqa: N818 - never leaves the reader
    """The exception that carries line, reason and code of an `Unreadable`."""


def check_characters(text: str) -> None:
    """Reject all but printable ASCII and line feeds: some programs treat other characters as line ends.

    Raises:
        Refusal: there is such a character, or the text does not end with a line feed.
    """
    # this check is faster than the search below
    clean = text.isascii() and text.replace("\n", "").isprintable()
    if not clean and (found := _FOREIGN.search(text)):
        place = found.start()
        line, column = text.count("\n", 0, place) + 1, place - text.rfind("\n", 0, place)
        code = ord(found[0])
        name = _CONTROLS.get(code) or unicodedata.name(found[0], "control character").lower()
        if 0xA0 < code <= 0xFF:  # the text of a file has one character for each byte
            name = "byte that is no ASCII"
        raise Refusal(
            line, f"has a {name} (0x{code:02X}) in column {column}: only printable ASCII is allowed", "Y1151"
        )
    if not text.endswith("\n"):
        raise Refusal(text.count("\n") + 1, "doesn't end with a line feed: the text was cut", "Y1151")


class Lines:
    """A text with a position, which returns its lines one by one."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._place = 0
        self.line = 1  # number of the next line

    @property
    def at_end(self) -> bool:
        """True if all lines have been read."""
        return self._place == len(self._text)

    def peek(self) -> str:
        """Return the next line without moving on; empty at the end."""
        return self._text[self._place : self._text.find("\n", self._place)] if not self.at_end else ""

    def skip(self) -> None:
        """Move on by one line."""
        self._place = self._text.find("\n", self._place) + 1
        self.line += 1

    def refuse(self, reason: str, *, back: int = 0, code: str = "Y1151") -> NoReturn:
        """End the reading, because a line is wrong.

        Args:
            reason: the fault of the line in words.
            back: 0 if the next line is wrong, 1 if the line before it is, and so on.
            code: code of the finding.

        Raises:
            Refusal: always, for that line.
        """
        raise Refusal(self.line - back, reason, code)


def shown(line: str) -> str:
    """Return a line for a message, shortened if necessary."""
    return f"'{line[:60]}...'" if len(line) > 63 else f"'{line}'"
