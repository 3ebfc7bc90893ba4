"""Changes in the project's folder since the last git commit.

The contents of the files are hashed here, and the hashes are compared with those that git has stored. `git
status` isn't used, because it would run filters that the repository defines.
"""

from __future__ import annotations

import hashlib
import os
from collections import OrderedDict
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Literal

from yarclang.pendant.project.asking_git import Missing, ask
from yarclang.pendant.project.folder import MOST_TEXT, ProjectFolder
from yarclang.pendant.project.names import quoted
from yarclang.runtime.actions import Trouble

Kind = Literal["new", "changed", "deleted"]

_MOST_FILES = 20_000
_MOST_COMPARED = 100_000_000
"""Largest file that is compared by its content [bytes]."""
_MOST_REMEMBERED = 40_000
_Key = tuple[str, int, int, int, int]
_FILES = ("100644", "100755", "100664")


@dataclass(frozen=True, slots=True)
class Commit:
    """A commit.

    Attributes:
        hash: hash of the commit.
        who: author of the commit.
        when: time of the commit (UTC).
        subject: first line of the message.
    """

    hash: str
    who: str
    when: str
    subject: str


@dataclass(frozen=True, slots=True)
class State:
    """State of the work tree of a git repository.

    Attributes:
        commit: the last commit; None if there is none yet.
        changes: kind of change of each changed file, by the file's path.
        cut: True if not all files were compared.
    """

    commit: Commit | None
    changes: dict[str, Kind]
    cut: bool


@dataclass(frozen=True, slots=True)
class _Blob:
    """A file of a commit: its hash and size [bytes]."""

    hash: str
    size: int


class Git:
    """Access to the repository of a project's folder. Only one thread at a time may call it.

    Args:
        folder: folder of the project.
    """

    def __init__(self, folder: ProjectFolder) -> None:
        self._folder = folder
        self._known: OrderedDict[_Key, str] = OrderedDict()

    def state(self) -> State | None:
        """Return the changes since the last commit; None if the project's folder isn't in a git repository.

        Raises:
            Trouble: git isn't installed, refuses the folder, or takes too long.
        """
        commit = self._head()
        if commit is None:
            return None
        blobs = self._blobs() if commit else {}
        others = {one for one in self._listed("-c", "-o", "--exclude-standard") if one not in blobs}
        entries, cut = self._folder.entries(_MOST_FILES)
        changes: dict[str, Kind] = {}
        present = {one.file for one in entries if not one.is_folder}
        for file in sorted(present):
            if file in blobs:
                if self._is_changed(file, blobs[file]):
                    changes[file] = "changed"
            elif file in others:
                changes[file] = "new"
        if not cut:
            changes |= dict.fromkeys(
                sorted(file for file in blobs if file not in present and not _is_hidden(file)), "deleted"
            )
        return State(commit or None, changes, cut)

    def difference(self, file: str) -> tuple[str, str]:
        """Return the text of a file in the last commit, and its present text. A text is empty if the file
        doesn't exist in that version.

        Raises:
            Trouble: the file isn't text or is too large, or there is no commit.
        """
        commit = self._head()
        if not commit:
            raise Trouble("there is no commit to compare with", "commit on the pendant's computer", "git")
        blob = self._blobs().get(file)
        if blob is not None and blob.size > MOST_TEXT:
            raise Trouble(f"{quoted(file)} had {blob.size:,} bytes, but at most {MOST_TEXT:,} can be "
            "compared",
                "use git on the pendant's computer", "large")  # fmt: skip
        base = b"" if blob is None else ask(self._folder.root, "cat-file", "blob", blob.hash, most=MOST_TEXT)
        try:
            present = self._folder.read(file)[0]
        except Trouble as trouble:
            if trouble.code != "missing" or blob is None:
                raise
            present = b""
        return text_of(file, base), text_of(file, present)

    def _head(self) -> Commit | Literal[""] | None:
        """Return the last commit; an empty text if there is none yet, None if the folder isn't in a git
        repository.
        """
        root = self._folder.root
        try:
            inside = ask(root, "rev-parse", "--is-inside-work-tree").strip()
        except Missing:
            return None
        if inside != b"true":
            return None
        try:
            named = ask(root, "rev-parse", "--verify", "--quiet", "--end-of-options", "HEAD^{commit}")
            found = named.decode("ascii").strip()
            return _commit(found, ask(root, "cat-file", "commit", found, most=1 << 20))
        except (Missing, UnicodeDecodeError):
            return ""

    def _blobs(self) -> dict[str, _Blob]:
        """Return the files in the project's folder as of the last commit."""
        blobs: dict[str, _Blob] = {}
        for row in ask(self._folder.root, "ls-tree", "-r", "-l", "-z", "HEAD").split(b"\0"):
            told, _, name = row.partition(b"\t")
            words = told.decode("ascii", "replace").split()
            if len(words) == 4 and words[0] in _FILES and words[3].isdigit():
                blobs[os.fsdecode(name)] = _Blob(words[2], int(words[3]))
        return blobs

    def _listed(self, *options: str) -> set[str]:
        return {os.fsdecode(one) for one in ask(self._folder.root, "ls-files", "-z", *options).split(b"\0")}

    def _is_changed(self, file: str, blob: _Blob) -> bool:
        try:
            with self._folder.opened(file) as (handle, status, _):
                if status.st_size > _MOST_COMPARED:
                    return status.st_size != blob.size
                kind = "sha1" if len(blob.hash) == 40 else "sha256"
                key = (kind, status.st_ino, status.st_mtime_ns, status.st_ctime_ns, status.st_size)
                if status.st_size == blob.size:
                    return self._hash(handle, key) != blob.hash
                if status.st_size > MOST_TEXT or status.st_size < blob.size:
                    return True
                data = _whole(handle).replace(b"\r\n", b"\n")  # a work tree may have other line endings
                return _hashed(kind, data) != blob.hash
        except Trouble:  # the file was removed, or is no regular file any more
            return True

    def _hash(self, handle: int, key: _Key) -> str:
        hashed = self._known.get(key)
        if hashed is None:
            hashed = _hashed(key[0], _whole(handle))
            self._known[key] = hashed
            if len(self._known) > _MOST_REMEMBERED:
                self._known.popitem(last=False)
        return hashed


def text_of(file: str, content: bytes) -> str:
    """Decode the content of a file as text.

    Raises:
        Trouble: the content isn't UTF-8.
    """
    try:
        text = content.decode()
    except UnicodeDecodeError as error:
        raise Trouble(
            f"{quoted(file)} isn't UTF-8 text: byte {error.start + 1:,} can't be read",
            "download it",
            "binary",
        ) from None
    if "\0" in text:
        raise Trouble(f"{quoted(file)} isn't text: it contains a byte 0", "download it", "binary")
    return text


def _commit(name: str, content: bytes) -> Commit:
    head, _, message = content.decode(errors="replace").partition("\n\n")
    author, moment = "", ""
    for line in head.splitlines():
        if line.startswith("author "):
            words = line.removeprefix("author ").rsplit(" ", 2)
            author = words[0].rpartition(" <")[0] or words[0]
        elif line.startswith("committer "):
            moment = _moment(line.rsplit(" ", 2)[-2])
    return Commit(name, author[:200], moment, message.strip().partition("\n")[0][:200])


def _moment(seconds: str) -> str:
    try:
        return datetime.fromtimestamp(int(seconds), UTC).isoformat(timespec="milliseconds")
    except (ValueError, OverflowError, OSError):
        return ""


def _whole(handle: int) -> bytes:
    pieces = []
    while data := os.read(handle, 1 << 20):
        pieces.append(data)
        if sum(map(len, pieces)) > _MOST_COMPARED + (1 << 20):
            break
    return b"".join(pieces)


def _hashed(kind: str, data: bytes) -> str:
    """Return the hash of a file's content as git computes it."""
    return hashlib.new(kind, b"blob %d\0" % len(data) + data, usedforsecurity=False).hexdigest()


def _is_hidden(file: str) -> bool:
    return any(part.startswith(".") for part in file.split("/"))
