"""Database tables of users, sessions and the audit trail. Each function takes a database connection; call
it through `Database.call`, as one transaction.
"""

from __future__ import annotations

import hashlib
import sqlite3
from dataclasses import dataclass
from datetime import UTC, datetime

from yarclang.pendant.accounts.roles import Role
from yarclang.runtime.actions import Trouble


@dataclass(frozen=True, slots=True)
class User:
    """A user, as stored in the database.

    Attributes:
        name: name of the user.
        role: role of the user.
        password: hash of the password.
        pin: hash of the PIN; None if none was chosen.
    """

    name: str
    role: Role
    password: str
    pin: str | None


@dataclass(frozen=True, slots=True)
class Kept:
    """A session as stored in the database, from which it continues after a restart.

    Attributes:
        id: id of the session.
        token: digest of the session's token.
        user: name of the user.
        created: time of the login by the wall clock [s].
        seen: time of the user's last action by the wall clock [s].
        address: address from which the login came.
        agent: the browser's user agent.
    """

    id: str
    token: bytes
    user: str
    created: float
    seen: float
    address: str
    agent: str


@dataclass(frozen=True, slots=True)
class Deed:
    """An entry of the audit trail: an action that somebody carried out or attempted."""

    user: str
    address: str
    action: str
    detail: str = ""
    outcome: str = "done"


def digest(token: str) -> bytes:
    """Return the digest of a token. The database holds only digests, which can't be used to log in."""
    return hashlib.sha256(token.encode()).digest()


def user_called(connection: sqlite3.Connection, name: str) -> User | None:
    """Return the user of a name, regardless of case."""
    row = connection.execute("SELECT name, role, password, pin FROM users WHERE name = ?", (name,)).fetchone()
    return None if row is None else User(row[0], Role(row[1]), row[2], row[3])


def users(connection: sqlite3.Connection) -> tuple[User, ...]:
    """Return all users, sorted by name."""
    rows = connection.execute("SELECT name, role, password, pin FROM users ORDER BY name").fetchall()
    return tuple(User(name, Role(role), password, pin) for name, role, password, pin in rows)


def add_user(connection: sqlite3.Connection, user: User, *, first: bool = False) -> None:
    """Add a user.

    Args:
        connection: connection to the database.
        user: user to add.
        first: True to add the first user, which requires that there is no user yet.

    Raises:
        Trouble: the name is taken, or `first` is true and there is a user.
    """
    if first and connection.execute("SELECT 1 FROM users").fetchone():
        raise Trouble("the first user is there already", "log in", "")
    if user_called(connection, user.name) is not None:
        raise Trouble(f"there is a user {user.name!r} already", "choose another name", "")
    connection.execute(
        "INSERT INTO users VALUES (?, ?, ?, ?, ?)",
        (user.name, user.role.value, user.password, user.pin, _now()),
    )


def change_user(
    connection: sqlite3.Connection,
    name: str,
    *,
    role: Role | None = None,
    password: str | None = None,
    pin: str | None = None,
) -> None:
    """Change a user. An argument that is None leaves its field unchanged.

    Raises:
        Trouble: there is no such user, or no service user would be left.
    """
    found = _existing(connection, name)
    if role is not None:
        if found.role is Role.SERVICE and role is not Role.SERVICE:
            _check_another_service(connection, found.name)
        connection.execute("UPDATE users SET role = ? WHERE name = ?", (role.value, name))
    if password is not None:
        connection.execute("UPDATE users SET password = ? WHERE name = ?", (password, name))
        connection.execute("DELETE FROM devices WHERE user = ?", (name,))
    if pin is not None:
        connection.execute("UPDATE users SET pin = ? WHERE name = ?", (pin, name))


def remove_user(connection: sqlite3.Connection, name: str) -> None:
    """Remove a user. The user's entries stay in the audit trail.

    Raises:
        Trouble: there is no such user, or no service user would be left.
    """
    found = _existing(connection, name)
    if found.role is Role.SERVICE:
        _check_another_service(connection, found.name)
    connection.execute("DELETE FROM users WHERE name = ?", (name,))


def keep_session(connection: sqlite3.Connection, session: Kept) -> None:
    """Write a session to the database, so that it continues after a restart. Do nothing if the session's user
    no longer exists.
    """
    connection.execute(
        "INSERT OR REPLACE INTO sessions SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7 WHERE EXISTS (SELECT 1 FROM "
        "users WHERE name = ?3)",
        (
            session.id,
            session.token,
            session.user,
            session.created,
            session.seen,
            session.address,
            session.agent,
        ),
    )


def kept_sessions(connection: sqlite3.Connection) -> tuple[Kept, ...]:
    """Return all sessions in the database, oldest first."""
    rows = connection.execute(
        "SELECT id, token, user, created, seen, address, agent FROM sessions ORDER BY created"
    ).fetchall()
    return tuple(Kept(*row) for row in rows)


def end_session(connection: sqlite3.Connection, id_: str) -> None:
    """Delete a session."""
    connection.execute("DELETE FROM sessions WHERE id = ?", (id_,))


def know_device(connection: sqlite3.Connection, device: bytes, user: str, now: float) -> None:
    """Record that a user has logged in at a device."""
    connection.execute("INSERT OR REPLACE INTO devices VALUES (?, ?, ?)", (device, user, now))


def is_known_device(connection: sqlite3.Connection, device: bytes, user: str) -> bool:
    """Return True if a user has logged in at a device before."""
    found = connection.execute(
        "SELECT 1 FROM devices WHERE device = ? AND user = ?", (device, user)
    ).fetchone()
    return found is not None


def write_deed(connection: sqlite3.Connection, deed: Deed) -> None:
    """Write an entry of the audit trail."""
    connection.execute(
        "INSERT INTO audit (time, user, address, action, detail, outcome) VALUES (?, ?, ?, ?, ?, ?)",
        (_now(), deed.user, deed.address, deed.action, deed.detail, deed.outcome),
    )


def last_deed(connection: sqlite3.Connection) -> int:
    """Return the number of the last entry of the audit trail; 0 if there is none."""
    found: int | None = connection.execute("SELECT max(number) FROM audit").fetchone()[0]
    return found or 0


def deeds(
    connection: sqlite3.Connection, before: int | None, count: int
) -> tuple[tuple[int, str, Deed], ...]:
    """Return entries of the audit trail as (number, time, deed), newest first.

    Args:
        connection: connection to the database.
        before: return only entries with numbers below this one; None for all entries.
        count: largest number of returned entries.
    """
    rows = connection.execute(
        "SELECT number, time, user, address, action, detail, outcome FROM audit WHERE number < ? ORDER "
        "BY number DESC LIMIT ?",
        (before if before is not None else 1 << 62, count),
    ).fetchall()
    return tuple((row[0], row[1], Deed(*row[2:])) for row in rows)


def deeds_since(
    connection: sqlite3.Connection, action: str, since: str, most: int
) -> tuple[tuple[str, Deed], ...]:
    """Return entries of the audit trail as (time in UTC, deed), newest first.

    Args:
        connection: connection to the database.
        action: return only entries whose action begins with this text.
        since: return only entries from this time on, in the time format of the audit trail.
        most: number of newest entries that are searched, whatever their action.
    """
    rows = connection.execute(
        "SELECT time, user, address, action, detail, outcome FROM audit ORDER BY number DESC LIMIT ?", (most,)
    )
    entries = []
    for row in rows:
        if row[0] < since:
            break
        if row[3].startswith(action):
            entries.append((row[0], Deed(*row[1:])))
    return tuple(entries)


def _existing(connection: sqlite3.Connection, name: str) -> User:
    found = user_called(connection, name)
    if found is None:
        raise Trouble(f"there is no user {name!r}", "look at the list of users", "")
    return found


def _check_another_service(connection: sqlite3.Connection, name: str) -> None:
    row = connection.execute(
        "SELECT count(*) FROM users WHERE role = ? AND name <> ?", (Role.SERVICE.value, name)
    ).fetchone()
    if not row[0]:
        raise Trouble(
            f"{name} is the only user of the role service", "give that role to another user first", ""
        )


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
