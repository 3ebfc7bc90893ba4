"""Find the command to which a line of controller text belongs, from the comments in the text.

The header of the text lists every command with its source line and its first and last move line. Lines
between the moves are assigned to a command by the kind of controller that the header's target names
(`Backend.purposes`). Nothing is proved here, and no robot is needed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from yarclang.backend import backend_for
from yarclang.certify.read.header import header_of
from yarclang.certify.read.text import Unreadable
from yarclang.emitted.purposes import Listed, Stretch, moves_alone
from yarclang.frozen import frozen


@frozen
class LineMap:
    """The purpose of each line of a controller text.

    Attributes:
        program: file name of the source.
        robot: the robot's name, from the header.
        fingerprint: fingerprint of the robot, from the header.
        commands: the commands that the header lists.
        stretches: groups of consecutive lines with one purpose, in order. They cover all lines.
    """

    program: str
    robot: str
    fingerprint: str
    commands: tuple[Listed, ...]
    stretches: tuple[Stretch, ...]

    def at(self, line: int) -> Stretch | None:
        """Return the group of lines that contains a line (from 1); None if the text has no such line."""
        return next((one for one in self.stretches if one.first <= line <= one.last), None)

    def of(self, step: int) -> tuple[Stretch, ...]:
        """Return the groups of lines that belong to a command, without those in the header."""
        return tuple(
            one
            for one in self.stretches
            if one.command is not None and one.command.step == step and one.what != HEADER
        )


HEADER = "it lists the command in the header"


def is_compiled_text(text: str) -> bool:
    """Return True if a text begins like a text of yarcc."""
    return text.startswith("; yarcc ")


def map_lines(text: str) -> LineMap:
    """Find the purpose of each line of a text of yarcc from its comments. Any other text becomes a single
    group of lines without a command.
    """
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
    said = preamble.header
    backend = backend_for(said.target)
    purposes = moves_alone if backend is None else backend.purposes
    body = _merged(purposes(lines, end, commands, barriers))
    return LineMap(said.source, said.robot, said.program_fingerprint, commands, (*header, *body))


def _merged(stretches: Iterator[Stretch]) -> Iterator[Stretch]:
    """Merge neighbouring groups of lines that have the same command and purpose."""
    last: Stretch | None = None
    for stretch in stretches:
        if last is not None and last.command is stretch.command and last.what == stretch.what:
            last = replace(last, last=stretch.last)
            continue
        if last is not None:
            yield last
        last = stretch
    if last is not None:
        yield last
