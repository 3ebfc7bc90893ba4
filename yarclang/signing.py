"""Sign the user's entries in a cache folder, so that nobody else can add an entry that counts as the user's.

A signature is an HMAC-SHA256 with a secret of 32 bytes in a file that only the user can read.
"""

from __future__ import annotations

import hmac
import os
import secrets
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

SIZE = 32
"""Length of a secret, and of a signature [bytes]."""


def secret_file() -> Path:
    """Return the file with the secret of the user's entries. It isn't in the cache folder, which the user may
    share with others.
    """
    given = os.environ.get("XDG_STATE_HOME", "")
    return (
        (Path(given) if Path(given).is_absolute() else Path.home() / ".local" / "state")
        / "yarclang"
        / "cache.key"
    )


def own_secret() -> bytes | None:
    """Return the user's secret; None if it can't be created, or if others can read it."""
    try:
        return secret_in(secret_file())
    except OSError:
        return None


def signature(secret: bytes, contents: Iterable[bytes | memoryview]) -> bytes:
    """Return one signature of several contents and of their lengths."""
    code = hmac.new(secret, digestmod="sha256")
    for content in contents:
        code.update(memoryview(content).nbytes.to_bytes(8, "little"))
        code.update(content)
    return code.digest()


def is_signed(code: bytes | memoryview, secret: bytes, contents: Iterable[bytes | memoryview]) -> bool:
    """Return True if a signature is that of the contents."""
    return hmac.compare_digest(bytes(code), signature(secret, contents))


def secret_in(path: Path) -> bytes:
    """Return the secret in a file that only its owner can read. The first process that needs it creates it.

    Raises:
        OSError: the secret can't be read or created, or others could have read it.
    """
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    if not path.exists():
        own = path.with_name(f"{path.name}.{os.getpid()}.{secrets.token_hex(4)}")
        handle = os.open(own, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            os.write(handle, secrets.token_bytes(SIZE))
        finally:
            os.close(handle)
        with suppress(FileExistsError):
            os.link(own, path)  # if several processes do this at once, the first one wins
        own.unlink()
    seen = path.stat()
    secret = path.read_bytes()
    if len(secret) != SIZE or (
        hasattr(os, "getuid") and (seen.st_mode & 0o077 or seen.st_uid != os.getuid())
    ):
        raise OSError(f"{path} isn't a secret of 32 bytes that only you can read: remove it")
    return secret
