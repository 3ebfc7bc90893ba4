"""Standard error as a screen: whole lines, and one that changes."""

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
"""Columns of a terminal that doesn't say how many it has."""

_STAYS = "\xa0"
_TOGETHER = re.compile(r"(?<=\d) (?=(?:deg|mm|s|ms)\b|%)|(?<=\bJ\d) (?=[-+]?\d)")
"""A space that no line ends at: between a joint and its value, and a value and its unit."""

_VALUE = re.compile(r"(?:-?\d+\.\d+|left)(?= |$)")


class Screen:
    """Standard error, written by a thread of its own: a terminal that was stopped by Ctrl-S, or is gone, delays no robot."""

    def __init__(self) -> None:
        self.live = sys.stderr.isatty()
        self._shown = False
        self._queue: SimpleQueue[str | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._write, name="screen", daemon=True)
        self._thread.start()

    def say(self, text: str, below: str = "") -> None:
        """Write whole lines; on a terminal, broken where words end.

        Args:
            text: the lines.
            below: on a terminal, the line that changes from then on; none if empty.
        """
        before = "\r\x1b[K" if self._shown else ""
        self._shown = self.live and bool(below)
        after = _changing(below) if self._shown else ""
        self._queue.put(f"{before}{self._broken(text) if self.live else text}\n{after}")

    def change(self, text: str) -> None:
        """Put a line in the place of the one that changes."""
        if self._queue.empty():
            self._queue.put(_changing(text))
            self._shown = True

    def ask(self, text: str) -> None:
        """Write what somebody is to answer behind."""
        self._queue.put(text)

    def close(self) -> None:
        """Write what is left, if the terminal is still there; the line that changes goes away."""
        if self._shown:
            self._queue.put("\r\x1b[K")
            self._shown = False
        self._queue.put(None)
        self._thread.join()

    def _write(self) -> None:
        with contextlib.suppress(OSError, ValueError):  # it is gone
            while (text := self._queue.get()) is not None:
                click.echo(text, err=True, nl=False)

    def _broken(self, text: str) -> str:
        width = _columns_of(sys.stderr)
        lines: list[str] = []
        for line in text.split("\n"):
            indent = len(line) - len(line.lstrip(" ")) + 4
            long = click.unstyle(line)
            if len(long) < width or "yarc run" in line:  # what somebody may copy stays whole
                lines.append(line)
            else:
                lines += wrapped(line, width - 1, indent)
        return "\n".join(lines)


def _changing(text: str) -> str:
    """Return what puts a line in the place of the one that changes."""
    return f"\r\x1b[K{_cut(text, _columns_of(sys.stderr) - 1)}"


def wrapped(text: str, width: int | None, indent: int = 0) -> list[str]:
    """Return a text in lines of at most so many characters, which end where words end.

    Args:
        text: one line.
        width: characters; None for no limit.
        indent: of all lines but the first one.
    """
    if width is None:
        return [text]
    kept = _TOGETHER.sub(_STAYS, text)
    lines = textwrap.wrap(kept, width, subsequent_indent=" " * indent, break_on_hyphens=False)
    return [line.replace(_STAYS, " ") for line in lines]


def width_of(stream: TextIO) -> int | None:
    """Return the columns of the terminal that a stream writes to, COLUMNS first; None if it writes to no terminal: a file's lines are as long as they need to be."""
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
    """What of a line fits, to the end of a value: half a number would be another number."""
    if len(line) <= width:
        return line
    ends = [found.end() for found in _VALUE.finditer(line, 0, width + 1) if found.end() <= width]
    return line[: ends[-1] if ends else max(width, 0)]
