"""Messages about the files of the project: lists, texts, deleted files, and changes since the last commit."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.replies import Denied
from yarclang.pendant.project.names import MOST_PATH

FilePath = Annotated[str, Field(max_length=MOST_PATH)]
"""Path relative to the project's folder, with slashes."""

Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
"""Hash of a file's content, in hexadecimal digits."""


class FileShown(Message):
    """A file or folder of the project: its path, its size [bytes], and the time of its last change (UTC)."""

    file: str
    size: int
    changed: str
    kind: Literal["folder", "program", "text", "picture", "other"]


class FileList(Message):
    """The files of the project; each folder comes before its content. `cut` is true if there are more
    files.
    """

    folder: str
    files: tuple[FileShown, ...]
    cut: bool


class FileText(Message):
    """A text of the project as it is on the disk. `sha256` is needed to save it again."""

    file: str
    text: str
    sha256: str
    changed: str


class SaveFile(Message):
    """Request to save a text. `known` is the hash of the version that was edited; null: the file must not
    exist yet.
    """

    text: str
    known: Sha256 | None


class FileWritten(Message):
    """A file after writing: its size [bytes], its hash, and the time (UTC)."""

    file: str
    size: int
    sha256: str
    changed: str


class OtherContent(Denied):
    """Refusal because somebody else has changed the file. `sha256` is the hash of its present content; empty
    if there is no such file.
    """

    sha256: str


class TwoPaths(Message):
    """Request to copy or move a file. The new path must be unused."""

    file: FilePath
    to: FilePath


class OnePath(Message):
    """The path of a file or a folder."""

    file: FilePath


class Restore(Message):
    """Request to restore a deleted file or folder by its number."""

    number: Annotated[str, Field(max_length=40)]


class DeletedShown(Message):
    """A deleted file or folder: its number, former path and size [bytes], the user who deleted it, and the
    time (UTC).
    """

    number: str
    file: str
    size: int
    deleted: str
    user: str
    folder: bool


class DeletedList(Message):
    """Deleted files that can be restored, the newest first."""

    deleted: tuple[DeletedShown, ...]


class CommitShown(Message):
    """A commit: its hash, its author, its time (UTC), and the first line of its message."""

    hash: str
    who: str
    when: str
    subject: str


class ChangeShown(Message):
    """A file that has changed since the last commit. `by` lists the users who changed it at the pendant;
    `outside` is true if the last change was made elsewhere.
    """

    file: str
    kind: Literal["new", "changed", "deleted"]
    by: tuple[str, ...]
    outside: bool


class GitState(Message):
    """Changes since the last commit. `there` is false if git isn't installed or the folder is in no work
    tree; then `what` is the reason.
    """

    there: bool
    what: str
    commit: CommitShown | None
    changes: tuple[ChangeShown, ...]
    cut: bool


class Difference(Message):
    """A text in the last commit (`base`), and its present version. Each is empty if the file doesn't exist in
    that version.
    """

    file: str
    base: str
    text: str
