"""Messages about the files of the project: lists, texts, deleted files, and changes since the last commit."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.replies import Denied
from yarclang.pendant.project.names import MOST_PATH

FilePath = Annotated[str, Field(max_length=MOST_PATH)]
"""Path from the project's folder, with slashes."""

Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
"""Hash of a file's content, in hexadecimal digits."""


class FileShown(Message):
    """A file or folder of the project: its path, its size [bytes], and when it was changed (UTC)."""

    file: str
    size: int
    changed: str
    kind: Literal["folder", "program", "text", "picture", "other"]


class FileList(Message):
    """The files of the project, folders before what is in them; `cut` is true if there are more."""

    folder: str
    files: tuple[FileShown, ...]
    cut: bool


class FileText(Message):
    """A text of the project as on the disk; saving it requires its `sha256`."""

    file: str
    text: str
    sha256: str
    changed: str


class SaveFile(Message):
    """A text to save: `known` is the hash of the content that it was made from; null: there must be no such
    file yet.
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
    """Somebody else has changed the file: `sha256` is the hash of its present content, empty if it isn't
    there or is no file.
    """

    sha256: str


class TwoPaths(Message):
    """A file, and the path of its copy or its new path, which must be free."""

    file: FilePath
    to: FilePath


class OnePath(Message):
    """A file or a folder."""

    file: FilePath


class Restore(Message):
    """The number of something that was deleted."""

    number: Annotated[str, Field(max_length=40)]


class DeletedShown(Message):
    """A deleted file or folder, who deleted it and when (UTC): its number, former path and size [bytes]."""

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
    """A commit: its hash, its author, when (UTC), the first line of what it says."""

    hash: str
    who: str
    when: str
    subject: str


class ChangeShown(Message):
    """A file that has changed since the last commit; `by` are those who did so at the pendant, `outside` is
    true if something else did so last.
    """

    file: str
    kind: Literal["new", "changed", "deleted"]
    by: tuple[str, ...]
    outside: bool


class GitState(Message):
    """Changes since the last commit. Without git, or outside of a work tree, `there` is false and `what`
    gives the reason.
    """

    there: bool
    what: str
    commit: CommitShown | None
    changes: tuple[ChangeShown, ...]
    cut: bool


class Difference(Message):
    """A text as of the last commit (`base`), and as it is now; empty if it wasn't or isn't there."""

    file: str
    base: str
    text: str
