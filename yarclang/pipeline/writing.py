"""Files that are written whole or not at all."""

from __future__ import annotations

import errno
import os
import stat
import tempfile
from contextlib import suppress
from pathlib import Path

_LONGEST_PREFIX = 40
"""Characters of a file's name in that of the temporary one: both together must not be too long."""


def replace_file(path: Path, data: bytes) -> None:
    """Write a file whole or not at all, whenever the work is interrupted. Its folder is made if it is missing.

    The data goes to a temporary file beside the target, which then takes the target's name. The mode stays (and the owner, if that is allowed). A
    symbolic link stays, and the file that it leads to is written. A device or a pipe is written directly.

    Raises:
        OSError: the file can't be written, or is write-protected; it is as it was before.
    """
    if path.exists() and not path.is_file():
        path.write_bytes(data)
        return
    target = Path(os.path.realpath(path))
    target.parent.mkdir(parents=True, exist_ok=True)
    before = target.stat() if target.exists() else None
    if before is not None and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, "the file is write-protected", str(path))
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name[:_LONGEST_PREFIX]}.")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if before is not None:
            with suppress(OSError):  # only root may give a file to somebody
                os.chown(temporary, before.st_uid, before.st_gid)
        temporary.chmod(_plain_mode() if before is None else stat.S_IMODE(before.st_mode))
        temporary.replace(target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _plain_mode() -> int:
    """The mode of a new file."""
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask
