"""The place in a controller text that is read: its lines one by one, and blocks of move lines as numbers."""

from __future__ import annotations

import re
from functools import partial
from typing import NoReturn

import numpy as np

from yarclang.memory import NO_MEMORY, Forgetful, Memory, recall
from yarclang.robot.model import Array, Controller

_NUMBER = r"-?[0-9]{1,7}+(?:\.[0-9]{1,12}+)?+"
"""Possessive: a line that has matched is never tried again, so that the time is linear."""

_PIECE, _MOST, _MARK = 1000, 50_000, "777"
"""Move lines are remembered in pieces of so many characters at least and at most, up to a line in which these digits stand."""


class Refusal(Exception):  # noqa: N818 - never leaves the reader
    """Line, reason and code of an `Unreadable`."""


class Cursor:
    """The place in the text: hands out lines, and blocks of move lines as numbers."""

    def __init__(self, text: str, controller: Controller, memory: Memory = NO_MEMORY) -> None:
        self._text = text
        self._place = 0
        self._axes = controller.axes
        self._memory = memory
        self.line = 1  # of the line that comes next
        self.decimals = 0
        move = "".join(letter + _NUMBER for letter in controller.axes) + "\n"
        self._block = re.compile(f"(?:{move})++")
        self._blank = str.maketrans(dict.fromkeys((*controller.axes, "\n"), " "))

    @property
    def at_end(self) -> bool:
        """Whether all lines were taken."""
        return self._place == len(self._text)

    def peek(self) -> str:
        """The next line, left where it is; empty at the end."""
        return self._text[self._place : self._text.find("\n", self._place)] if not self.at_end else ""

    def take(self) -> str:
        """The next line, comments left out."""
        self.skip_remarks()
        content = self.peek()
        if self.at_end:
            self.refuse("the text ends too early")
        self.skip()
        return content

    def skip_remarks(self) -> None:
        """Go over comments; those that the header gives a meaning belong there."""
        while self.peek().startswith(";"):
            if re.match(r"; *(command|target|barrier)\b", self.peek()):
                self.refuse("is a line of the header behind the header")
            self.skip()

    def skip(self) -> None:
        """Go over a line."""
        self._place = self._text.find("\n", self._place) + 1
        self.line += 1

    def block(self) -> Array | None:
        """The move lines from here on (k, n), or None where the next line is none."""
        pieces: list[Array] = []
        while self._text.startswith(self._axes[0], self._place):
            if isinstance(self._memory, Forgetful):
                points, length, decimals = self._moves(self._text, self._place)
            else:
                text = self._text[self._place : self._piece_end()]
                key = ("move lines", self._axes, text)
                points, length, decimals = recall(self._memory, key, partial(self._moves, text))
            if not length:
                break
            pieces.append(points)
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
        block, decimals = found.group(), 0
        while re.search(rf"\.[0-9]{{{decimals + 1}}}", block):
            decimals += 1
        points = np.fromstring(block.translate(self._blank), sep=" ").reshape(-1, len(self._axes))
        points.setflags(write=False)  # it is remembered
        return points, found.end() - place, decimals

    def move_follows(self) -> bool:
        """Whether a move line comes next, other outputs, comments and the guard's flag left out."""
        rest = re.compile(r"(?:;[^\n]*\n|P8100=[01]\n|M[0-9]{1,4}==[^\n]*\n)*+")
        found = rest.match(self._text, self._place)
        return self._block.match(self._text, found.end() if found else self._place) is not None

    def expect(self, *lines: str) -> None:
        """The next lines are these."""
        for line in lines:
            if (found := self.take()) != line:
                self.refuse(f"is {shown(found)} where {shown(line)} belongs", back=1)

    def refuse(self, reason: str, *, back: int = 0, code: str = "Y1151") -> NoReturn:
        """Read no further.

        Raises:
            Refusal: for the line that comes next, or `back` lines before it.
        """
        raise Refusal(self.line - back, reason, code)


def shown(line: str) -> str:
    """A line in a message, cut short."""
    return f"'{line[:60]}...'" if len(line) > 63 else f"'{line}'"
