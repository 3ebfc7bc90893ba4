"""The place in a controller text that is read: its lines one by one, and blocks of move lines as numbers."""

from __future__ import annotations

import re
import unicodedata
from functools import partial
from typing import NoReturn

import numpy as np

from yarclang.certify.numbers import read_numbers
from yarclang.certify.text import Sent
from yarclang.memory import NO_MEMORY, Forgetful, Memory, recall
from yarclang.pmac.requests import MOST_LINE
from yarclang.progress import go_on
from yarclang.robot.model import Array, Controller

_NUMBER = r"-?[0-9]{1,7}+(?:\.[0-9]{1,12}+)?+"
"""Possessive: a line that has matched is never tried again, so that the time is linear."""

_PIECE, _MOST, _MARK = 1000, 50_000, "777"
"""Move lines are remembered in pieces of so many characters at least and at most, up to a line in which these digits stand."""

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


class Cursor(Lines):
    """The place in the text: hands out lines, and blocks of move lines as numbers. `sent` collects what was taken, as it stands in the text."""

    def __init__(self, text: str, controller: Controller, memory: Memory = NO_MEMORY) -> None:
        super().__init__(text)
        self._axes = controller.axes
        self._memory = memory
        self.sent: list[Sent] = []
        self.decimals = 0
        move = "".join(letter + _NUMBER for letter in controller.axes) + "\n"
        self._block = re.compile(f"(?:{move})++")

    def take(self) -> str:
        """The next line, which the controller is sent.

        Raises:
            Refusal: there is none, it is a comment, or it is longer than the controller takes.
        """
        content = self.peek()
        if self.at_end:
            self.refuse("is missing: the text ends too early")
        if content.startswith(";"):
            self.refuse(f"is a comment after the header: {shown(content)}")
        if len(content) > MOST_LINE:
            self.refuse(f"has {len(content)} characters: the controller takes {MOST_LINE}")
        self.sent.append(Sent(self.line, content))
        self.skip()
        return content

    def block(self) -> Array | None:
        """The move lines from here on (k, n), or None where the next line is none."""
        pieces: list[Array] = []
        while self._text.startswith(self._axes[0], self._place):
            if isinstance(self._memory, Forgetful):
                text = self._text
                points, length, decimals = self._moves(text, self._place)
            else:
                text = self._text[self._place : self._piece_end()]
                key = ("move lines", self._axes, text)
                points, length, decimals = recall(self._memory, key, partial(self._moves, text))
            if not length:
                break
            go_on()
            pieces.append(points)
            self.sent.append(Sent(self.line, self._text[self._place : self._place + length - 1]))
            self._place += length
            self.line += len(points)
            self.decimals = max(self.decimals, decimals)
        if len(pieces) == 1:
            return pieces[0]
        return np.concatenate(pieces) if pieces else None

    def _piece_end(self) -> int:
        """Up to where lines are remembered together: to the end of a short sequence, else to a line with a mark that moves with the text when it is edited."""
        begin, most = self._place + _PIECE, self._place + _MOST
        end = self._text.find("\nT", self._place, begin)  # a TM, which is no move line
        if end >= 0:
            return end + 1
        mark = self._text.find(_MARK, begin, most)
        return self._text.find("\n", most if mark < 0 else mark) + 1 or len(self._text)

    def _moves(self, text: str, place: int = 0) -> tuple[Array, int, int]:
        """The move lines from a place in a text on (k, n), how long they are, and how many decimals they have at most."""
        found = self._block.match(text, place)
        if found is None:
            return np.empty((0, len(self._axes))), 0, 0
        points, decimals = read_numbers(found.group(), len(self._axes))
        points.setflags(write=False)  # it is remembered
        return points, found.end() - place, decimals

    def move_follows(self) -> bool:
        """Whether a move line comes next, other outputs and the guard's flag left out."""
        rest = re.compile(r"(?:P8100=[01]\n|M[0-9]{1,4}==[^\n]*\n)*+")
        found = rest.match(self._text, self._place)
        return self._block.match(self._text, found.end() if found else self._place) is not None

    def expect(self, *lines: str) -> None:
        """The next lines are these."""
        for line in lines:
            if (found := self.take()) != line:
                self.refuse(f"is {shown(found)} where {shown(line)} belongs", back=1)


def shown(line: str) -> str:
    """A line in a message, cut short."""
    return f"'{line[:60]}...'" if len(line) > 63 else f"'{line}'"
