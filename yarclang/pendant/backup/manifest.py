"""The manifest of a backup: a list of its files, with the robot, the time, and the version of yarclang.

Each line is a JSON value: first the head, then the files, the files that were left out, and the files that
didn't exist before a restore. A single JSON value with 20,000 files would block the Python interpreter while
it is parsed, and with it the loop that streams to the controller.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, ValidationError

from yarclang.coordinator.messages.message import Message
from yarclang.pendant.backup.bounds import MANIFEST, MOST_FILES
from yarclang.pendant.backup.reading import refused
from yarclang.runtime.actions import Trouble

FORMAT = 1

_LONGEST = 16_000
"""Longest line [bytes]."""
_BREATH = 100
"""Number of lines after which the parsing thread pauses briefly, so that it doesn't block other threads."""

_Short = Annotated[str, Field(max_length=1000)]


class Head(Message):
    """The first line of a manifest.

    Attributes:
        format: version of the manifest's format.
        yarclang: version of yarclang.
        robot: name of the robot.
        fingerprint: fingerprint of the robot.
        made: time of the backup, ISO 8601 in UTC.
        logs: True if logs of runs are included.
        part: True for a backup of the files that a restore has changed, False for a backup of the whole
            project.
    """

    format: int
    yarclang: _Short
    robot: _Short
    fingerprint: _Short
    made: _Short
    logs: bool
    part: bool


class ListedFile(Message):
    """A file of a backup. `changing` is True if the file was changed while it was read for the backup."""

    file: _Short
    size: int
    sha256: _Short
    changing: bool = False


class LeftOut(Message):
    """A file of the project that isn't in a backup, with the reason."""

    file: _Short
    why: _Short


class Absent(Message):
    """A file that didn't exist before a restore."""

    absent: _Short


@dataclass(frozen=True, slots=True)
class Manifest:
    """The list of a backup's files.

    Attributes:
        head: first line, with data about the robot and yarclang.
        files: files in the backup.
        left_out: files that couldn't be included.
        absent: files that a restore has created. Only the backup that undoes the restore names them.
    """

    head: Head
    files: tuple[ListedFile, ...]
    left_out: tuple[LeftOut, ...]
    absent: tuple[str, ...]

    def lines(self) -> Iterator[bytes]:
        """Yield the lines of the manifest."""
        rows = (self.head, *self.files, *self.left_out, *(Absent(absent=one) for one in self.absent))
        for count, one in enumerate(rows):
            if count % _BREATH == _BREATH - 1:
                time.sleep(0.0005)
            yield one.model_dump_json().encode() + b"\n"


def manifest_of(text: bytes) -> Manifest:
    """Parse a manifest.

    Raises:
        Trouble: the text is no manifest, or its format has another version.
    """
    lines = text.split(b"\n")
    if lines and not lines[-1]:
        lines.pop()
    if not lines or len(lines) > 3 * MOST_FILES + 1 or max(map(len, lines)) > _LONGEST:
        raise _unknown()
    files: list[ListedFile] = []
    left_out: list[LeftOut] = []
    absent: list[str] = []
    try:
        head = Head.model_validate_json(lines[0])
        for count, line in enumerate(lines[1:]):
            if count % _BREATH == _BREATH - 1:
                time.sleep(0.0005)
            if line.startswith(b'{"absent"'):
                absent.append(Absent.model_validate_json(line).absent)
            elif b'"sha256"' in line:
                files.append(ListedFile.model_validate_json(line))
            else:
                left_out.append(LeftOut.model_validate_json(line))
    except (ValidationError, RecursionError):
        raise _unknown() from None
    if head.format != FORMAT:
        raise refused(f"its list {MANIFEST} has the format {head.format}, but only {FORMAT} is supported")
    return Manifest(head, tuple(files), tuple(left_out), tuple(absent))


def _unknown() -> Trouble:
    return refused(f"its list {MANIFEST} can't be read, or is of another version of yarclang")
