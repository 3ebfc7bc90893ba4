"""Keep a secret in a file that only its owner can read and that is removed after use."""

from __future__ import annotations

import contextlib
import os
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

from yarclang.runtime.actions import Trouble


@contextlib.contextmanager
def secret_file(path: Path, text: str) -> Iterator[None]:
    """Keep a secret in a file during the context.

    A new file is created; it replaces an existing file with the same name. Other users can't read the secret
    at any time.

    Args:
        path: path of the file.
        text: the secret.

    Raises:
        Trouble: the file can't be written, or the path belongs to something other than a file.
    """
    try:
        made = _write(path, text)
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise Trouble(f"the token can't be written to {path}: {reason}", "name another file") from None
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            there = path.lstat()
            # compare the time too: a new file may get the inode of a removed one
            if os.path.samestat(there, made) and there.st_mtime_ns == made.st_mtime_ns:
                path.unlink()


def _write(path: Path, text: str) -> os.stat_result:
    with contextlib.suppress(FileNotFoundError):
        if not stat.S_ISREG(path.lstat().st_mode):
            raise ValueError("a folder, a link or a device has that name")
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")  # for its owner alone
    try:
        with os.fdopen(handle, "w", encoding="ascii") as file:
            file.write(text)
        Path(temporary).replace(path)
    except OSError:
        Path(temporary).unlink(missing_ok=True)
        raise
    return path.lstat()
