"""The accounts of a pendant: logins, sessions, PINs, users, and the audit trail, all stored in one SQLite
file.
"""

from __future__ import annotations

import asyncio
import secrets
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from yarclang.pendant.accounts import people
from yarclang.pendant.accounts.attempts import FREE_FROM_ADDRESS, Attempts
from yarclang.pendant.accounts.database import Database
from yarclang.pendant.accounts.passwords import check_name, check_password, check_pin, hashed, is_secret
from yarclang.pendant.accounts.people import Deed, Kept, User, digest
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import PIN_LASTS, Session, Sessions
from yarclang.runtime.actions import Trouble

T = TypeVar("T")

_AT_ONCE, _WAITING = 1, 8
"""Largest number of password checks that run at the same time, and of further checks that wait. Each check
takes a processor core and 64 MiB, which are then missing for the control of the robot.
"""

_WRITTEN_EACH = 60.0
"""Shortest time between two updates of a session's last use in the database [s]."""

_MOST_PINS = 5
"""Number of wrong PINs after which a session ends."""


class NotAllowed(Trouble):
    """Raised if the user's role doesn't allow an action, or the PIN must be entered first."""


class TooMany(Trouble):
    """Raised if a login has to wait: after wrong passwords, or because too many passwords are being checked.

    Attributes:
        wait: time until the next login attempt is allowed [s].
    """

    def __init__(self, subject: str, wait: float) -> None:
        super().__init__(subject, f"try again in {max(1.0, wait):.0f} s", "")
        self.wait = wait


class Accounts:
    """Users of a pendant, their sessions, and the audit trail.

    Args:
        path: file in which users, sessions and audit trail are stored.
        ended: called with each session that ends.
        now: returns the time of a monotonic clock [s].
        wall: returns the time of day [s].

    Attributes:
        sessions: the open sessions.
        first: token of the one-time link by which the first user is created; empty if there is a user
            already.
        trouble: reason why the audit trail can't be written; None if it can be.

    Raises:
        Trouble: the file at `path` can't be used.
    """

    def __init__(
        self,
        path: Path,
        ended: Callable[[Session], object] = lambda _: None,
        now: Callable[[], float] = time.monotonic,
        wall: Callable[[], float] = time.time,
    ) -> None:
        self._now, self._wall = now, wall
        self._told_end = ended
        self.database = Database(path)
        self.sessions = Sessions(self._ended)
        self.trouble: Trouble | None = None
        self._attempts = Attempts()
        self._looking = asyncio.Semaphore(_AT_ONCE)
        self._waiting = 0
        self._writing: set[asyncio.Future[None]] = set()
        self._noted: dict[str, float] = {}
        try:
            known = {one.name.casefold(): one.role for one in self.database.now(people.users)}
            self.first = "" if known else secrets.token_urlsafe(24)
            for kept in self.database.now(people.kept_sessions):
                role = known.get(kept.user.casefold())
                if role is None or not self.sessions.take_up(kept, role, now(), wall()):
                    self.database.now(people.end_session, kept.id)
        except BaseException:
            self.database.close()
            raise

    async def close(self) -> None:
        """Write pending changes and close the file. Sessions continue after a restart."""
        while self._writing:
            await asyncio.gather(*self._writing, return_exceptions=True)
        self.database.close()

    # logins and sessions

    async def begin(self, token: str, name: str, password: str, pin: str, address: str) -> None:
        """Create the first user, with the role service.

        Args:
            token: token of the one-time link that was shown at the pendant's start.
            name: name of the user.
            password: password as typed.
            pin: PIN as typed.
            address: address from which the request came.

        Raises:
            Trouble: the link has been used or belongs to an earlier start of the pendant, or the name,
                password or PIN isn't allowed.
        """
        if not self.first or not secrets.compare_digest(token.encode(), self.first.encode()):
            raise NotAllowed(
                "this link is no longer valid", "use the link that `yarc pendant` printed last", ""
            )
        await self._add(name, Role.SERVICE, password, pin, first=True)
        self.first = ""
        self.note(Deed(name, address, "first user"))

    async def login(
        self, name: str, password: str, address: str, agent: str, device: str
    ) -> tuple[Session, str, str]:
        """Log a user in.

        Args:
            name: name of the user.
            password: password as typed.
            address: address from which the request came.
            agent: user agent of the browser.
            device: token that the browser got at an earlier login on this device; empty if there is none.

        Returns:
            The session, the session's token, and the token of the device, which is new if the user hadn't
            logged in on the device before.

        Raises:
            TooMany: the user has to wait after wrong passwords from the same device or address, or because
                too many passwords are being checked.
            Trouble: the name or the password is wrong.
        """
        is_known = bool(device) and await self.database.call(people.is_known_device, digest(device), name)
        place = (name.casefold()[:80], f"device {digest(device).hex()}" if is_known else address)
        anybody = ("", address)
        wait = self._attempts.wait(place, self._now())
        if not is_known:  # at a known device, wrong passwords of other users at this address cause no wait
            wait = max(wait, self._attempts.wait(anybody, self._now(), FREE_FROM_ADDRESS))
        if wait > 0.0:
            raise TooMany("too many wrong passwords", wait)
        user = await self.database.call(people.user_called, name)
        # Count the attempt as wrong until the password is checked. Otherwise parallel attempts would evade
        # the wait.
        count = self._attempts.failed(place, self._now())
        try:
            right = await self._is_secret(None if user is None else user.password, password)
        except TooMany:
            self._attempts.forgive(place)
            raise
        if not right or user is None:
            if not is_known:
                self._attempts.failed(anybody, self._now())
            self.note(Deed(name[:80], address, "login", outcome=f"refused ({count} wrong passwords)"))
            raise Trouble("the name or the password is wrong", "try again", "")
        self._attempts.passed(place)
        device = device if is_known else secrets.token_urlsafe(32)
        session, token = self.sessions.open(user.name, user.role, address, agent, self._now())
        wall = self._wall()
        try:
            await self.database.call(people.know_device, digest(device), user.name, wall)
            await self.database.call(people.keep_session, self._restored(session))
            await self.did(Deed(user.name, address, "login"))
        except Trouble:
            self.sessions.end(session)
            raise
        return session, token, device

    def session_of(self, token: str) -> Session | None:
        """Return the session that a token belongs to; None if the session has ended or the token is
        unknown.
        """
        return self.sessions.of(token, self._now()) if token else None

    def is_over(self, session: Session) -> bool:
        """Return True if a session has ended. End it first if it has been open or inactive for too long."""
        return self.sessions.end_if_over(session, self._now())

    def used(self, session: Session) -> None:
        """Record that the user of a session has done something."""
        session.seen = now = self._now()
        if now - self._noted.get(session.id, -_WRITTEN_EACH) >= _WRITTEN_EACH:
            self._noted[session.id] = now
            self._later(people.keep_session, self._restored(session))

    async def logout(self, session: Session) -> None:
        """End a session."""
        self.sessions.end(session)
        self.note(Deed(session.user, session.address, "logout"))

    def _ended(self, session: Session) -> None:
        self._noted.pop(session.id, None)
        self._later(people.end_session, session.id)
        self._told_end(session)

    # service work

    async def confirm(self, session: Session, pin: str) -> float:
        """Check the PIN and allow service work for a limited time. Return that time [s].

        Raises:
            NotAllowed: the PIN is wrong; the fifth wrong one ends the session.
        """
        user = await self.database.call(people.user_called, session.user)
        session.wrong_pins += 1
        if user is None or not await self._is_secret(user.pin, pin):
            self.note(Deed(session.user, session.address, "PIN", outcome="refused"))
            if session.wrong_pins >= _MOST_PINS:
                self.sessions.end(session)
                raise NotAllowed("five wrong PINs have ended this session", "log in again", "")
            raise NotAllowed(
                "the PIN is wrong", "try again, or ask another service user to set a new PIN", ""
            )
        session.wrong_pins = 0
        session.pin_until = self._now() + PIN_LASTS
        self.note(Deed(session.user, session.address, "PIN"))
        return PIN_LASTS

    def check(self, session: Session, role: Role, *, pin: bool = False) -> None:
        """Check that a session has the rights of a role.

        Args:
            session: the session.
            role: the required role.
            pin: True if the PIN must also have been entered recently.

        Raises:
            NotAllowed: the role or the PIN is missing.
        """
        if not session.role.covers(role):
            what = (
                f"this is for {role.value}s; {session.user} is {_article(session.role)} {session.role.value}"
            )
            raise NotAllowed(what, f"this needs a user who is {_article(role)} {role.value}", "")
        if pin and self._now() > session.pin_until:
            raise NotAllowed("service work needs your PIN: enter it again", "enter the PIN", "pin")

    async def add(self, name: str, role: Role, password: str, pin: str | None) -> None:
        """Add a user.

        Raises:
            Trouble: the name is taken, or the name, password or PIN isn't allowed.
        """
        await self._add(name, role, password, pin, first=False)

    async def _add(self, name: str, role: Role, password: str, pin: str | None, *, first: bool) -> None:
        check_name(name)
        check_password(password, name)
        if pin is not None:
            check_pin(pin)
        elif role is Role.SERVICE:
            raise Trouble("a service user needs a PIN", "choose one", "")
        made = User(
            name, role, await self._hashed(password), None if pin is None else await self._hashed(pin)
        )
        await self.database.call(people.add_user, made, first=first)

    async def change(
        self,
        name: str,
        *,
        role: Role | None = None,
        password: str | None = None,
        pin: str | None = None,
        but: Session | None = None,
    ) -> None:
        """Change a user's role, password or PIN. A new role or password ends all sessions of the user, except
        the session `but`.

        Raises:
            Trouble: there is no such user, a new value isn't allowed, or no service user would be left.
        """
        user = await self.database.call(people.user_called, name)
        if password is not None:
            check_password(password, name)
        if pin is not None:
            check_pin(pin)
        if role is Role.SERVICE and pin is None and (user is None or user.pin is None):
            raise Trouble("a service user needs a PIN", "choose one", "")
        await self.database.call(
            people.change_user,
            name,
            role=role,
            password=None if password is None else await self._hashed(password),
            pin=None if pin is None else await self._hashed(pin),
        )
        if role is not None or password is not None:
            self.sessions.end_of_user(name, but=but)

    async def change_own(self, session: Session, old: str, *, password: str | None, pin: str | None) -> None:
        """Change the password or the PIN of the session's own user. A new password ends the user's other
        sessions.

        Raises:
            TooMany: the user has to wait after five wrong passwords, or because too many passwords are being
                checked.
            Trouble: the old password is wrong, or the new one isn't allowed.
        """
        place = (session.user.casefold(), f"session {session.id}")
        if (wait := self._attempts.wait(place, self._now())) > 0.0:
            raise TooMany("too many wrong passwords", wait)
        self._attempts.failed(place, self._now())
        user = await self.database.call(people.user_called, session.user)
        if user is None or not await self._is_secret(user.password, old):
            raise Trouble("the old password is wrong", "try again", "")
        self._attempts.passed(place)
        await self.change(session.user, password=password, pin=pin, but=session)

    async def remove(self, name: str) -> None:
        """Remove a user and end the user's sessions.

        Raises:
            Trouble: there is no such user, or no service user would be left.
        """
        await self.database.call(people.remove_user, name)
        self.sessions.end_of_user(name)

    async def all_users(self) -> tuple[User, ...]:
        """Return all users."""
        return await self.database.call(people.users)

    # the audit trail

    async def did(self, deed: Deed) -> None:
        """Write an entry of the audit trail. Call this before the action that the entry describes is carried
        out.

        Raises:
            Trouble: the entry can't be written; the action must not be carried out.
        """
        try:
            await self.database.call(people.write_deed, deed)
        except Trouble as trouble:
            self.trouble = trouble
            raise
        self.trouble = None

    def note(self, deed: Deed) -> None:
        """Queue an entry of the audit trail without waiting for the disk. This is for actions that mustn't
        wait, such as a stop of the robot.
        """
        self._later(people.write_deed, deed)

    async def deeds(self, before: int | None, count: int) -> tuple[tuple[int, str, Deed], ...]:
        """Return entries of the audit trail, newest first. See `people.deeds`."""
        while self._writing:
            await asyncio.gather(*self._writing, return_exceptions=True)
        return await self.database.call(people.deeds, before, count)

    async def deeds_since(self, action: str, since: str, most: int) -> tuple[tuple[str, Deed], ...]:
        """Return entries of the audit trail from a given time on, newest first. See `people.deeds_since`."""
        while self._writing:
            await asyncio.gather(*self._writing, return_exceptions=True)
        return await self.database.call(people.deeds_since, action, since, most)

    def _later(self, do: Callable[..., None], *arguments: object) -> None:
        async def written() -> None:
            try:
                await self.database.call(do, *arguments)
                self.trouble = None
            except Trouble as trouble:
                self.trouble = trouble

        task = asyncio.ensure_future(written())
        self._writing.add(task)
        task.add_done_callback(self._writing.discard)

    def _restored(self, session: Session) -> Kept:
        now, wall = self._now(), self._wall()
        return Kept(
            session.id,
            session.token,
            session.user,
            wall - (now - session.opened),
            wall - (now - session.seen),
            session.address,
            session.agent,
        )

    async def _is_secret(self, secret_hash: str | None, secret: str) -> bool:
        return await self._beside(is_secret, secret_hash, secret[:1000])

    async def _hashed(self, secret: str) -> str:
        return await self._beside(hashed, secret)

    async def _beside(self, function: Callable[..., T], *arguments: object) -> T:
        if self._waiting >= _WAITING:
            raise TooMany("too many passwords are being checked at the moment", 2.0)
        self._waiting += 1
        try:
            async with self._looking:
                return await asyncio.to_thread(function, *arguments)
        finally:
            self._waiting -= 1


def _article(role: Role) -> str:
    return "an" if role is Role.OPERATOR else "a"
