"""Values that KEPT registers keep between the runs of a program, in a small database in the state folder. If
the process is killed or the power fails, each value in the database is either the old or the new one.
"""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from yarclang.decisions import Register
from yarclang.frozen import frozen
from yarclang.runtime.actions import Trouble

_LONGEST_WAIT = 5.0
"""Longest wait while another process locks the database [s]."""

_TABLE = (
    "CREATE TABLE IF NOT EXISTS kept (controller TEXT NOT NULL, program TEXT NOT NULL, register TEXT "
    "NOT NULL, "
    "value INTEGER NOT NULL, PRIMARY KEY (controller, program, register))"
)


def registers_file() -> Path:
    """Return the path of the database (XDG base directories)."""
    given = Path(os.environ.get("XDG_STATE_HOME", ""))
    return (given if given.is_absolute() else Path.home() / ".local" / "state") / "yarc" / "registers.sqlite"


def program_of(name: str) -> str:
    """Return the name under which the registers of a program are stored: its path. A program and the
    controller text compiled from it share this name.
    """
    return str(Path(name).resolve().with_suffix(""))


@frozen
class Kept:
    """The last value of a register, with its controller and program."""

    controller: str
    program: str
    register: str
    value: int


@frozen
class KeptRegisters:
    """The registers of one program on one controller.

    Attributes:
        controller: name of the robot and address of the controller. A simulated controller stores values of
            its own.
        program: name of the program, from `program_of`.
    """

    controller: str
    program: str

    def first(self, registers: Iterable[Register]) -> tuple[dict[str, int], list[str]]:
        """Return the stored values of registers, and a message for each stored value that is out of its
        register's declared range.

        Raises:
            Trouble: the database can't be read.
        """
        kept_registers = [one for one in registers if one.kept]
        if not kept_registers:
            return {}, []
        held = {one.register: one.value for one in listed(self.controller, self.program)}
        stored = {one.name: held[one.name] for one in kept_registers if one.name in held}
        beyond = {
            one.name: one
            for one in kept_registers
            if not one.low <= stored.get(one.name, one.low) <= one.high
        }
        sentences = [
            f"{name} was stored as {stored[name]}, but its range is now {one.low} to {one.high}: it "
            f"begins with {one.first}"
            for name, one in beyond.items()
        ]
        return {name: value for name, value in stored.items() if name not in beyond}, sentences

    def keep(self, name: str, value: int) -> None:
        """Store a value. When this returns, the value is on the disk.

        Raises:
            OSError: the value can't be stored.
        """
        place = registers_file()
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            with opened(place) as base, base:
                base.execute(_TABLE)
                row = self.controller, self.program, name, value
                base.execute("INSERT OR REPLACE INTO kept VALUES (?, ?, ?, ?)", row)
        except (sqlite3.Error, OSError) as error:
            raise OSError(f"{place}: {error}") from None


def listed(controller: str = "", program: str = "") -> list[Kept]:
    """Return the stored values of registers, sorted by controller, program and name of the register. An empty
    argument matches all controllers or programs.

    Raises:
        Trouble: the database can't be read.
    """
    place = registers_file()
    if not place.exists():
        return []
    try:
        with opened(place) as base:
            base.execute(_TABLE)
            rows = base.execute(
                "SELECT controller, program, register, value FROM kept WHERE (? = '' OR controller = ?) "
                "AND (? = '' OR program = ?) "
                "ORDER BY controller, program, register",
                (controller, controller, program, program),
            ).fetchall()
        return [Kept(str(where), str(what), str(name), int(value)) for where, what, name, value in rows]
    except (sqlite3.Error, OSError, ValueError) as error:
        raise unreadable(place, error) from None


def forget(program: str) -> int:
    """Delete all stored register values of a program, for all controllers. Return the number of deleted
    values.

    Raises:
        Trouble: the database can't be read or written.
    """
    return deleted(_TABLE, "DELETE FROM kept WHERE program = ?", program)


def deleted(table: str, delete: str, program: str) -> int:
    """Delete a program's rows of a database table. Return the number of deleted rows.

    Args:
        table: SQL statement that creates the table unless the table exists.
        delete: SQL statement that deletes the rows of a program; its parameter is the program's name.
        program: name of the program.

    Raises:
        Trouble: the database can't be read or written.
    """
    place = registers_file()
    if not place.exists():
        return 0
    try:
        with opened(place) as base, base:
            base.execute(table)
            return base.execute(delete, (program,)).rowcount
    except (sqlite3.Error, OSError) as error:
        raise unreadable(place, error) from None


def unreadable(place: Path, error: Exception) -> Trouble:
    """Return the exception for a database that can't be used."""
    what = f"{place}, the file of KEPT registers, can't be used: {error}"
    return Trouble(
        what,
        "check the file's permissions and the disk; or move the file away, so that all KEPT registers "
        "begin with their initial values",
        "Y1636",
    )


@contextmanager
def opened(place: Path) -> Iterator[sqlite3.Connection]:
    """Open the database. A value is on the disk as soon as it is committed."""
    with closing(sqlite3.connect(place, timeout=_LONGEST_WAIT)) as base:
        base.execute("PRAGMA synchronous = FULL")
        yield base
