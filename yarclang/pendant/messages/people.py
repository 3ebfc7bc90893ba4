"""Messages about users, their sessions, and their actions."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message

Secret = Annotated[str, Field(max_length=1000)]
Name = Annotated[str, Field(max_length=80)]
RoleName = Literal["viewer", "operator", "programmer", "service"]


class Login(Message):
    """A user name and its password."""

    user: Name
    password: Secret


class First(Message):
    """Request to create the first user, with the role service: the token of the one-time link, and the chosen
    name, password and PIN.
    """

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
    """Changes to a user. A new role or password ends the user's sessions."""

    role: RoleName | None = None
    password: Secret | None = None
    pin: Secret | None = None


class Me(Message):
    """The user who is logged in. `session` is the id of this session. `pin_s` is the time for which service
    work is allowed before the PIN must be entered again [s]. `client` is the session's name at the
    coordinator, empty if the session hasn't given an order yet.
    """

    user: str
    role: RoleName
    session: str
    pin_s: float
    client: str


class NotLoggedIn(Message):
    """Reply if nobody is logged in. `first` is true if there is no user yet: the first one is created by the
    link that `yarc pendant` has printed.
    """

    ok: Literal[False] = False
    error: str
    first: bool


class UserShown(Message):
    """A user; `sessions` is the number of the user's sessions."""

    user: str
    role: RoleName
    has_pin: bool
    sessions: int


class Users(Message):
    """All users."""

    users: tuple[UserShown, ...]


class SessionShown(Message):
    """A session: its user, address and browser, and the time since its login and since its last action
    [s].
    """

    session: str
    user: str
    role: RoleName
    address: str
    agent: str
    open_s: float
    quiet_s: float
    here: bool
    """True for the session that requests the list."""
    pages: int
    """Number of the session's connected pages."""


class SessionList(Message):
    """All sessions."""

    sessions: tuple[SessionShown, ...]


class AuditEntry(Message):
    """An entry of the audit trail: the user, the time (UTC), the address, and the action. `outcome` is
    `done`, or the reason why the action failed.
    """

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
