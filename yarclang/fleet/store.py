"""Store of results in a file of the user's cache folder, safe for many processes, limited in size.

Each entry has a message authentication code (HMAC-SHA256) with a secret of this user, which is stored
elsewhere. An entry that somebody else has written, or that was changed or moved to another key, is never
used. Each entry is written as a whole or not at all, even if the process that writes it is killed: SQLite
ensures this. A store that can't be used, because the disk is full or the file is damaged, behaves like an
empty one.
"""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TypeVar

from yarclang.signing import is_signed, secret_in, signature

R = TypeVar("R")

LARGEST = 2_000_000_000
"""Size of all entries above which the least recently used entries are dropped [bytes]."""

_LARGEST_ENTRY = 200_000_000
_KEPT = 0.8
"""Size to which the store is reduced when it has become too large, as a share of its largest size."""

_PATIENCE = 5.0
"""Longest wait while another process writes [s]."""

_SCHEMA = """
CREATE TABLE IF NOT EXISTS entries (
    id INTEGER PRIMARY KEY, key TEXT NOT NULL, code BLOB NOT NULL, used REAL NOT NULL, size INTEGER NOT NULL, value BLOB NOT NULL
);
CREATE INDEX IF NOT EXISTS by_key ON entries (key, used);
CREATE INDEX IF NOT EXISTS by_use ON entries (used, size);
"""  # noqa: E501


class Store:
    """A store of bytes by keys, in a file. A key may have several entries.

    Args:
        folder: the folder of the store's file.
        secret: file with the secret for authentication codes. Folder and file are created if they don't
            exist.
        largest: size of all entries above which the least recently used entries are dropped [bytes].
    """

    def __init__(self, folder: Path, secret: Path, largest: int = LARGEST) -> None:
        self._file = folder / "results.sqlite"
        self._secret_file = secret
        self._largest = largest
        self._secret = b""
        self._base: sqlite3.Connection | None = None
        self.trouble = ""
        """Reason why the store can't be used; empty if it can."""

    def get(self, key: str) -> Iterator[tuple[int, bytes]]:
        """Yield the numbers and values of a key's entries that this user has written, the most recently used
        first.
        """
        query = "SELECT id, code FROM entries WHERE key = ? ORDER BY used DESC"
        nothing: list[tuple[int, object]] = []
        for number, code in self._ask(lambda base: base.execute(query, (key,)).fetchall(), nothing):
            value = self._ask(partial(_value, number=number), None)
            if isinstance(value, bytes) and isinstance(code, bytes) and self._is_ours(key, value, code):
                yield number, value

    def use(self, number: int) -> None:
        """Record that an entry was used."""
        change = "UPDATE entries SET used = ? WHERE id = ?"
        self._ask(lambda base: base.execute(change, (time.time(), number)).rowcount, 0)

    def put(self, key: str, value: bytes) -> None:
        """Add an entry. Drop the least recently used entries if the store gets too large."""
        if len(value) > min(_LARGEST_ENTRY, self._largest):
            return

        def add(base: sqlite3.Connection) -> None:
            row = (key, self._code(key, value), time.time(), len(value), value)
            base.execute("INSERT INTO entries (key, code, used, size, value) VALUES (?, ?, ?, ?, ?)", row)
            self._drop(base)

        self._ask(add, None)

    def drop(self, number: int) -> None:
        """Remove an entry that is no longer useful."""
        self._ask(lambda base: base.execute("DELETE FROM entries WHERE id = ?", (number,)).rowcount, 0)

    def close(self) -> None:
        """Close the store's file."""
        if self._base is not None:
            with suppress(sqlite3.Error):
                self._base.close()
            self._base = None

    def _drop(self, base: sqlite3.Connection) -> None:
        size = base.execute("SELECT COALESCE(SUM(size), 0) FROM entries").fetchone()[0]
        if size <= self._largest:
            return
        surplus = size - int(_KEPT * self._largest)
        unwanted = []
        for number, one in base.execute("SELECT id, size FROM entries ORDER BY used"):
            if surplus <= 0:
                break
            unwanted.append((number,))
            surplus -= one
        base.executemany("DELETE FROM entries WHERE id = ?", unwanted)

    def _ask(self, work: Callable[[sqlite3.Connection], R], otherwise: R) -> R:
        """Open the store if necessary, call a function with it, and return the function's result. After an
        error the store isn't used any more, and `otherwise` is returned.
        """
        if self.trouble:
            return otherwise
        try:
            if self._base is None:
                self._base = self._opened()
            with self._base:
                return work(self._base)
        except sqlite3.OperationalError as error:  # locked too long, a full disk, no rights
            self.trouble = str(error)
        except sqlite3.DatabaseError as error:
            self.trouble = str(error)
            self._set_aside()
        except OSError as error:
            self.trouble = str(error)
        return otherwise

    def _opened(self) -> sqlite3.Connection:
        self._file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        self._secret = secret_in(self._secret_file)
        base = sqlite3.connect(self._file, timeout=_PATIENCE)
        base.execute("PRAGMA journal_mode = WAL")
        base.execute("PRAGMA synchronous = NORMAL")
        base.execute("PRAGMA auto_vacuum = INCREMENTAL")
        base.executescript(_SCHEMA)
        return base

    def _set_aside(self) -> None:
        """Remove a damaged file, so that the next process begins with an empty store."""
        self.close()
        for ending in ("", "-wal", "-shm"):
            with suppress(OSError):
                self._file.with_name(self._file.name + ending).unlink()

    def _code(self, key: str, value: bytes) -> bytes:
        return signature(self._secret, (key.encode(), value))

    def _is_ours(self, key: str, value: bytes, code: bytes) -> bool:
        return is_signed(code, self._secret, (key.encode(), value))


def _value(base: sqlite3.Connection, number: int) -> object:
    row = base.execute("SELECT value FROM entries WHERE id = ?", (number,)).fetchone()
    return None if row is None else row[0]
