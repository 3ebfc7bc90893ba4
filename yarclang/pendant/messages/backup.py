"""Messages about backups of the project."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message


class FileAndWhy(Message):
    """A file, and a remark about it."""

    file: str
    why: str


class KeptRestore(Message):
    """Files that a restore has replaced or removed: who did it and when (UTC), the number and size [bytes] of
    the saved files.
    """

    number: str
    user: str
    made: str
    size: int


class BackupShown(Message):
    """Content of a future backup; sizes in bytes."""

    robot: str
    files: int
    size: int
    logs: int
    """Logs of runs, which are left out unless they are wanted."""
    logs_size: int
    trouble: str
    """Reason for which no backup can be made; empty: it can."""
    left_out: tuple[FileAndWhy, ...]
    """Files that no backup can have, the first 100."""
    notes: tuple[str, ...]
    """Files that are left out."""
    undo: tuple[KeptRestore, ...]
    """Restores that can be undone, the newest first."""
    waits: bool
    """True if a zip of this session waits to be restored."""


class PlannedFile(Message):
    """A file that a restore would change, its size afterwards [bytes]; `extra`: the backup doesn't have it;
    `conflict`: it can't be restored, and `why`.
    """

    file: str
    what: Literal["new", "changed", "extra", "conflict"]
    size: int
    why: str = ""


class RestorePlan(Message):
    """Changes that restoring the uploaded backup would make. With a conflict it can't be restored."""

    number: str
    """Id of the upload."""
    digest: str
    """Id of the plan, which makes sure that the shown plan is the one that is carried out."""
    size: int
    robot: str
    made: str
    """Time at which the backup was made (UTC); empty: not given."""
    new: int
    changed: int
    same: int
    extra: int
    conflicts: int
    files: tuple[PlannedFile, ...]
    """Conflicts, changed, extra and new files, the first 2,000."""
    notes: tuple[str, ...]
    restart: tuple[str, ...]
    """Files that take effect only after a restart."""
    undoes: bool
    """True if the upload holds the files that an earlier restore replaced."""


class ApplyRestore(Message):
    """Restore the uploaded backup; `remove`: files that the backup doesn't have are deleted."""

    number: Annotated[str, Field(max_length=40)]
    digest: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    remove: bool


class Restored(Message):
    """Result of a restore; `undo` is the number for undoing it, empty if nothing has changed."""

    written: int
    removed: int
    undo: str
    restart: tuple[str, ...]


class UndoRestore(Message):
    """The number of files that a restore has replaced, as listed for undoing."""

    number: Annotated[str, Field(max_length=40)]
