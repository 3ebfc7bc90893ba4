"""The position in a text for a Turbo PMAC: reads single lines, and blocks of move lines as numbers."""

from __future__ import annotations

import re
from functools import partial

import numpy as np

from yarclang.certify.read.lines import Lines, shown
from yarclang.certify.read.numbers import read_numbers
from yarclang.certify.read.text import Sent
from yarclang.memory import NO_MEMORY, Forgetful, Memory, recall
from yarclang.pmac.controller import TurboPmac
from yarclang.pmac.requests import MOST_LINE
from yarclang.progress import go_on
from yarclang.robot.model import Array

_NUMBER = r"-?[0-9]{1,7}+(?:\.[0-9]{1,12}+)?+"
"""Pattern of a number in a move line. Its quantifiers are possessive, so that matching takes linear time."""

_PIECE, _MOST, _MARK = 1000, 50_000, "777"
"""Division of move lines into pieces for the cache: the least and the largest number of characters of a
piece, and the digits that mark a line as the last one of a piece.
"""


class Cursor(Lines):
    """A position in the text, from which single lines are read, and blocks of move lines as numbers.

    `sent` collects the lines that were read, as they are in the text.
    """

    def __init__(self, text: str, controller: TurboPmac, memory: Memory = NO_MEMORY) -> None:
        super().__init__(text)
        self._axes = controller.axes
        self._memory = memory
        self.sent: list[Sent] = []
        self.decimals = 0
        move = "".join(letter + _NUMBER for letter in controller.axes) + "\n"
        self._block = re.compile(f"(?:{move})++")

    def take(self) -> str:
        """Return the next line, which will be sent to the controller, and move on.

        Raises:
            Refusal: there is no line, it is a comment, or it is too long for the controller.
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
        """Return the move lines from here on (k, n); None if the next line is not a move line."""
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
        """Return the position after the next piece of move lines, which is cached as a whole.

        A short sequence of moves is one piece. A long sequence is divided after lines that contain certain
        digits. An edit therefore changes only the pieces around it, and all other pieces are still in the
        cache.
        """
        begin, most = self._place + _PIECE, self._place + _MOST
        end = self._text.find("\nT", self._place, begin)  # a TM ends the move lines
        if end >= 0:
            return end + 1
        mark = self._text.find(_MARK, begin, most)
        return self._text.find("\n", most if mark < 0 else mark) + 1 or len(self._text)

    def _moves(self, text: str, place: int = 0) -> tuple[Array, int, int]:
        """Read the move lines of a text from position `place` on.

        Returns:
            The numbers (k, n), the length of the lines in characters, and the largest number of decimals.
        """
        found = self._block.match(text, place)
        if found is None:
            return np.empty((0, len(self._axes))), 0, 0
        points, decimals = read_numbers(found.group(), len(self._axes))
        points.setflags(write=False)  # the array may be cached
        return points, found.end() - place, decimals

    def move_follows(self) -> bool:
        """Return True if a move line follows, perhaps after lines that set outputs or the guard's flag."""
        rest = re.compile(r"(?:P8100=(?:1|P8100&2)\n|M[0-9]{1,4}==[^\n]*\n)*+")
        found = rest.match(self._text, self._place)
        return self._block.match(self._text, found.end() if found else self._place) is not None

    def expect(self, *lines: str) -> None:
        """Read lines that must equal the given ones."""
        for line in lines:
            if (found := self.take()) != line:
                self.refuse(f"is {shown(found)}; expected: {shown(line)}", back=1)
