"""The trash: deleted files and old versions of changed files, stored in the pendant's own folder. Their
number, age and total size are limited.
"""

from __future__ import annotations

import errno
import json
import os
import secrets
import shutil
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from yarclang.pendant.project.moving import carried, measured, removed
from yarclang.pendant.project.names import quoted
from yarclang.pendant.project.places import At, Places, in_words
from yarclang.pendant.project.tree import moment
from yarclang.runtime.actions import Trouble

MOST_KEPT = 200
MOST_AGE = 30 * 86400.0
"""Time after which deleted files are removed from the trash [s]."""
MOST_SIZE = 2_000_000_000
"""Largest size of the trash [bytes]."""
LARGEST = 500_000_000
"""Largest file or folder that can be moved to the trash [bytes]. A larger one can't be deleted at the
pendant.
"""

_CONTENT, _NOTE = "content", "deleted.json"


@dataclass(frozen=True, slots=True)
class Deleted:
    """Record of a file or folder in the trash: a deleted one, or the old version of a file that was changed.

    Attributes:
        number: identifier in the trash.
        file: path in the project to which the file or folder would be restored.
        size: size [bytes].
        at: time at which the file or folder was moved to the trash [s since 1970].
        deleted: the same time as text (UTC).
        user: name of the user who deleted or changed the file or folder.
        is_folder: True for a folder.
    """

    number: str
    file: str
    size: int
    at: float
    deleted: str
    user: str
    is_folder: bool


@dataclass(slots=True)
class Keeping:
    """A file that is being written to the trash.

    Attributes:
        name: path in the project to which the file will be restored.
        user: name of the user whose action saves the file.
        number: identifier in the trash.
        at: time at which writing began [s since 1970].
        file: the open file.
        size: number of bytes written so far.
    """

    name: str
    user: str
    number: str
    at: float
    file: BinaryIO
    size: int = 0

    def write(self, data: bytes) -> None:
        """Append data.

        Raises:
            Trouble: the file is too large.
            OSError: the data can't be written.
        """
        self.size += len(data)
        if self.size > LARGEST:
            raise Trouble(
                f"{quoted(self.name)} would have more than {LARGEST:,} bytes, which is too much to keep "
                "for undo",
                "move large files out of the project first", "",
            )  # fmt: skip
        self.file.write(data)

    def made(self) -> Deleted:
        """Return the record of the file."""
        return Deleted(
            self.number, self.name, self.size, self.at, moment(self.at), self.user, is_folder=False
        )


class Trash:
    """The trash of a project. Only one thread at a time may change it.

    Args:
        folder: folder of the trash; created with the first file.
        places: access to the files of the project.
    """

    def __init__(self, folder: Path, places: Places) -> None:
        self._folder = folder
        self._places = places
        self._recover()

    def take(self, place: At, name: str, user: str) -> Deleted:
        """Move a file or folder to the trash.

        Args:
            place: open folder that contains the file or folder, and its name there.
            name: path of the file or folder in the project.
            user: name of the user who deletes the file or folder.

        Raises:
            Trouble: the file or folder is too large, or contains a pipe, a device, or too many files.
            OSError: the file or folder can't be moved; it is unchanged.
        """
        status = os.stat(place.name, dir_fd=place.folder, follow_symlinks=False)
        size = measured(place.folder, place.name)
        if size > LARGEST:
            raise Trouble(
                f"{quoted(name)} has {size:,} bytes, but at most {LARGEST:,} can be kept for undo",
                "delete it on the computer itself", "",
            )  # fmt: skip
        now = time.time()
        number = f"{int(now * 1000):014d}-{secrets.token_hex(4)}"
        deleted = Deleted(
            number, "/".join(place.parts), size, now, moment(now), user, stat.S_ISDIR(status.st_mode)
        )
        kept_file = self._folder / number
        kept_file.mkdir(mode=0o700, parents=True)
        self._folder.chmod(0o700)
        hidden = f".yarc-deleted-{number}"
        try:
            _write(kept_file / _NOTE, asdict(deleted))
            # Hide the folder under another name first, so that nobody changes it while it is copied to
            # another disk.
            os.rename(place.name, hidden, src_dir_fd=place.folder, dst_dir_fd=place.folder)
            try:
                self._bring(place.folder, hidden, kept_file)
            except BaseException:
                os.rename(hidden, place.name, src_dir_fd=place.folder, dst_dir_fd=place.folder)
                raise
        except BaseException:
            shutil.rmtree(kept_file, ignore_errors=True)
            raise
        self._bound()
        return deleted

    def keep(self, name: str, content: bytes, user: str) -> Deleted:
        """Save the old version of a text file in the trash before the file is changed.

        Args:
            name: path of the file in the project.
            content: the old text.
            user: name of the user who changes the file.

        Raises:
            OSError: the text can't be written to the trash.
        """
        with self.keeping(name, user) as keeping:
            keeping.write(content)
        return keeping.made()

    @contextmanager
    def keeping(self, name: str, user: str) -> Iterator[Keeping]:
        """Write a file to the trash, piece by piece, until the context ends. If the context ends with an
        error, no part of the file is left.

        Args:
            name: path in the project to which the file will be restored.
            user: name of the user whose action saves the file.

        Raises:
            Trouble: the file is too large.
            OSError: the file can't be written.
        """
        now = time.time()
        number = f"{int(now * 1000):014d}-{secrets.token_hex(4)}"
        kept_file = self._folder / number
        kept_file.mkdir(mode=0o700, parents=True)
        self._folder.chmod(0o700)
        try:
            part = kept_file / f"{_CONTENT}.part"
            with part.open("xb") as file:
                keeping = Keeping(name, user, number, now, file)
                yield keeping
                file.flush()
                os.fsync(file.fileno())
            _write(kept_file / _NOTE, asdict(keeping.made()))
            part.rename(kept_file / _CONTENT)
            for folder in (kept_file, self._folder):
                _settle(folder)
        except BaseException:
            shutil.rmtree(kept_file, ignore_errors=True)
            raise
        self._bound()

    def open_kept(self, number: str) -> tuple[Deleted, int]:
        """Open a file in the trash. Return two values: the record of the file, and its descriptor, which the
        caller closes.

        Raises:
            Trouble: the trash has no file with this number any more.
        """
        deleted = next((one for one in self.kept() if one.number == number and not one.is_folder), None)
        if deleted is None:
            raise Trouble("this file is no longer kept", "look at the list of what was deleted", "missing")
        with in_words(deleted.file):
            flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
            return deleted, os.open(self._folder / deleted.number / _CONTENT, flags)

    def _bring(self, folder: int, name: str, kept_file: Path) -> None:
        target = os.open(kept_file, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            try:
                os.rename(name, _CONTENT, src_dir_fd=folder, dst_dir_fd=target)
            except OSError as error:
                if error.errno != errno.EXDEV:
                    raise
                part = f"{_CONTENT}.part"
                carried(folder, name, target, part)
                os.rename(part, _CONTENT, src_dir_fd=target, dst_dir_fd=target)
                os.fsync(target)
                # the copy in the trash is complete; at worst, a hidden part of the original is left here
                with suppress(OSError):
                    removed(folder, name)
        finally:
            os.close(target)

    def give_back(self, number: str) -> str:
        """Restore a file or folder from the trash. Return its path in the project: the old path or, if the
        old path is taken, the old path with a number added.

        Raises:
            Trouble: the file or folder is no longer in the trash, or can't be moved to its path; then it
                stays in the trash.
            OSError: the disk fails; the file or folder stays in the trash.
        """
        deleted = next((one for one in self.kept() if one.number == number), None)
        if deleted is None:
            raise Trouble("this file is no longer kept", "look at the list of what was deleted", "missing")
        kept_file = self._folder / number
        source = os.open(kept_file, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            for count in range(1, 100):
                name = deleted.file if count == 1 else _numbered(deleted.file, count)
                with self._places.at(name, link=True, make=True) as place:
                    if place.look() is None:
                        with in_words(name):
                            self._return(source, place)
                        break
            else:
                raise Trouble(
                    f"{quoted(deleted.file)} and 98 similar names are taken", "rename one of them", ""
                )
        finally:
            os.close(source)
        shutil.rmtree(kept_file, ignore_errors=True)
        return "/".join(place.parts)

    def _return(self, source: int, place: At) -> None:
        hidden = f".yarc-{secrets.token_hex(8)}"
        try:
            os.rename(_CONTENT, hidden, src_dir_fd=source, dst_dir_fd=place.folder)
        except OSError as error:
            if error.errno != errno.EXDEV:
                raise
            try:
                carried(source, _CONTENT, place.folder, hidden)
            except BaseException:
                with suppress(OSError):
                    removed(place.folder, hidden)
                raise
        os.rename(hidden, place.name, src_dir_fd=place.folder, dst_dir_fd=place.folder)

    def content(self, number: str) -> Path | None:
        """Return the path of a file or folder in the trash; None if it isn't there."""
        found = next((one for one in self.kept() if one.number == number), None)
        return None if found is None else self._folder / found.number / _CONTENT

    def kept(self) -> tuple[Deleted, ...]:
        """Return the records of all files and folders in the trash, newest first."""
        deleted_files = []
        with suppress(OSError):
            for one in sorted(self._folder.iterdir(), reverse=True):
                note = _read(one / _NOTE)
                if note is not None and os.path.lexists(one / _CONTENT):
                    deleted_files.append(note)
        return tuple(deleted_files)

    def _bound(self) -> None:
        """Remove the oldest files and folders until the trash is within its limits of number, size
        and age.
        """
        now, size = time.time(), 0
        for count, one in enumerate(self.kept()):
            size += one.size
            if count >= MOST_KEPT or size > MOST_SIZE or now - one.at > MOST_AGE:
                shutil.rmtree(self._folder / one.number, ignore_errors=True)

    def _recover(self) -> None:
        """Repair deletions that were interrupted, for example by a power failure. Files and folders that were
        hidden for their deletion get their old names again.
        """
        with suppress(OSError):
            for entry in list(self._folder.iterdir()):
                note = _read(entry / _NOTE)
                if os.path.lexists(entry / _CONTENT):
                    continue
                if note is None or self._shows_again(note):
                    shutil.rmtree(entry, ignore_errors=True)
        self._bound()

    def _shows_again(self, note: Deleted) -> bool:
        """Give the hidden file of an interrupted deletion its old name, unless the name is used. Return True
        if no hidden file is left.
        """
        hidden = f".yarc-deleted-{note.number}"
        with suppress(Trouble, OSError), self._places.at(note.file, link=True) as place:
            try:
                os.stat(hidden, dir_fd=place.folder, follow_symlinks=False)
            except FileNotFoundError:
                return True
            if place.look() is None:
                os.rename(hidden, place.name, src_dir_fd=place.folder, dst_dir_fd=place.folder)
                return True
        return False


def _numbered(path: str, count: int) -> str:
    folder, _, name = path.rpartition("/")
    stem, ending = PurePosixPath(name).stem, PurePosixPath(name).suffix
    while len(f"{stem} ({count}){ending}".encode()) > 255:
        stem = stem[:-1]
    return f"{folder}/{stem} ({count}){ending}".lstrip("/")


def _settle(folder: Path) -> None:
    """Wait until the names of a folder are on the disk."""
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        with suppress(OSError):  # not supported by all systems
            os.fsync(handle)
    finally:
        os.close(handle)


def _write(path: Path, content: object) -> None:
    with path.open("x", encoding="utf-8") as file:
        json.dump(content, file)
        file.flush()
        os.fsync(file.fileno())


def _read(path: Path) -> Deleted | None:
    try:
        return Deleted(**json.loads(path.read_text("utf-8")))
    except (OSError, ValueError, TypeError):
        return None
