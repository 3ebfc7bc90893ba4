"""Read files in bounded time and memory, and write them completely or not at all."""

from __future__ import annotations

import errno
import os
import stat
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from yarclang.consulted import content_of

LARGEST_MESH = 1_000_000_000
"""Largest size of a mesh [bytes]."""

LARGEST_LOG = 16_000_000_000
"""Largest size of a run's log [bytes]."""

CACHE = "YARCLANG_CACHE"
"""Environment variable that names another cache folder. If it is empty, nothing is cached."""

_PIECE = 1 << 20

_LONGEST_PREFIX = 40
"""Largest number of characters of a file's name that are used in the name of its temporary file. Names of
files have a limited length.
"""


_OPEN_ALREADY = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")
"""Names of files that were already open when this process was started. They may be read even if they are
pipes: such a pipe has a writer, so that its reader doesn't wait forever.
"""

_KINDS = {
    stat.S_IFDIR: "it is a folder, not a file",
    stat.S_IFIFO: "it is a pipe, not a file",
    stat.S_IFCHR: "it is a device, not a file",
    stat.S_IFBLK: "it is a device, not a file",
    stat.S_IFSOCK: "it is a socket, not a file",
}


def read_whole(path: Path, most: int) -> bytes:
    """Read a file that has at most `most` bytes.

    Raises:
        OSError: the file can't be read, is larger, or is a pipe or device, which may have no end. Files that
            were already open when this process was started, as with a shell's `<(...)`, are allowed.
            `strerror` has the reason.
    """
    return content_of(path, lambda: _read(path, most))


def _read(path: Path, most: int) -> bytes:
    try:
        found = path.stat()
    except ValueError as error:  # a NUL in the name
        raise OSError(errno.EINVAL, str(error), str(path)) from None
    kind = stat.S_IFMT(found.st_mode)
    if kind in _KINDS and (kind == stat.S_IFDIR or not str(path).startswith(_OPEN_ALREADY)):
        raise OSError(errno.EINVAL, _KINDS[kind], str(path))
    if found.st_size > most:
        raise OSError(errno.EFBIG, f"it has {found.st_size:,} bytes; at most {most:,} are read", str(path))
    with path.open("rb") as file:
        return read_stream(file, most)


def read_stream(file: BinaryIO, most: int) -> bytes:
    """Read the rest of an open file, of at most `most` bytes.

    Raises:
        OSError: the file can't be read, or is larger.
    """
    pieces: list[bytes] = []
    size = 0
    while piece := file.read(_PIECE):  # piece by piece: memory grows only with the data
        pieces.append(piece)
        size += len(piece)
        if size > most:
            raise OSError(errno.EFBIG, f"it has more than {most:,} bytes, and no more are read")
    return b"".join(pieces)


def replace_file(path: Path, data: bytes) -> None:
    """Write a file completely or not at all, even if the work is interrupted. A missing folder is created.

    The data is written to a temporary file beside the target, which is then renamed to the target's name. The
    mode is kept, and the owner if that is allowed. A symbolic link is kept, and its target is written. A
    device or a pipe is written directly.

    Raises:
        OSError: the file can't be written, or is write-protected. The file is then unchanged.
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
            with suppress(OSError):  # only root may change the owner
                os.chown(temporary, before.st_uid, before.st_gid)
        temporary.chmod(_plain_mode() if before is None else stat.S_IMODE(before.st_mode))
        temporary.replace(target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _plain_mode() -> int:
    """Return the mode of a new file."""
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask


def cache_folder() -> Path | None:
    """Return the user's cache folder of yarclang; None if nothing is to be cached."""
    given = os.environ.get(CACHE)
    if given is not None:
        return Path(given) if given else None
    home = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not home.is_absolute():
        try:
            home = Path.home() / ".cache"
        except RuntimeError:  # the user has no home
            return None
    return home / "yarclang"


def reason_of(error: OSError) -> str:
    """Return the system's text of an error, in the form of the end of a sentence."""
    return (error.strerror or str(error)).lower()
