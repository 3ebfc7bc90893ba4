"""The SQLite file of a pendant, with its users, sessions, audit trail and alarms. One thread writes to the
file; each change is one transaction.
"""

from __future__ import annotations

import asyncio
import os
import sqlite3
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from yarclang.files import reason_of
from yarclang.runtime.actions import Trouble

T = TypeVar("T")
P = ParamSpec("P")

VERSION = 2
"""Version of the tables."""

_WAIT = 5.0
"""Longest wait while another process locks the file [s]."""

_TABLES = """
CREATE TABLE users (
    name TEXT PRIMARY KEY COLLATE NOCASE, role TEXT NOT NULL, password TEXT NOT NULL, pin TEXT, created TEXT NOT NULL
) STRICT;
CREATE TABLE sessions (
    id TEXT PRIMARY KEY, token BLOB UNIQUE NOT NULL, user TEXT NOT NULL COLLATE NOCASE REFERENCES users ON DELETE CASCADE,
    created REAL NOT NULL, seen REAL NOT NULL, address TEXT NOT NULL, agent TEXT NOT NULL
) STRICT;
CREATE TABLE devices (
    device BLOB NOT NULL, user TEXT NOT NULL COLLATE NOCASE REFERENCES users ON DELETE CASCADE, created REAL NOT NULL,
    PRIMARY KEY (device, user)
) STRICT;
CREATE TABLE audit (
    number INTEGER PRIMARY KEY AUTOINCREMENT, time TEXT NOT NULL, user TEXT NOT NULL, address TEXT NOT NULL,
    action TEXT NOT NULL, detail TEXT NOT NULL, outcome TEXT NOT NULL
) STRICT;
CREATE TRIGGER audit_stays BEFORE UPDATE ON audit BEGIN SELECT RAISE(ABORT, 'the audit trail is never changed'); END;
CREATE TRIGGER audit_remains BEFORE DELETE ON audit BEGIN SELECT RAISE(ABORT, 'the audit trail is never changed'); END;
"""  # noqa: E501

_ALARMS = """
CREATE TABLE alarms (
    number INTEGER PRIMARY KEY, time REAL NOT NULL, last REAL NOT NULL, count INTEGER NOT NULL, ended REAL,
    acknowledged REAL, by TEXT NOT NULL, source TEXT NOT NULL, code TEXT NOT NULL, what TEXT NOT NULL,
    remedy TEXT NOT NULL, stood TEXT NOT NULL
) STRICT;
"""

_STEPS = (_TABLES, _ALARMS)
"""SQL statements that upgrade the tables, one item for each version. The first item creates the tables in an
empty file. Each further item upgrades the tables from the previous version.
"""


class Database:
    """Connection to the SQLite file.

    Args:
        path: the file. If missing, the file and its folder are created, readable only for the system user of
            this process.

    Raises:
        Trouble: the file is damaged, is no database, was written by a later version of yarclang, or can't be
            read or written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            os.close(os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600))
        except OSError as error:
            raise self._trouble(reason_of(error)) from None
        self._thread = ThreadPoolExecutor(1, "accounts")
        try:
            self._connection = self._thread.submit(self._open).result()
        except sqlite3.Error as error:
            self._thread.shutdown()
            raise self._trouble(str(error)) from None
        self._opened = self._identity()

    def _identity(self) -> tuple[int, int] | None:
        """Return the device and inode of the file at the path; None if there is none. SQLite would write to a
        file that was removed without any error.
        """
        try:
            found = self.path.stat()
        except OSError:
            return None
        return found.st_dev, found.st_ino

    def _open(self) -> sqlite3.Connection:
        connection = sqlite3.connect(self.path, timeout=_WAIT, isolation_level=None, check_same_thread=False)
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")
            connection.execute("PRAGMA foreign_keys = ON")
            found = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
            if found != "ok":
                raise sqlite3.DatabaseError(f"it is damaged ({found})")
            version = connection.execute("PRAGMA user_version").fetchone()[0]
            if version > VERSION:
                raise sqlite3.DatabaseError(
                    f"a later version of yarclang has written it (table version {version})"
                )
            if version < VERSION:
                made = " ".join(_STEPS[version:])
                connection.executescript(f"BEGIN IMMEDIATE; {made} PRAGMA user_version = {VERSION}; COMMIT;")
        except BaseException:
            connection.close()
            raise
        return connection

    async def call(
        self, do: Callable[Concatenate[sqlite3.Connection, P], T], *arguments: P.args, **named: P.kwargs
    ) -> T:
        """Call a function with the database connection, as one transaction in the writing thread. Return what
        the function returns.

        Raises:
            Trouble: the file can't be read or written now; the transaction has changed nothing.
        """
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._thread, lambda: self.now(do, *arguments, **named))

    def now(
        self, do: Callable[Concatenate[sqlite3.Connection, P], T], *arguments: P.args, **named: P.kwargs
    ) -> T:
        """Call a function with the database connection, as one transaction in the calling thread."""
        connection = self._connection
        if self._identity() != self._opened:
            raise self._trouble("it was removed or replaced while it was in use")
        try:
            connection.execute("BEGIN IMMEDIATE")
            try:
                result = do(connection, *arguments, **named)
            except BaseException:
                if connection.in_transaction:
                    connection.execute("ROLLBACK")
                raise
            connection.execute("COMMIT")
        except sqlite3.Error as error:
            if connection.in_transaction:
                connection.execute("ROLLBACK")
            raise self._trouble(str(error)) from None
        return result

    def close(self) -> None:
        """Write pending changes and close the file."""
        self._thread.submit(self._connection.close)
        self._thread.shutdown()

    def _trouble(self, reason: str) -> Trouble:
        if "full" in reason:
            remedy = "make room on the disk"
        elif "locked" in reason or "busy" in reason:
            remedy = "another program has opened the file: end that program"
        elif "removed" in reason:
            remedy = "put the file back, or restart the pendant"
        else:
            remedy = f"check the file; to start with new users, move {self.path} away"
        return Trouble(
            f"the pendant's users and audit trail, {self.path}, can't be used: {reason}", remedy, ""
        )
