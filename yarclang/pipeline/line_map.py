"""The way back from a line of controller text to the command that it belongs to, by the text's own comments.

The header's map names every command, its line in the source, and the first and last of its moves. What stands between the moves
is given to its command by its form and order: an assignment is a SET's, a dwell a WAIT's. Nothing is proved here, and no robot is needed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from yarclang.certify.read.header import header_of
from yarclang.certify.read.text import Unreadable
from yarclang.frozen import frozen

_PUT = re.compile(r"(?!P8100=)[IPQM]\d+=.*")
_GUARD = re.compile(r"P8100=([01])")
_SPLINE = "SPLINE1"


@frozen
class Listed:
    """A command as the header lists it; `first` and `last` are its move lines, None for one without."""

    step: int
    index: str
    name: str
    source_line: int
    first: int | None
    last: int | None

    @property
    def title(self) -> str:
        """`P0010 MOVEL`, or the name alone."""
        return f"{self.index} {self.name}" if self.index else self.name


@frozen
class Stretch:
    """Neighbouring lines `first` to `last` of the text with one purpose, `what`, and the command that they belong to, if any."""

    first: int
    last: int
    command: Listed | None
    what: str


@frozen
class LineMap:
    """What each line of a text is for.

    `program` is the source's file name, `robot` and `fingerprint` are what the header says of the robot and the program,
    `stretches` cover all lines, in order.
    """

    program: str
    robot: str
    fingerprint: str
    commands: tuple[Listed, ...]
    stretches: tuple[Stretch, ...]

    def at(self, line: int) -> Stretch | None:
        """The stretch of a line (from 1); None where the text has no such line."""
        return next((one for one in self.stretches if one.first <= line <= one.last), None)

    def of(self, step: int) -> tuple[Stretch, ...]:
        """The stretches of a command behind the header."""
        return tuple(
            one
            for one in self.stretches
            if one.command is not None and one.command.step == step and one.what != HEADER
        )


HEADER = "it lists the command in the header"
OPENING = "it prepares the controller and brings the robot to the start, before the first command"
MOVE = "a move"
_TIME = "the segment time of the moves that follow"
_GUARDS = ("it disarms the guard: fewer lines than it wants are left", "it arms the guard")


def is_compiled_text(text: str) -> bool:
    """Whether a text begins as those that yarcc writes."""
    return text.startswith("; yarcc ")


def map_lines(text: str) -> LineMap:
    """Read the comments of a text that yarcc has written. Of another text all lines are one stretch without a command."""
    lines = text.split("\n")[:-1] if text.endswith("\n") else text.split("\n") if text else []
    preamble = header_of(text)
    if isinstance(preamble, Unreadable):
        whole = (Stretch(1, len(lines), None, f"unknown: line {preamble.line} {preamble.reason}"),)
        return LineMap("", "", "", (), whole if lines else ())
    listed = {
        entry.at: Listed(entry.step, entry.index, entry.name, entry.source_line, entry.first, entry.last)
        for entry in preamble.entries
    }
    barriers = {line: barrier.step for line, barrier in preamble.barriers.items()}
    end = next((number for number, line in enumerate(lines) if not line.startswith(";")), len(lines))
    header = (
        Stretch(n, n, listed.get(n), HEADER if n in listed else "a comment of the header")
        for n in range(1, end + 1)
    )
    commands = tuple(listed.values())
    body = _merged(_body(lines, end, commands, barriers))
    said = preamble.header
    return LineMap(said.source, said.robot, said.program_fingerprint, commands, (*header, *body))


_AT_REST = "DWELL0"
"""Before an output is set, or before a barrier; a dwell of the program has a time."""


def _body(
    lines: list[str], begin: int, commands: tuple[Listed, ...], barriers: dict[int, int]
) -> Iterator[Stretch]:
    """The purpose of every line behind the header, line by line."""
    by_step = {one.step: one for one in commands}
    moving = [one for one in commands if one.first is not None]
    still = [one for one in commands if one.first is None and one.name != "STOP"]
    opened = next((n for n in range(begin + 1, len(lines) + 1) if lines[n - 1] == _SPLINE), len(lines))
    yield from (Stretch(number, number, None, OPENING) for number in range(begin + 1, opened + 1))
    barrier: Listed | None = None
    for number in range(opened + 1, len(lines) + 1):
        line = lines[number - 1]
        while moving and number > (moving[0].last or 0):
            moving.pop(0)
        mover = moving[0] if moving else None
        command: Listed | None = None
        what = "it ends the program"
        if mover is not None and (mover.first or 0) <= number and not _GUARD.fullmatch(line):
            command, what = mover, MOVE
        elif found := _GUARD.fullmatch(line):
            command, what = mover, _GUARDS[int(found[1])]
        elif line.startswith("TM"):
            command, what = mover, _TIME
        elif number in barriers:
            command = barrier = by_step.get(barriers[number])
            what = "a barrier: the program goes no further by itself"
            while still and command is not None and still[0].step <= command.step:
                still.pop(0)
        elif barrier is not None:
            command, what = barrier, "of its barrier, and a slow way back to where the robot stands already"
            if line == _SPLINE:
                barrier = None
        elif line.startswith("DWELL") and still:
            command, what = still[0], "the robot comes to rest before it"
            if line != _AT_REST:
                what = "its dwell"
                still.pop(0)
        elif _PUT.fullmatch(line) and still:
            command, what = still.pop(0), "its assignment"
        yield Stretch(number, number, command, what)


def _merged(stretches: Iterator[Stretch]) -> Iterator[Stretch]:
    """Neighbours with one command and purpose as one stretch."""
    last: Stretch | None = None
    for one in stretches:
        if last is not None and last.command is one.command and last.what == one.what:
            last = replace(last, last=one.last)
            continue
        if last is not None:
            yield last
        last = one
    if last is not None:
        yield last
