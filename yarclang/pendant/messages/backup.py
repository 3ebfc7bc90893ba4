"""Messages about backups of the project."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message


class FileAndWhy(Message):
    """A file, and a remark about this file."""

    file: str
    why: str


class KeptRestore(Message):
    """Files that a restore has replaced or removed: the user who restored, the time (UTC), and the number and
    total size [bytes] of the saved files.
    """

    number: str
    user: str
    made: str
    size: int


class BackupShown(Message):
    """Content of a backup if it were made now; sizes in bytes."""

    robot: str
    files: int
    size: int
    logs: int
    """Number of run logs. They are left out of a backup unless requested."""
    logs_size: int
    trouble: str
    """Reason why no backup can be made; empty: it can be made."""
    left_out: tuple[FileAndWhy, ...]
    """Files that can't be in any backup; at most the first 100."""
    notes: tuple[str, ...]
    """Remarks about the files that this backup leaves out."""
    undo: tuple[KeptRestore, ...]
    """Restores that can be undone, the newest first."""
    waits: bool
    """True if a zip that this session has uploaded waits to be restored."""


class PlannedFile(Message):
    """A file that a restore would change, and its size afterwards [bytes]. `extra`: the file isn't in the
    backup. `conflict`: the file can't be restored, and `why` is the reason.
    """

    file: str
    what: Literal["new", "changed", "extra", "conflict"]
    size: int
    why: str = ""


class RestorePlan(Message):
    """Changes that restoring the uploaded backup would make. If there is a conflict, the backup can't be
    restored.
    """

    number: str
    """Id of the upload."""
    digest: str
    """Digest of the plan. With it, a restore makes only the changes that were shown."""
    size: int
    robot: str
    made: str
    """Time at which the backup was made (UTC); empty: the backup doesn't contain it."""
    new: int
    changed: int
    same: int
    extra: int
    conflicts: int
    files: tuple[PlannedFile, ...]
    """Conflicts, then changed, extra and new files; at most the first 2,000."""
    notes: tuple[str, ...]
    restart: tuple[str, ...]
    """Files that take effect only after a restart."""
    undoes: bool
    """True if the upload contains the files that an earlier restore has replaced."""


class ApplyRestore(Message):
    """Restore the uploaded backup. `remove`: also delete the files that were created after the backup."""

    number: Annotated[str, Field(max_length=40)]
    digest: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    remove: bool


class Restored(Message):
    """Result of a restore. `undo` is the number by which it can be undone; empty if nothing has changed."""

    written: int
    removed: int
    undo: str
    restart: tuple[str, ...]


class UndoRestore(Message):
    """Request to undo a restore: the number of the saved files, from the list of restores that can be
    undone.
    """

    number: Annotated[str, Field(max_length=40)]
