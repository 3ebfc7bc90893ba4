"""Unix sockets for one user: the folder that only its owner may enter, listening sockets, and the identity of
the user at the other end of a connection.
"""

from __future__ import annotations

import contextlib
import os
import re
import socket
import stat
import struct
import tempfile
from dataclasses import dataclass
from pathlib import Path

from yarclang.runtime.actions import Trouble

MASTERS = ".follow"
"""Suffix of the sockets by which other processes (masters) guide a live motion."""

_ALIVE_TIME = 0.5
"""Longest time to wait for a listening process to accept a connection [s]. A process that takes longer is
busy, but alive.
"""

_CREDENTIALS = struct.Struct("3i")
"""Process, user and group, as returned by SO_PEERCRED."""


class ControlError(Trouble):
    """A run's socket, the folder of the sockets, or a controller's lock can't be used. The arguments are what
    is wrong, and what to do about it.
    """


@dataclass(frozen=True, slots=True)
class Peer:
    """The process at the other end of a Unix socket, according to the kernel.

    Attributes:
        pid: process that connected, or that listens; 0 if it can't be seen from here (another container).
        uid: user of the process.
    """

    pid: int
    uid: int

    @property
    def is_trusted(self) -> bool:
        """Return True if the process belongs to our own user, or to root, who may do everything anyway."""
        return self.uid in (os.getuid(), 0)


def peer_of(wire: socket.socket) -> Peer:
    """Return the process at the other end of a connected Unix socket.

    Raises:
        OSError: the socket isn't connected.
    """
    told = wire.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    pid, uid, _ = _CREDENTIALS.unpack(told)
    return Peer(pid, uid)


def folder() -> Path:
    """Return the folder of our user's sockets. It is created if it is missing.

    Raises:
        ControlError: other users may enter the folder, it isn't ours, or it can't be created.
    """
    given = Path(os.environ.get("XDG_RUNTIME_DIR", ""))
    if given.is_absolute() and _is_ours(given):
        path = given / "yarc"
    else:
        path = Path(tempfile.gettempdir()) / f"yarc-{os.getuid()}"
    try:
        with contextlib.suppress(FileExistsError):
            path.mkdir(0o700)
    except OSError as error:
        raise ControlError(f"{path} can't be made: {reason_of(error)}") from None
    check_private(path)
    return path


def check_private(path: Path) -> None:
    """Check that a folder belongs to our own user, and that no other user may enter it.

    Raises:
        ControlError: the path is a link or no folder, the folder belongs to another user, or other users may
            enter it.
    """
    try:
        status = path.lstat()
    except OSError as error:
        raise ControlError(f"{path} can't be looked at: {reason_of(error)}") from None
    if not stat.S_ISDIR(status.st_mode):
        raise ControlError(f"{path} isn't a folder", "remove it")
    if status.st_uid != os.getuid():
        raise ControlError(f"{path} belongs to user {status.st_uid}", "have it removed")
    if status.st_mode & 0o077:
        raise ControlError(
            f"other users have access to {path}", f"`chmod 700 {path}`, if it has no files of other users"
        )


def private_listener(path: Path) -> socket.socket:
    """Return a socket that listens at a path, and to which only its owner may connect.

    The socket of a dead process is replaced; any other file is left untouched.

    Raises:
        ControlError: a process listens at the path already, the path is that of another file, or it can't be
            used.
    """
    if answers(path):
        raise ControlError(f"another process already listens on {path}", "choose another path")
    wire = socket.socket(socket.AF_UNIX)
    try:
        _remove_dead(path)
        os.fchmod(wire.fileno(), 0o600)  # the socket's file gets the same rights
        wire.bind(str(path))
        wire.listen()
    except OSError as error:
        wire.close()
        raise ControlError(f"{path} can't be listened on: {reason_of(error)}") from None
    return wire


def answers(path: Path) -> bool:
    """Return True if a process listens at the path of a socket."""
    with socket.socket(socket.AF_UNIX) as wire:
        wire.settimeout(_ALIVE_TIME)
        try:
            wire.connect(str(path))
        except (BlockingIOError, TimeoutError):  # the process is busy, and many callers wait
            return True
        except OSError:
            return False
    return True


def own_name(robot: str) -> str:
    """Return the base name of this process's sockets, without their suffix: the robot's name and the
    process number.
    """
    return f"{re.sub(r'[^a-z0-9_.]+', '_', robot.lower())}-{os.getpid()}"


def reason_of(error: OSError) -> str:
    """Return the operating system's text for an error, as the end of a sentence."""
    return (error.strerror or str(error)).lower()


def _is_ours(path: Path) -> bool:
    """Return True if a folder belongs to our user. After `su`, the environment variable may still name the
    folder of another user.
    """
    try:
        found = path.stat()
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()


def _remove_dead(path: Path) -> None:
    """Remove the socket that a dead process of ours has left behind."""
    with contextlib.suppress(FileNotFoundError):
        found = path.lstat()
        if stat.S_ISSOCK(found.st_mode) and found.st_uid == os.getuid():
            path.unlink()
