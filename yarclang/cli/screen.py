"""Standard error as a screen: complete lines, and below them one status line that changes in place."""

from __future__ import annotations

import contextlib
import os
import re
import sys
import textwrap
import threading
from queue import SimpleQueue
from typing import TextIO

import click

_WIDTH = 80
"""Columns of a terminal of unknown width."""

_STAYS = "\xa0"
_TOGETHER = re.compile(r"(?<=\d) (?=(?:deg|mm|s|ms)\b|%)|(?<=\bJ\d) (?=[-+]?\d)")
"""A space at which no line is wrapped: between a joint and its value, or between a value and its unit."""

_VALUE = re.compile(r"(?:-?\d+\.\d+|left)(?= |$)")


class Screen:
    """Output on standard error, written by a separate thread, so that a terminal that was closed, or stopped
    by Ctrl-S, doesn't delay the robot.
    """

    def __init__(self) -> None:
        self.live = sys.stderr.isatty()
        self._shown = False
        self._queue: SimpleQueue[str | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._write, name="screen", daemon=True)
        self._thread.start()

    def say(self, text: str, below: str = "") -> None:
        """Write complete lines. On a terminal they are wrapped between words.

        Args:
            text: the lines.
            below: on a terminal, the new text of the status line below them; empty for none.
        """
        before = "\r\x1b[K" if self._shown else ""
        self._shown = self.live and bool(below)
        after = _changing(below) if self._shown else ""
        self._queue.put(f"{before}{self._broken(text) if self.live else text}\n{after}")

    def change(self, text: str) -> None:
        """Replace the status line."""
        if self._queue.empty():
            self._queue.put(_changing(text))
            self._shown = True

    def ask(self, text: str) -> None:
        """Write a question. The user types the answer after it."""
        self._queue.put(text)

    def close(self) -> None:
        """Write the remaining lines, if the terminal is still open, and remove the status line."""
        if self._shown:
            self._queue.put("\r\x1b[K")
            self._shown = False
        self._queue.put(None)
        self._thread.join()

    def _write(self) -> None:
        with contextlib.suppress(OSError, ValueError):  # the terminal is closed
            while (text := self._queue.get()) is not None:
                click.echo(text, err=True, nl=False)

    def _broken(self, text: str) -> str:
        width = _columns_of(sys.stderr)
        lines: list[str] = []
        for line in text.split("\n"):
            indent = len(line) - len(line.lstrip(" ")) + 4
            long = click.unstyle(line)
            if len(long) < width or "yarc run" in line:  # don't break lines that may be copied
                lines.append(line)
            else:
                lines += wrapped(line, width - 1, indent)
        return "\n".join(lines)


def _changing(text: str) -> str:
    """Return the control codes and the text that replace the status line."""
    return f"\r\x1b[K{_cut(text, _columns_of(sys.stderr) - 1)}"


def wrapped(text: str, width: int | None, indent: int = 0) -> list[str]:
    """Wrap a text into lines of at most `width` characters, between words.

    Args:
        text: one line.
        width: number of characters; None for no limit.
        indent: indentation of all lines except the first.
    """
    if width is None:
        return [text]
    kept = _TOGETHER.sub(_STAYS, text)
    lines = textwrap.wrap(kept, width, subsequent_indent=" " * indent, break_on_hyphens=False)
    return [line.replace(_STAYS, " ") for line in lines]


def width_of(stream: TextIO) -> int | None:
    """Return the number of columns of a stream's terminal; None if the stream is no terminal, since the lines
    of a file have no limit. The variable COLUMNS overrides the terminal's width.
    """
    if not stream.isatty():
        return None
    wanted = os.environ.get("COLUMNS", "")
    if wanted.isascii() and wanted.isdigit() and int(wanted) > 0:
        return int(wanted)
    return _columns_of(stream)


def _columns_of(stream: TextIO) -> int:
    try:
        return os.get_terminal_size(stream.fileno()).columns or _WIDTH
    except (OSError, ValueError):
        return _WIDTH


def _cut(line: str, width: int) -> str:
    """Return the beginning of a line that fits on the terminal. It ends after a complete value, because half
    a number would be a wrong number.
    """
    if len(line) <= width:
        return line
    ends = [found.end() for found in _VALUE.finditer(line, 0, width + 1) if found.end() <= width]
    return line[: ends[-1] if ends else max(width, 0)]
