"""Files that are written as a whole or not at all. A file has no name until it is complete, so that an
interrupted write leaves nothing on the disk.
"""

from __future__ import annotations

import errno
import hashlib
import os
import secrets
import stat
from contextlib import suppress

from yarclang.pendant.project.places import At

_PIECE = 1 << 20
_NAMELESS = getattr(os, "O_TMPFILE", 0)
_NO_LINKS = (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK)


class Draft:
    """A file that is being written, in the folder of the finished file.

    Args:
        place: folder and name of the finished file. The folder stays open as long as the draft.

    Attributes:
        size: number of bytes written so far.

    Raises:
        OSError: the file can't be created.
    """

    def __init__(self, place: At) -> None:
        self._folder = os.dup(place.folder)
        self._name = place.name
        self._temporary = ""
        self._hash = hashlib.sha256()
        self.size = 0
        try:
            self._file = self._opened()
        except BaseException:
            os.close(self._folder)
            raise

    def _opened(self) -> int:
        try:
            return os.open(".", _NAMELESS | os.O_WRONLY | os.O_CLOEXEC, 0o666, dir_fd=self._folder)
        except OSError as error:  # some file systems support no files without a name
            if error.errno not in (errno.EOPNOTSUPP, errno.EISDIR, errno.ENOENT, errno.EINVAL):
                raise
        self._temporary = f".yarc-{secrets.token_hex(8)}"
        flags = os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_NOFOLLOW | os.O_CLOEXEC
        return os.open(self._temporary, flags, 0o666, dir_fd=self._folder)

    @property
    def sha256(self) -> str:
        """Hash of the content so far, in hexadecimal digits."""
        return self._hash.hexdigest()

    def write(self, data: bytes) -> None:
        """Append data.

        Raises:
            OSError: there is no room, or the disk fails.
        """
        self._hash.update(data)
        self.size += len(data)
        view = memoryview(data)
        while view:
            view = view[os.write(self._file, view) :]

    def take_from(self, handle: int) -> None:
        """Append the content of an open file."""
        while data := os.read(handle, _PIECE):
            self.write(data)

    def settle(self) -> None:
        """Wait until the content is on the disk."""
        os.fsync(self._file)

    def keep_mode(self, before: os.stat_result) -> None:
        """Copy the mode of the file that is replaced, and its owner if permitted."""
        with suppress(OSError):  # only root may change the owner
            os.fchown(self._file, before.st_uid, before.st_gid)
        os.fchmod(self._file, stat.S_IMODE(before.st_mode))

    def stand_new(self) -> None:
        """Complete the draft as a new file: give the file its name.

        Raises:
            FileExistsError: the name is taken.
            OSError: the file can't get its name; its content is discarded.
        """
        try:
            self._link(self._name)
        except FileExistsError:
            raise
        except OSError as error:
            if error.errno not in _NO_LINKS or not self._temporary:
                raise
            # The file system has no hard links. Reserve the name by an empty file, then replace this file.
            flags = os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC
            os.close(os.open(self._name, flags, 0o666, dir_fd=self._folder))
            self._replace()
            return
        self._sync_folder()

    def stand_in_place(self) -> None:
        """Complete the draft as a replacement of the existing file of this name.

        Raises:
            OSError: the existing file can't be replaced; it is unchanged.
        """
        if not self._temporary:
            name = f".yarc-{secrets.token_hex(8)}"
            self._link(name)
            self._temporary = name
        self._replace()

    def _link(self, name: str) -> None:
        if self._temporary:
            os.link(
                self._temporary, name,
                src_dir_fd=self._folder, dst_dir_fd=self._folder, follow_symlinks=False,
            )  # fmt: skip
        else:
            os.link(f"/proc/self/fd/{self._file}", name, dst_dir_fd=self._folder, follow_symlinks=True)

    def _replace(self) -> None:
        os.replace(self._temporary, self._name, src_dir_fd=self._folder, dst_dir_fd=self._folder)
        self._temporary = ""
        self._sync_folder()

    def _sync_folder(self) -> None:
        with suppress(OSError):  # some systems can't
            os.fsync(self._folder)

    def close(self) -> None:
        """Discard the file if it has no name yet."""
        if self._temporary:
            with suppress(OSError):
                os.unlink(self._temporary, dir_fd=self._folder)
            self._temporary = ""
        with suppress(OSError):
            os.close(self._file)
        os.close(self._folder)
