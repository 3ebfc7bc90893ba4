"""Access to the files of a folder by their paths. A path never leads out of the folder, even if another
process changes the folder at the same time.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from yarclang.files import reason_of
from yarclang.pendant.project.names import parts_of, quoted
from yarclang.runtime.actions import Trouble

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC

_REASONS = {
    errno.ENOSPC: ("there is no room left on the disk", "delete what isn't needed, or make room on the disk"),
    errno.EDQUOT: ("the disk's quota is used up", "delete what isn't needed"),
    errno.EROFS: ("the project is on a read-only disk", "mount it for writing"),
    errno.EACCES: ("the pendant has no permission", "give the pendant's user the permission"),
    errno.EPERM: ("the system doesn't permit it", "give the pendant's user the permission"),
    errno.ENOENT: ("it isn't there", "look at the list of files"),
    errno.ENOTDIR: ("a part of its path isn't a folder", "look at the list of files"),
    errno.EISDIR: ("it is a folder", "name a file"),
    errno.ELOOP: ("its path was changed meanwhile, or its links form a loop", "try again"),
    errno.EEXIST: ("it is there already", "choose another name"),
    errno.ENOTEMPTY: ("it is there already", "choose another name"),
    errno.ENAMETOOLONG: ("its name is too long", "choose a shorter one"),
    errno.EFBIG: ("it is larger than the file system allows", "divide it"),
    errno.EIO: ("reading or writing failed", "look at the disk"),
}


def said(error: OSError, name: str) -> Trouble:
    """Return the exception `Trouble` that describes an operating system's error about a file in words."""
    why, remedy = _REASONS.get(error.errno or 0, (reason_of(error), "look at the file"))
    return Trouble(f"{quoted(name)}: {why}", remedy, "missing" if error.errno == errno.ENOENT else "")


@contextmanager
def in_words(name: str) -> Iterator[None]:
    """Until the context ends, convert errors of the operating system about a file to `Trouble`."""
    try:
        yield
    except OSError as error:
        raise said(error, name) from None
    except (ValueError, RuntimeError):
        raise Trouble(f"{quoted(name)} isn't the name of a file", "name a file of the project", "") from None


@dataclass(frozen=True, slots=True)
class At:
    """Place of a file: the open folder that contains it, and its name in that folder.

    Attributes:
        folder: descriptor of the folder.
        name: name of the file in the folder. The file need not exist.
        parts: names in the file's path from the top of the project, with links resolved.
    """

    folder: int
    name: str
    parts: tuple[str, ...]

    def look(self) -> os.stat_result | None:
        """Return the status of the file, without following a link; None if there is none."""
        try:
            return os.stat(self.name, dir_fd=self.folder, follow_symlinks=False)
        except FileNotFoundError:
            return None

    def open(self, flags: int) -> int:
        """Open an existing file. Pipes and devices are refused, because they have no end.

        Raises:
            OSError: there is no file of this name, or it isn't a regular file.
        """
        handle = os.open(
            self.name, flags | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY, dir_fd=self.folder
        )
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            os.close(handle)
            raise OSError(errno.EINVAL, "it is not a file")
        return handle


class Places:
    """Access to the files and folders in a folder, except private ones.

    Args:
        root: the folder.
        private: files and folders that must not be accessed, even if they are in `root`.
    """

    def __init__(self, root: Path, private: tuple[Path, ...] = ()) -> None:
        self.root = root.resolve()
        self._private = tuple(one.resolve() for one in private)

    @contextmanager
    def top(self) -> Iterator[int]:
        """Open the folder itself until the context ends. Yield the folder's descriptor."""
        handle = os.open(self.root, _FOLDER)
        try:
            yield handle
        finally:
            os.close(handle)

    @contextmanager
    def at(self, name: str, *, link: bool = False, make: bool = False) -> Iterator[At]:
        """Open the folder that contains a file until the context ends. Links in the path are followed if
        their targets are in the project.

        Args:
            name: path of the file from the top of the project. The file need not exist.
            link: True to address the link itself, not its target, if the last name in the path is a link.
            make: True to create missing folders of the path.

        Raises:
            Trouble: the file is outside of the project, private or hidden, or its folder can't be opened.
        """
        with in_words(name):
            parts = self.resolved(name, link=link)
            handle = os.open(self.root, _FOLDER)
            try:
                for part in parts[:-1]:
                    handle = self._enter(handle, part, make)
                made = At(handle, parts[-1], parts)
                told = made.look()
                if told is not None and self.is_private(told):
                    raise _private(name)
                yield made
            finally:
                os.close(handle)

    def resolved(self, name: str, *, link: bool = False) -> tuple[str, ...]:
        """Return the names in a path from the top of the project, with links resolved.

        Raises:
            Trouble: the path leads out of the project, or to a private or hidden file.
            OSError: links form a loop.
        """
        parts = parts_of(name)
        if link:
            place = (self.root.joinpath(*parts[:-1]).resolve()) / parts[-1]
        else:
            place = self.root.joinpath(*parts).resolve()
        if not place.is_relative_to(self.root) or place == self.root:
            raise Trouble(f"{quoted(name)} isn't in the project's folder", "name a file of the project", "")
        if any(place.is_relative_to(one) for one in self._private):
            raise _private(name)
        # refuses a hidden file, to which a link may lead
        return parts_of(place.relative_to(self.root).as_posix())

    def _enter(self, folder: int, part: str, make: bool) -> int:
        """Open a subfolder and close its parent. Return the descriptor of the subfolder."""
        if make:
            with suppress(FileExistsError):
                os.mkdir(part, 0o777, dir_fd=folder)
        try:
            inner = os.open(part, _FOLDER, dir_fd=folder)
        except FileNotFoundError:
            raise Trouble(f"there is no folder {quoted(part)}", "make it first", "missing") from None
        if self.is_private(os.fstat(inner)):
            os.close(inner)
            raise _private(part)
        os.close(folder)
        return inner

    def is_private(self, status: os.stat_result) -> bool:
        """Return True if a file or folder is private, by whatever name it was reached.

        Args:
            status: status of the file or folder from the operating system.
        """
        return (status.st_dev, status.st_ino) in self.private_now()

    def private_now(self) -> frozenset[tuple[int, int]]:
        """Return the devices and inodes of the private files and folders."""
        return _identities(self._private)

    def holds_private(self, status: os.stat_result) -> bool:
        """Return True if a folder contains a private file or folder at any depth. `status` is the status of
        the folder from the operating system.
        """
        above = {up for one in self._private for up in one.parents}
        return (status.st_dev, status.st_ino) in _identities(above)


def _identities(places: Iterable[Path]) -> frozenset[tuple[int, int]]:
    identities = set()
    for one in places:
        with suppress(OSError):  # it doesn't exist yet
            told = one.stat()
            identities.add((told.st_dev, told.st_ino))
    return frozenset(identities)


def _private(name: str) -> Trouble:
    return Trouble(f"{quoted(name)} is used by the pendant itself", "name a file of the project", "")
