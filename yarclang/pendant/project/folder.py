"""Access to the project's files. The pendant reads and writes these files only through this module."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from yarclang.backend import suffixes
from yarclang.pendant.project.draft import Draft
from yarclang.pendant.project.guarded import Guarded
from yarclang.pendant.project.names import check_new, folded, parts_of, quoted
from yarclang.pendant.project.places import At, Places, in_words
from yarclang.pendant.project.room import check_room
from yarclang.pendant.project.trash import Deleted, Trash
from yarclang.pendant.project.tree import Entry, Walk, moment
from yarclang.runtime.actions import Trouble

MOST_TEXT = 1 << 20
"""Longest text that is opened or saved [bytes in UTF-8]."""

MOST_COPIED = 1 << 30
"""Largest file that is copied [bytes]."""

_PIECE = 1 << 20

_OWN = ("", "-wal", "-shm", "-journal")
"""Endings of the names of the files that SQLite creates for a database."""


@dataclass(frozen=True, slots=True)
class Written:
    """A file on the disk, after it was read or written.

    Attributes:
        file: path in the project.
        size: size [bytes].
        sha256: SHA-256 of the content in hexadecimal digits.
        changed: time of the last change (UTC).
    """

    file: str
    size: int
    sha256: str
    changed: str


class ProjectFolder:
    """The files of a project. All functions wait for the disk: call them in a thread.

    Args:
        folder: folder of the project.
        database: file of the pendant's database. The database and the pendant's other files in the same
            folder, such as the trash, can't be accessed as files of the project.
        robots: folders that describe robots; only service users may change their files.

    Attributes:
        guarded: decides which files describe the robot or its cell.
    """

    def __init__(self, folder: Path, database: Path, robots: tuple[Path, ...] = ()) -> None:
        self.root = folder.resolve()
        data = database.resolve().parent
        own = [Path(f"{database.resolve()}{end}") for end in _OWN]
        private = [*own, data / "key.pem", data / "certificate.pem", data / "trash"]
        if not self.root.is_relative_to(data):
            private.append(data)
        self._places = Places(self.root, tuple(private))
        self.guarded = Guarded(self._places, robots)
        self._changing = threading.RLock()
        self.trash = Trash(data / "trash", self._places)

    # reading

    def path(self, name: str) -> Path:
        """Return the absolute path of a file or folder of the project, for code that opens files by path. The
        file or folder need not exist.

        Raises:
            Trouble: the path is outside of the project, hidden, or that of the pendant's own files.
        """
        with in_words(name):
            inside = name
            if name.startswith("/"):
                place = Path(name)
                inside = place.relative_to(self.root).as_posix() if place.is_relative_to(self.root) else name
            if inside in (".", ""):
                return self.root
            return self.root.joinpath(*self._places.resolved(inside))

    def entries(self, most: int) -> tuple[tuple[Entry, ...], bool]:
        """Return two values: at most `most` files and folders of the project, and True if there are more."""
        return self._listed(Walk(self._places), most)

    def programs(self, most: int) -> tuple[tuple[Entry, ...], bool]:
        """Return two values: at most `most` programs of the project, and True if there may be more."""
        return self.with_suffix((".yarc", *suffixes()), most)

    def with_suffix(self, suffixes: tuple[str, ...], most: int) -> tuple[tuple[Entry, ...], bool]:
        """Return two values: at most `most` files whose names have one of the suffixes, and True if there
        may be more.
        """
        return self._listed(Walk(self._places, suffixes), most)

    def _listed(self, walk: Walk, most: int) -> tuple[tuple[Entry, ...], bool]:
        entries: list[Entry] = []
        with in_words(self.root.name):
            for entry in walk.entries():
                if len(entries) == most:
                    return tuple(entries), True
                entries.append(entry)
        return tuple(entries), walk.cut

    def read(self, name: str, most: int = MOST_TEXT) -> tuple[bytes, Written]:
        """Return the content of a file, and its size, hash and time.

        Args:
            name: path in the project.
            most: largest allowed size of the file [bytes].

        Raises:
            Trouble: the file can't be read, or is larger than `most`.
        """
        with self.opened(name) as (handle, status, _):
            if status.st_size > most:
                raise _too_large(name, status.st_size, most)
            pieces: list[bytes] = []
            size = 0
            while data := os.read(handle, _PIECE):
                pieces.append(data)
                size += len(data)
                if size > most:  # the file has grown since its size was read
                    raise _too_large(name, size, most)
            content = b"".join(pieces)
            return content, Written(name, size, hashlib.sha256(content).hexdigest(), moment(status.st_mtime))

    def sha256(self, name: str) -> str:
        """Return the SHA-256 of a file that isn't larger than `MOST_COPIED`.

        Raises:
            Trouble: the file can't be read, or is larger than `MOST_COPIED`.
        """
        with self.opened(name) as (handle, told, _):
            if told.st_size > MOST_COPIED:
                raise _too_large(name, told.st_size, MOST_COPIED)
            return _hashed(handle)

    @contextmanager
    def opened(self, name: str) -> Iterator[tuple[int, os.stat_result, str]]:
        """Open a file for reading until the context ends. Yield three values: the file's descriptor, status,
        and name with links resolved.

        Raises:
            Trouble: the file can't be opened.
        """
        with self._places.at(name) as place:
            handle = place.open(os.O_RDONLY)
            try:
                status = os.fstat(handle)
                if self._places.is_private(status):
                    raise Trouble(
                        f"{quoted(name)} is used by the pendant itself", "name a file of the project", ""
                    )
                yield handle, status, place.name
            finally:
                os.close(handle)

    # changes

    @contextmanager
    def unchanged(self) -> Iterator[None]:
        """Prevent other threads from changing the project through this object until the context ends."""
        with self._changing:
            yield

    def write(self, name: str, data: bytes, known_hash: str | None) -> Written:
        """Write a file as a whole.

        Args:
            name: path in the project.
            data: the new content.
            known_hash: SHA-256 of the version that is replaced; None for a new file.

        Raises:
            Trouble: the present version of the file doesn't have the hash `known_hash` (code "changed"), or
                the file can't be written. The file is unchanged.
        """
        with self.draft(name, len(data)) as draft, in_words(name):
            draft.write(data)
            return self.stand(draft, name, known_hash)

    def change(self, name: str, data: bytes, known_hash: str, user: str) -> Written:
        """Replace a file as a whole, and keep the old version in the trash.

        Args:
            name: path in the project.
            data: the new content.
            known_hash: SHA-256 of the version that is replaced.
            user: user who changes the file.

        Raises:
            Trouble: the present version of the file doesn't have the hash `known_hash` (code "changed"), or
                the file can't be written or its old version can't be moved to the trash. The file is
                unchanged.
        """
        with self._changing, in_words(name):
            before, told = self.read(name)
            if told.sha256 == known_hash:
                self.trash.keep(name, before, user)
            return self.write(name, data, known_hash)

    @contextmanager
    def draft(self, name: str, size: int) -> Iterator[Draft]:
        """Begin to write a file, as a draft. A call of `stand` completes the file. If the context ends
        without this call, no part of the file is left.

        Args:
            name: path in the project.
            size: expected size [bytes].

        Raises:
            Trouble: a file of this name isn't allowed, or the disk has too little space.
        """
        with self._places.at(name) as place:
            if place.look() is None:
                self._check_new(place, name)
            self._check_room(place, name, size)
            made = Draft(place)
        with closing(made):
            yield made

    def stand(self, draft: Draft, name: str, known_hash: str | None) -> Written:
        """Complete a file that was written as a draft, either as a new file or as a replacement of a known
        version.

        Args:
            draft: the file.
            name: path in the project.
            known_hash: SHA-256 of the version that is replaced; None for a new file.

        Raises:
            Trouble: the present version of the file doesn't have the hash `known_hash` (code "changed"), or
                the file can't be written.
        """
        with in_words(name):
            draft.settle()
        with self._changing, self._places.at(name) as place:
            before = place.look()
            if known_hash is None:
                if before is None:
                    self._check_new(place, name)
                    with _as_taken(name):
                        draft.stand_new()
                else:
                    raise self._other(place, name)
            else:
                if before is None:
                    raise Trouble(f"{quoted(name)} was deleted meanwhile", "save it as a new file", "changed")
                if self._sha256(place) != known_hash:
                    raise self._other(place, name)
                if not os.access(place.name, os.W_OK, dir_fd=place.folder):
                    raise OSError(errno.EACCES, "")
                draft.keep_mode(before)
                draft.stand_in_place()
            after = place.look()
        changed = moment(after.st_mtime if after else 0.0)
        return Written(name, draft.size, draft.sha256, changed)

    def copy(self, name: str, to: str, check: Callable[[Draft], None] = lambda _: None) -> Written:
        """Copy a file to an unused path.

        Args:
            name: path of the file.
            to: path of the copy.
            check: called with the draft of the copy before the copy gets its name; may raise to prevent the
                copy.

        Raises:
            Trouble: the path is taken, or the file can't be copied.
        """
        with self.opened(name) as (handle, told, _):
            if told.st_size > MOST_COPIED:
                raise _too_large(name, told.st_size, MOST_COPIED)
            with self.draft(to, told.st_size) as draft, in_words(to):
                draft.take_from(handle)
                check(draft)
                return self.stand(draft, to, None)

    def rename(self, name: str, to: str) -> None:
        """Move a file or folder to an unused path.

        Raises:
            Trouble: the path is taken, or the file or folder can't be moved.
        """
        with self._changing, self._places.at(name, link=True) as old:
            status = self._status_of(old, name)
            target = parts_of(to)
            if stat.S_ISDIR(status.st_mode) and target[: len(old.parts)] == old.parts and target != old.parts:
                raise Trouble(f"{quoted(name)} can't be moved into itself", "choose another folder", "")
            with self._places.at(to, link=True) as new:
                self._check_new(new, to, but=status)
                there = new.look()
                if there is not None and (there.st_dev, there.st_ino) != (status.st_dev, status.st_ino):
                    raise OSError(errno.EEXIST, "")
                with in_words(to):
                    _moved(old, new, status, same=there is not None)

    def make_folder(self, name: str) -> None:
        """Create a folder.

        Raises:
            Trouble: the name is taken, or the folder can't be created.
        """
        with self._changing, self._places.at(name, link=True) as place:
            self._check_new(place, name)
            os.mkdir(place.name, 0o777, dir_fd=place.folder)

    def make_folders(self, name: str) -> None:
        """Create a folder and its missing parents.

        Raises:
            Trouble: a folder can't be created.
        """
        parts = name.split("/")
        for count in range(1, len(parts) + 1):
            path = "/".join(parts[:count])
            with self._changing, self._places.at(path) as place:
                if place.look() is None:
                    self._check_new(place, path)
                    os.mkdir(place.name, 0o777, dir_fd=place.folder)

    def remove_kept(self, name: str) -> None:
        """Remove a file, or a link to a file, of which a copy has been saved elsewhere. It isn't moved to the
        trash.

        Raises:
            Trouble: the file can't be removed.
        """
        with self._changing, self._places.at(name, link=True) as place:
            self._status_of(place, name)
            os.unlink(place.name, dir_fd=place.folder)

    def remove_empty(self, name: str) -> None:
        """Remove an empty folder.

        Raises:
            Trouble: the folder isn't empty, or can't be removed.
        """
        with self._changing, self._places.at(name, link=True) as place:
            os.rmdir(place.name, dir_fd=place.folder)

    def delete(self, name: str, user: str) -> Deleted:
        """Move a file or folder to the trash.

        Args:
            name: path in the project.
            user: user who deletes the file or folder.

        Raises:
            Trouble: the file or folder can't be moved to the trash; it is unchanged.
        """
        with self._changing, self._places.at(name, link=True) as place:
            self._status_of(place, name)
            return self.trash.take(place, name, user)

    def restore(self, number: str) -> str:
        """Restore a file or folder from the trash. Return its path, which differs from the old path if the
        old path is taken.

        Raises:
            Trouble: the file or folder is no longer in the trash, or can't be restored.
        """
        with self._changing:
            return self.trash.give_back(number)

    # checks

    def _status_of(self, place: At, name: str) -> os.stat_result:
        status = place.look()
        if status is None:
            raise OSError(errno.ENOENT, "")
        kind = stat.S_IFMT(status.st_mode)
        if kind not in (stat.S_IFDIR, stat.S_IFREG, stat.S_IFLNK):
            raise Trouble(f"{quoted(name)} is not a file", "leave it unchanged", "")
        if kind == stat.S_IFDIR and self._places.holds_private(status):
            raise Trouble(
                f"{quoted(name)} contains files of the pendant itself", "don't move or delete it", ""
            )
        return status

    def _check_new(self, place: At, name: str, but: os.stat_result | None = None) -> None:
        """Check that a name is allowed for a new file, and that the folder contains no other file with a
        similar name. The file with the status `but` isn't counted.
        """
        check_new(place.parts)
        wanted = folded(place.name)
        with os.scandir(place.folder) as listed:
            for entry_name in listed:
                if entry_name.name != place.name and folded(entry_name.name) == wanted:
                    if but is not None and entry_name.inode() == but.st_ino:
                        continue
                    raise Trouble(
                        f"{quoted(name)} looks like {quoted(entry_name.name)}, which exists already",
                        "choose another name", "",
                    )  # fmt: skip

    def _check_room(self, place: At, name: str, size: int) -> None:
        check_room(os.fstatvfs(place.folder), size, f"{quoted(name)} has")

    def _sha256(self, place: At) -> str:
        handle = place.open(os.O_RDONLY)
        try:
            return _hashed(handle)
        finally:
            os.close(handle)

    def _other(self, place: At, name: str) -> Changed:
        present = ""
        with suppress(OSError):
            present = self._sha256(place)
        return Changed(name, present)


class Changed(Trouble):
    """Raised if a file isn't the version that the caller has read before.

    Attributes:
        sha256: SHA-256 of the file's present version; empty if the file doesn't exist.
    """

    def __init__(self, name: str, sha256: str) -> None:
        super().__init__(
            f"{quoted(name)} exists with another content",
            "open it again, or save under another name",
            "changed",
        )
        self.sha256 = sha256


@contextmanager
def _as_taken(name: str) -> Iterator[None]:
    try:
        yield
    except FileExistsError:
        raise Changed(name, "") from None


def _moved(old: At, new: At, status: os.stat_result, *, same: bool) -> None:
    """Move a file or folder to an unused path.

    With `same`, both paths name the same file, for example if only capital letters change on a disk that
    ignores case.
    """
    if not same and stat.S_ISREG(status.st_mode):
        try:
            os.link(old.name, new.name, src_dir_fd=old.folder, dst_dir_fd=new.folder, follow_symlinks=False)
        except OSError as error:
            if error.errno not in (errno.EPERM, errno.EOPNOTSUPP, errno.EMLINK):
                raise
        else:
            try:
                os.unlink(old.name, dir_fd=old.folder)
            except OSError:
                os.unlink(new.name, dir_fd=new.folder)
                raise
            return
    os.rename(old.name, new.name, src_dir_fd=old.folder, dst_dir_fd=new.folder)


def _hashed(handle: int) -> str:
    found = hashlib.sha256()
    while data := os.read(handle, _PIECE):
        found.update(data)
    return found.hexdigest()


def _too_large(name: str, size: int, most: int) -> Trouble:
    return Trouble(
        f"{quoted(name)} has {size:,} bytes, but at most {most:,} can be opened here", "download it", "large"
    )
