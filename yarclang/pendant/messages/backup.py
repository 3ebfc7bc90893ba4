"""Messages about backups of the project."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.message import Message


class FileAndWhy(Message):
    """A file, and what there is to say of it."""

    file: str
    why: str


class KeptRestore(Message):
    """What a restore has replaced or removed, by whom and when (UTC): its number, its size [bytes]."""

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
    """A file that a restore would change, its size afterwards [bytes]; `extra`: the backup doesn't have it; `conflict`: it can't be restored, and `why`."""

    file: str
    what: Literal["new", "changed", "extra", "conflict"]
    size: int
    why: str = ""


class RestorePlan(Message):
    """What restoring the backup that was uploaded would change. With a conflict it can't be restored."""

    number: str
    """Id of the upload."""
    digest: str
    """Id of the plan, which makes sure that the shown plan is the one that is carried out."""
    size: int
    robot: str
    made: str
    """When the backup was made (UTC); empty: it doesn't say."""
    new: int
    changed: int
    same: int
    extra: int
    conflicts: int
    files: tuple[PlannedFile, ...]
    """Conflicts, changed, extra and new files, the first 2,000."""
    notes: tuple[str, ...]
    restart: tuple[str, ...]
    """Files that count only after a restart."""
    undoes: bool
    """True if the upload holds the files that an earlier restore replaced."""


class ApplyRestore(Message):
    """Restore what was uploaded; `remove`: files that the backup doesn't have are deleted."""

    number: Annotated[str, Field(max_length=40)]
    digest: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    remove: bool


class Restored(Message):
    """What was restored; `undo` is the number of what undoes it, empty if nothing has changed."""

    written: int
    removed: int
    undo: str
    restart: tuple[str, ...]


class UndoRestore(Message):
    """The number of what a restore has replaced."""

    number: Annotated[str, Field(max_length=40)]
