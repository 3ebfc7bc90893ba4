"""The state of a campaign: a file to which the result of each finished chunk of programs is appended. A
process that is killed loses only the chunks on which it was working.

The first line describes the campaign, and each further line contains a `Piece`, the sum of a chunk's results.
Each line begins with a digest of its text and of all lines before it. An incomplete last line is dropped: the
process was killed while it wrote the line, or the disk was full. Any other line with a wrong digest is an
error.
"""

from __future__ import annotations

import hashlib
import json
import os
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from yarclang.campaign.pieces import Piece, piece_of
from yarclang.files import reason_of

_FORM = 1
_LARGEST = 4_000_000_000
"""Largest file of a state that is read [bytes]. A million programs take about 100 MB."""

_DIGITS = 32


class StateError(Exception):
    """Raised if a state can't be used; the message has the reason and the remedy."""


class State:
    """The file with the state of a campaign, opened by only one process at a time.

    Args:
        path: the file; None to store nothing.
        what: description of the campaign: values by name. All of them must be the same when the campaign is
            continued.

    Raises:
        StateError: the file can't be read or written, is damaged, belongs to another campaign, or is in use
            by another process.
    """

    def __init__(self, path: Path | None, what: dict[str, Any]) -> None:
        self._path = path
        self._file: BinaryIO | None = None
        self.pieces: list[Piece] = []
        """Pieces of earlier runs, in the order in which they were done."""
        self._digest = ""
        if path is None:
            return
        head = {"campaign": _FORM, **what}
        try:
            self._file = _opened(path)
            try:
                self._read(self._file, head)
            except BaseException:
                self._file.close()
                raise
        except OSError as error:
            raise StateError(f"{path}: {reason_of(error)}; name another file by --state") from None

    def __enter__(self) -> State:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._file is not None:
            self._file.close()

    def keep(self, piece: Piece) -> None:
        """Append the result of a chunk to the file.

        Raises:
            StateError: the file can't be written. The results that were stored before are kept.
        """
        self.pieces.append(piece)
        if self._file is None:
            return
        try:
            self._append(self._file, piece.written)
        except OSError as error:
            kept = sum(one.count for one in self.pieces[:-1])
            raise StateError(
                f"{self._path} can't be written: {reason_of(error)}; the results of the {kept:,} programs "
                "before are saved"
            ) from None

    def _read(self, file: BinaryIO, head: dict[str, Any]) -> None:
        if os.fstat(file.fileno()).st_size > _LARGEST:
            raise StateError(
                f"{self._path} has more than {_LARGEST:,} bytes, so it isn't the state of a campaign"
            )
        lines = file.read().split(b"\n")
        good = 0
        for number, line in enumerate(lines[:-1], 1):
            content = self._checked(line)
            if content is None:
                if number == len(lines) - 1 and number > 1:
                    break  # a half-written line: pages may reach the disk in any order
                raise StateError(
                    f"{self._path}, line {number}, was changed or damaged: delete the file, or name "
                    "another one by --state"
                )
            if number == 1:
                self._compare(content, head)
            else:
                self._take(content, number)
            good += len(line) + 1
        if good == 0:
            # The file is empty, or contains only the beginning of a first line.
            if not self._line(head).startswith(lines[-1]):
                raise StateError(f"{self._path} isn't the state of a campaign: name another file by --state")
            file.truncate(0)
            file.seek(0)
            self._append(file, head)
            return
        file.truncate(good)
        file.seek(good)

    def _checked(self, line: bytes) -> Any:
        """Return the content of a line; None if its digest is wrong."""
        digest, _, text = line.partition(b" ")
        if digest != self._next(text):
            return None
        self._digest = digest.decode()
        with suppress(ValueError):
            return json.loads(text)
        return None

    def _take(self, content: Any, number: int) -> None:
        try:
            self.pieces.append(piece_of(content))
        except (KeyError, TypeError, ValueError):
            raise StateError(f"{self._path}, line {number}, isn't a part of a campaign") from None

    def _compare(self, found: Any, head: dict[str, Any]) -> None:
        if not isinstance(found, dict):
            raise StateError(f"{self._path} isn't the state of a campaign: name another file by --state")
        for name, value in head.items():
            if found.get(name) != value:
                raise StateError(
                    f"{self._path} belongs to another campaign: its {name} is {_short(found.get(name))}, "
                    f"here it is {_short(value)}; name another file by --state"
                )

    def _append(self, file: BinaryIO, content: dict[str, Any]) -> None:
        line = self._line(content)
        begin = file.tell()
        try:
            left = memoryview(line)
            while left:
                left = left[file.write(left) :]
            os.fsync(file.fileno())
        except OSError:
            with suppress(OSError):
                file.truncate(begin)
            raise
        self._digest = line[:_DIGITS].decode()

    def _line(self, content: dict[str, Any]) -> bytes:
        text = json.dumps(content, separators=(",", ":"), allow_nan=False).encode()
        return self._next(text) + b" " + text + b"\n"

    def _next(self, text: bytes) -> bytes:
        """Return the digest of a line's text and of all lines before it."""
        return hashlib.sha256(self._digest.encode() + b"\n" + text).hexdigest()[:_DIGITS].encode()


def _opened(path: Path) -> BinaryIO:
    """Open a file for reading and writing, and lock it."""
    if path.exists() and not path.is_file():
        raise StateError(f"{path} isn't a regular file: name another one by --state")
    # Unbuffered, so that write errors occur at the write itself.
    file = os.fdopen(
        os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o644), "r+b", buffering=0
    )
    try:
        import fcntl
    except ImportError:  # Windows
        return file
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.close()
        raise StateError(
            f"another process is using {path}: wait for it, or name another file by --state"
        ) from None
    return file


def _short(value: object) -> str:
    text = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return text if len(text) <= 60 else f"{text[:60]}…"


def missing(pieces: list[Piece], first: int, count: int, size: int) -> list[tuple[int, int]]:
    """Return the chunks of programs that still have to be checked, each as its first seed and its number of
    programs.

    Args:
        pieces: results of the finished chunks.
        first: the first seed.
        count: number of programs of the campaign.
        size: largest number of programs of a chunk.

    Raises:
        StateError: two results contain the same seed.
    """
    chunks: list[tuple[int, int]] = []
    at, end = first, first + count
    for piece in [*sorted(pieces, key=lambda one: one.first), Piece(end, 0)]:
        if piece.first < at and piece.count:
            raise StateError(
                f"the program of seed {piece.first} is recorded twice: name another file by --state"
            )
        stop = min(piece.first, end)
        chunks += [(begin, min(size, stop - begin)) for begin in range(at, stop, size)]
        at = max(at, piece.first + piece.count)
    return chunks
