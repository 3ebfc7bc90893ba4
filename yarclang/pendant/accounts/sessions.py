"""Open sessions of users. Their times are those of a monotonic clock.

After a restart, the age of earlier sessions is computed from the wall clock. If the wall clock was set back
in between, these sessions end.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable
from dataclasses import dataclass

from yarclang.pendant.accounts.people import Kept, digest
from yarclang.pendant.accounts.roles import Role

IDLE = 3600.0
"""Time without an action of the user after which a session ends [s]."""

LONGEST = 12 * 3600.0
"""Longest duration of a session [s]; then the user has to log in again."""

PIN_LASTS = 300.0
"""Time for which service work is allowed after the PIN was entered [s]."""

MOST = 200
"""Largest number of open sessions. If there are more, the session that has been inactive for the longest time
ends.
"""

_CLOCKS_DIFFER = 60.0
"""Tolerance when the stored times of a session are compared with the wall clock [s]. If a stored time is
farther in the future than this, the wall clock counts as set back.
"""


@dataclass(slots=True, eq=False)
class Session:
    """A login of a user in one browser. All times are of a monotonic clock.

    Attributes:
        id: public identifier; the token is secret.
        user: name of the user.
        role: role of the user.
        address: address from which the login came.
        agent: the browser's user agent.
        token: digest of the secret token.
        opened: time of the login [s].
        seen: time of the user's last action [s].
        pin_until: time until which service work is allowed [s].
        wrong_pins: number of wrong PINs since the last correct one.
    """

    id: str
    user: str
    role: Role
    address: str
    agent: str
    token: bytes
    opened: float
    seen: float
    pin_until: float = -1.0
    wrong_pins: int = 0


class Sessions:
    """All open sessions.

    Args:
        ended: called with each session that ends.
    """

    def __init__(self, ended: Callable[[Session], object]) -> None:
        self._by_token: dict[bytes, Session] = {}
        self._ended = ended

    def open(self, user: str, role: Role, address: str, agent: str, now: float) -> tuple[Session, str]:
        """Begin a session. Return the session and its secret token. Only a digest of the token is stored."""
        token = secrets.token_urlsafe(32)
        session = Session(
            secrets.token_hex(8), user, role, address, agent[:200], digest(token), opened=now, seen=now
        )
        self._by_token[session.token] = session
        while len(self._by_token) > MOST:
            self.end(min(self._by_token.values(), key=lambda one: one.seen))
        return session, token

    def of(self, token: str, now: float) -> Session | None:
        """Return the session of a token; None if it has ended."""
        found = self._by_token.get(digest(token))
        return None if found is None or self.end_if_over(found, now) else found

    def called(self, id_: str) -> Session | None:
        """Return a session by its id."""
        return next((one for one in self._by_token.values() if one.id == id_), None)

    def all(self) -> tuple[Session, ...]:
        """Return all sessions, oldest first."""
        return tuple(self._by_token.values())

    def end_if_over(self, session: Session, now: float) -> bool:
        """End a session if it has been open or inactive for too long. Return True if the session has
        ended, now or before.
        """
        if session.token not in self._by_token:
            return True
        if now - session.seen > IDLE or now - session.opened > LONGEST:
            self.end(session)
            return True
        return False

    def end(self, session: Session) -> None:
        """End a session."""
        if self._by_token.pop(session.token, None) is not None:
            self._ended(session)

    def end_of_user(self, name: str, *, but: Session | None = None) -> None:
        """End all sessions of a user except `but`."""
        for one in self.all():
            if one.user.casefold() == name.casefold() and one is not but:
                self.end(one)

    def take_up(self, stored: Kept, role: Role, now: float, wall: float) -> bool:
        """Continue a session from before a restart. Return False if the session has been open or inactive for
        too long, or if the wall clock has been set back since then.
        """
        age, quiet = wall - stored.created, wall - stored.seen
        if min(age, quiet) < -_CLOCKS_DIFFER or age > LONGEST or quiet > IDLE:
            return False
        self._by_token[stored.token] = Session(
            stored.id,
            stored.user,
            role,
            stored.address,
            stored.agent,
            stored.token,
            now - max(age, 0.0),
            now - max(quiet, 0.0),
        )
        return True
