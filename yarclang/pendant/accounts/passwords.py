"""Passwords and PINs: rules for new ones, and their argon2id hashes."""

from __future__ import annotations

import re
from functools import cache

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

from yarclang.runtime.actions import Trouble

SHORTEST_PASSWORD, LONGEST_PASSWORD = 8, 256
_PIN = re.compile(r"[0-9]{4,12}")
_NAME = re.compile(r"[^\W_][\w .@-]{0,39}")


def check_name(name: str) -> None:
    """Check the name of a new user.

    Raises:
        Trouble: the name isn't allowed.
    """
    if not _NAME.fullmatch(name) or name != name.strip():
        what = (
            "a user's name has 1 to 40 letters, digits, spaces, or . _ @ -, and begins with a letter or digit"
        )
        raise Trouble(what, "choose another name", "")


def check_password(password: str, name: str) -> None:
    """Check a new password.

    Raises:
        Trouble: the password is too easy to guess, or too long.
    """
    if not SHORTEST_PASSWORD <= len(password) <= LONGEST_PASSWORD:
        what = (
            f"a password has {SHORTEST_PASSWORD} to {LONGEST_PASSWORD} characters; this one has "
            f"{len(password)}"
        )
        raise Trouble(what, "choose another one", "")
    if password.casefold() == name.casefold() or len(set(password)) < 4:
        raise Trouble(
            "this password is too easy to guess",
            "use four different characters or more, and not the name",
            "",
        )


def check_pin(pin: str) -> None:
    """Check a new PIN.

    Raises:
        Trouble: the PIN isn't 4 to 12 digits, or all of its digits are equal.
    """
    if not _PIN.fullmatch(pin) or len(set(pin)) == 1:
        raise Trouble("a PIN must have 4 to 12 digits, not all equal", "choose another one", "")


def hashed(secret: str) -> str:
    """Return the hash of a password or a PIN. Takes some 50 ms of a core and 64 MiB: call it in a thread."""
    return _hasher().hash(secret)


def is_secret(secret_hash: str | None, secret: str) -> bool:
    """Return True if a password or PIN matches a hash.

    For an unknown user the hash is None. The check then takes as long as for a wrong password, so that the
    response time doesn't reveal which users exist.
    """
    try:
        return (
            _hasher().verify(secret_hash if secret_hash is not None else _nobody(), secret)
            and secret_hash is not None
        )
    except (VerificationError, InvalidHashError):
        return False


@cache
def _hasher() -> PasswordHasher:
    return PasswordHasher()


@cache
def _nobody() -> str:
    return _hasher().hash("nobody")
