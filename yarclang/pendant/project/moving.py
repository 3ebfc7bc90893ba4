"""Moves of files and folders from one disk to another. Symbolic links are moved as links, so that nothing
outside of the folder is read or removed.
"""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress

from yarclang.runtime.actions import Trouble

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_PIECE = 1 << 20
_MOST_THINGS = 20_000
_DEEPEST = 100


def measured(folder: int, name: str) -> int:
    """Return the size of a file, or of all files in a folder [bytes].

    Args:
        folder: an open folder.
        name: name of the file or folder in `folder`.

    Raises:
        Trouble: the folder contains too many files, or a pipe or a device.
        OSError: the file or folder can't be read.
    """
    left = [_MOST_THINGS]
    return _size(folder, name, left, 0)


def _size(folder: int, name: str, entries_left: list[int], depth: int) -> int:
    status = os.stat(name, dir_fd=folder, follow_symlinks=False)
    entries_left[0] -= 1
    if entries_left[0] < 0 or depth > _DEEPEST:
        raise Trouble(
            f"this folder has more than {_MOST_THINGS:,} files, or more than {_DEEPEST} nested folders",
            "delete parts of it first", "",
        )  # fmt: skip
    if stat.S_ISDIR(status.st_mode):
        inner = os.open(name, _FOLDER, dir_fd=folder)
        try:
            return sum(_size(inner, one, entries_left, depth + 1) for one in _names(inner))
        finally:
            os.close(inner)
    if not stat.S_ISREG(status.st_mode) and not stat.S_ISLNK(status.st_mode):
        raise Trouble(f"{name[:80]!r} is not a file", "remove it on the computer itself", "")
    return status.st_size


def _names(folder: int) -> list[str]:
    with os.scandir(folder) as listed:
        return [one.name for one in listed]


def carried(folder: int, name: str, to: int, new: str) -> None:
    """Copy a file, a link or a folder.

    Args:
        folder: an open folder.
        name: name of the original in `folder`.
        to: another open folder.
        new: name of the copy in `to`, which must be unused.

    Raises:
        OSError: the original can't be copied; a partial copy remains.
    """
    status = os.stat(name, dir_fd=folder, follow_symlinks=False)
    if stat.S_ISLNK(status.st_mode):
        os.symlink(os.readlink(name, dir_fd=folder), new, dir_fd=to)
        return
    if stat.S_ISREG(status.st_mode):
        _carry_file(folder, name, to, new)
        return
    if not stat.S_ISDIR(status.st_mode):
        raise OSError(errno.EINVAL, "it is not a file")
    inner = os.open(name, _FOLDER, dir_fd=folder)
    try:
        os.mkdir(new, 0o700, dir_fd=to)
        copy = os.open(new, _FOLDER, dir_fd=to)
        try:
            for one in _names(inner):
                carried(inner, one, copy, one)
            os.fsync(copy)
            _keep(status, copy)
        finally:
            os.close(copy)
    finally:
        os.close(inner)


def _carry_file(folder: int, name: str, to: int, new: str) -> None:
    source = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, dir_fd=folder)
    try:
        target = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o600, dir_fd=to)
        try:
            while data := os.read(source, _PIECE):
                view = memoryview(data)
                while view:
                    view = view[os.write(target, view) :]
            os.fsync(target)
            _keep(os.fstat(source), target)
        finally:
            os.close(target)
    finally:
        os.close(source)


def _keep(status: os.stat_result, target: int) -> None:
    """Give a copy the owner, mode and times of its original."""
    with suppress(OSError):  # only root may change the owner
        os.fchown(target, status.st_uid, status.st_gid)
    os.fchmod(target, stat.S_IMODE(status.st_mode))
    os.utime(target, ns=(status.st_atime_ns, status.st_mtime_ns))


def removed(folder: int, name: str) -> None:
    """Remove a file, a link or a folder with its content.

    Raises:
        OSError: the file, or a part of the folder, can't be removed.
    """
    told = os.stat(name, dir_fd=folder, follow_symlinks=False)
    if not stat.S_ISDIR(told.st_mode):
        os.unlink(name, dir_fd=folder)
        return
    inner = os.open(name, _FOLDER, dir_fd=folder)
    try:
        for one in _names(inner):
            removed(inner, one)
    finally:
        os.close(inner)
    os.rmdir(name, dir_fd=folder)
