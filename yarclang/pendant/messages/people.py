"""Messages about people: who they are, their sessions, what they did."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message

Secret = Annotated[str, Field(max_length=1000)]
Name = Annotated[str, Field(max_length=80)]
RoleName = Literal["viewer", "operator", "programmer", "service"]


class Login(Message):
    """A name and its password."""

    user: Name
    password: Secret


class First(Message):
    """The first user, of the role service: the token of the one-time link, and what was chosen."""

    token: Secret
    user: Name
    password: Secret
    pin: Secret


class Pin(Message):
    """The PIN of the user who is logged in, which allows service work for five minutes."""

    pin: Secret


class ChangeOwn(Message):
    """A new password or PIN for the user who is logged in."""

    old_password: Secret
    password: Secret | None = None
    pin: Secret | None = None


class NewUser(Message):
    """A user to add."""

    user: Name
    role: RoleName
    password: Secret
    pin: Secret | None = None


class ChangeUser(Message):
    """Changes of a user; a new role or password ends the user's sessions."""

    role: RoleName | None = None
    password: Secret | None = None
    pin: Secret | None = None


class Me(Message):
    """The user who is logged in: `session` is the id of this session, `pin_s` how long service work is
    possible without a PIN [s], `client` the name by which the coordinator knows this session; empty: it
    hasn't ordered anything yet.
    """

    user: str
    role: RoleName
    session: str
    pin_s: float
    client: str


class NotLoggedIn(Message):
    """Nobody is logged in; `first` is true if there is no user yet: the link that `yarc pendant` printed
    makes the first one.
    """

    ok: Literal[False] = False
    error: str
    first: bool


class UserShown(Message):
    """A user; `sessions` is how many sessions of theirs there are."""

    user: str
    role: RoleName
    has_pin: bool
    sessions: int


class Users(Message):
    """All users."""

    users: tuple[UserShown, ...]


class SessionShown(Message):
    """Somebody who is logged in: from which address, with which browser, for how long, and when they last did
    something [s].
    """

    session: str
    user: str
    role: RoleName
    address: str
    agent: str
    open_s: float
    quiet_s: float
    here: bool
    """True for the session that asks."""
    pages: int
    """Pages of it that are connected now."""


class SessionList(Message):
    """All sessions."""

    sessions: tuple[SessionShown, ...]


class AuditEntry(Message):
    """An action: the user, the time (UTC), the address; `outcome` is `done`, or the reason why it wasn't."""

    number: int
    time: str
    user: str
    address: str
    action: str
    detail: str
    outcome: str


class Audit(Message):
    """Entries of the audit trail, the newest first."""

    entries: tuple[AuditEntry, ...]
