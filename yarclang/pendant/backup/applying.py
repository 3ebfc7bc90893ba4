"""Restore of a backup. The project's files that will be replaced or removed are saved first. Then each
file is replaced as a whole.
"""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass

from yarclang.pendant.backup.comparing import Judged, Plan, plan_of
from yarclang.pendant.backup.reading import content, refused
from yarclang.pendant.backup.writing import About, Selection, zipped
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.project.names import quoted
from yarclang.pendant.project.places import in_words, said
from yarclang.pendant.project.room import check_room
from yarclang.pendant.project.tree import Entry
from yarclang.runtime.actions import Trouble


@dataclass(frozen=True, slots=True)
class Applied:
    """Result of a restore.

    Attributes:
        written: files of the project that were created or replaced.
        removed: files of the project that were removed.
        undo: number by which the trash finds the backup that undoes the restore; empty if the restore has
            changed nothing.
    """

    written: tuple[str, ...]
    removed: tuple[str, ...]
    undo: str


def apply(
    folder: ProjectFolder, handle: int, backup: Judged, digest: str, user: str, about: About, *, remove: bool
) -> Applied:
    """Restore a backup.

    Args:
        folder: folder of the project.
        handle: file descriptor of the open zip.
        backup: content of the zip, which has been checked.
        digest: digest of the list of changes that the user has seen.
        user: user who restores the backup.
        about: data about yarclang and the robot, for the backup of the files that are replaced or removed.
        remove: True to remove files of the project that were created after the backup.

    Raises:
        Trouble: the project has changed since the user saw the list, the disk has too little space, or a file
            can't be written. If files were changed already, the message tells how many, and how to undo this.
    """
    with folder.unchanged():
        plan = plan_of(folder, backup)
        if plan.digest != digest:
            raise Trouble(
                "files of the project have changed meanwhile", "review the changes again", "changed"
            )
        if plan.conflicts:
            first = plan.conflicts[0]
            raise Trouble(
                f"{quoted(first.file)} can't be restored: {first.why}", "rename or delete it first", ""
            )
        removed = plan.extra if remove else ()
        _check_room(folder, plan, backup, removed)
        undo = _keep_old(folder, plan, removed, user, about)
        done_so_far: list[str] = []
        try:
            with in_words(folder.root.name):
                _write(folder, handle, backup, plan, done_so_far)
                for name in removed:
                    _remove(folder, name)
                    done_so_far.append(name)
        except Trouble as trouble:
            total = len(plan.new) + len(plan.changed) + len(removed)
            what = (
                f"{len(done_so_far):,} of {total:,} files are restored, and the others are unchanged: "
                f"{trouble.what}"
            )
            raise Trouble(what, f"{trouble.remedy}; then restore it again, or undo this", "half") from None
    return Applied((*plan.new, *plan.changed), removed, undo)


def _check_room(folder: ProjectFolder, plan: Plan, backup: Judged, removed: tuple[str, ...]) -> None:
    wanted = sum(backup.files[one].size for one in (*plan.new, *plan.changed))
    wanted += sum(plan.sizes[one] for one in (*plan.changed, *removed))
    check_room(os.statvfs(folder.root), wanted, "the restored files and the copies for undo need")


def _keep_old(folder: ProjectFolder, plan: Plan, removed: tuple[str, ...], user: str, about: About) -> str:
    """Write a backup of the files that will be replaced or removed to the trash. Return the number of this
    backup in the trash; empty if the restore changes nothing.
    """
    if not plan.new and not plan.changed and not removed:
        return ""
    files = tuple(Entry(name, plan.sizes[name], "", is_folder=False) for name in (*plan.changed, *removed))
    selection = Selection(files, (), (), logs=True, absent=plan.new)
    stamp = about.made[:19].replace("T", " ").replace(":", ".")
    with in_words(folder.root.name), folder.trash.keeping(f"before restore {stamp}.zip", user) as keeping:
        for piece in zipped(folder, selection, about, strict=True):
            keeping.write(piece)
    return keeping.number


def _write(folder: ProjectFolder, handle: int, backup: Judged, plan: Plan, done_so_far: list[str]) -> None:
    for name in plan.folders:
        folder.make_folders(name)
    for name in (*plan.new, *plan.changed):
        entry = backup.files[name]
        if "/" in name:
            folder.make_folders(name.rpartition("/")[0])
        with folder.draft(name, entry.size) as draft:
            try:
                for piece in content(handle, entry):
                    draft.write(piece)
            except OSError as error:
                raise said(error, name) from None
            if draft.sha256 != backup.hashes[name]:
                raise refused(f"{quoted(name)} has changed since it was checked")
            folder.stand(draft, name, plan.known.get(name))
        done_so_far.append(name)


def _remove(folder: ProjectFolder, name: str) -> None:
    """Remove a file that has been saved, and the folders that are empty without it."""
    folder.remove_kept(name)
    parts = name.split("/")[:-1]
    with suppress(Trouble):
        while parts:
            folder.remove_empty("/".join(parts))
            parts.pop()
