"""Comparison of a backup with the project."""

from __future__ import annotations

import hashlib
import os
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field

from yarclang.pendant.backup.bounds import MANIFEST, MOST_FILES
from yarclang.pendant.backup.manifest import LeftOut, Manifest, manifest_of
from yarclang.pendant.backup.naming import Names
from yarclang.pendant.backup.reading import Entry, content, entries_of, refused
from yarclang.pendant.backup.writing import is_log
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.project.names import folded, quoted
from yarclang.pendant.project.tree import Entry as Here
from yarclang.runtime.actions import Trouble


@dataclass(frozen=True, slots=True)
class Judged:
    """A backup that has been checked and is safe to unpack.

    Attributes:
        files: files of the backup by their paths, without the manifest.
        folders: folders of the backup.
        hashes: SHA-256 of each unpacked file.
        manifest: list of the backup's files, from the zip; None if the zip has none.
        edited: files that differ from their entries in the manifest.
    """

    files: dict[str, Entry]
    folders: tuple[str, ...]
    hashes: dict[str, str]
    manifest: Manifest | None
    edited: tuple[str, ...]


def judged(handle: int) -> Judged:
    """Check an untrusted zip. All of its content is unpacked once, without writing anything to the disk.

    Args:
        handle: descriptor of the open file.

    Raises:
        Trouble: the zip is refused; the message names the file in the zip and the reason.
    """
    files: dict[str, Entry] = {}
    folders: list[str] = []
    hashes: dict[str, str] = {}
    manifest = None
    for entry in entries_of(handle, os.fstat(handle).st_size):
        if entry.is_folder:
            folders.append(entry.name)
        elif entry.name == MANIFEST:
            manifest = manifest_of(b"".join(content(handle, entry)))
        else:
            found = hashlib.sha256()
            for piece in content(handle, entry):
                found.update(piece)
            files[entry.name], hashes[entry.name] = entry, found.hexdigest()
    edited: tuple[str, ...] = ()
    if manifest is not None:
        known = {one.file: one.sha256 for one in manifest.files}
        edited = tuple(sorted(one for one in {*known, *hashes} if known.get(one) != hashes.get(one)))
    if not files and not (manifest and manifest.absent):
        raise refused("it has no files")
    return Judged(files, tuple(folders), hashes, manifest, edited)


@dataclass(frozen=True, slots=True)
class Plan:
    """Changes that the restore of a backup makes in the project.

    Attributes:
        new: files that are created.
        changed: files that are replaced.
        same: number of files that are equal in the backup and the project.
        extra: files of the project that were created after the backup; they are removed only on request.
        folders: empty folders that are created.
        conflicts: files that prevent the restore, with reasons.
        known: SHA-256 of the project's present files that the backup also contains, by path.
        sizes: sizes of the new, changed and extra files [bytes], by path. For a changed file this is the
            larger of its old and new size.
        digest: digest of the changes. It differs if the project has changed in a way that matters to the
            restore.
    """

    new: tuple[str, ...]
    changed: tuple[str, ...]
    same: int
    extra: tuple[str, ...]
    folders: tuple[str, ...]
    conflicts: tuple[LeftOut, ...]
    known: dict[str, str] = field(hash=False)
    sizes: dict[str, int] = field(hash=False)
    digest: str


def plan_of(folder: ProjectFolder, backup: Judged) -> Plan:
    """Compute the changes that a restore of a backup would make. Reads every file that is both in the project
    and in the backup.

    Args:
        folder: folder of the project.
        backup: backup to restore.

    Raises:
        Trouble: the project has too many files.
    """
    entries, cut = folder.entries(2 * MOST_FILES)
    if cut:
        raise Trouble(
            f"the project has more than {2 * MOST_FILES:,} files, or too many in one folder",
            "move files that aren't needed out of the project", "large",
        )  # fmt: skip
    present = {entry_after.file: entry_after for entry_after in entries}
    project = _Project(folder, present)
    new, changed, conflicts = [], [], []
    hashes: dict[str, str] = {}
    sizes: dict[str, int] = {}
    for name, entry in backup.files.items():
        file_now = present.get(name)
        reason = project.conflict(name)
        if reason:
            conflicts.append(LeftOut(file=name, why=reason))
            continue
        sizes[name] = entry.size
        if file_now is None:
            new.append(name)
            continue
        try:
            hashes[name] = folder.sha256(name)
        except Trouble as trouble:
            conflicts.append(LeftOut(file=name, why=trouble.what))
            continue
        if hashes[name] != backup.hashes[name]:
            if (folder.root / name).is_symlink():  # the target of the link may itself be a file of the backup
                conflicts.append(LeftOut(file=name, why="it is a link here"))
                continue
            changed.append(name)
            sizes[name] = max(entry.size, file_now.size)
    folders = []
    for name in backup.folders:
        reason = project.conflict(name, is_folder=True)
        if reason:
            conflicts.append(LeftOut(file=name, why=reason))
        elif name not in present:
            folders.append(name)
    extra = _extra(entries, backup)
    for entry_after in extra:
        sizes[entry_after.file] = entry_after.size
    same = (
        len(backup.files)
        - len(new)
        - len(changed)
        - sum(entry_after.file in backup.files for entry_after in conflicts)
    )
    return Plan(
        tuple(new),
        tuple(changed),
        same,
        tuple(entry_after.file for entry_after in extra),
        tuple(folders),
        tuple(conflicts),
        hashes,
        sizes,
        _digest(new, {name: hashes[name] for name in changed}, extra, backup),
    )


def _digest(new: list[str], changed: dict[str, str], extra: list[Here], backup: Judged) -> str:
    told = (sorted(new), sorted(changed.items()), sorted(one.file for one in extra))
    return hashlib.sha256(repr((told, sorted(backup.hashes.items()))).encode()).hexdigest()


def _extra(entries: tuple[Here, ...], backup: Judged) -> list[Here]:
    """Return the files of the project that were created after the backup. A restore may remove them. Files
    that are missing in the backup for another reason, such as run logs, aren't returned.
    """
    names = Names()
    for name in backup.files:
        names.add(name, folder=False)
    manifest = backup.manifest
    absent = frozenset(() if manifest is None else manifest.absent)
    left_out = frozenset(() if manifest is None else (entry.file for entry in manifest.left_out))
    has_logs = manifest is not None and manifest.head.logs
    is_part = manifest is not None and manifest.head.part
    spelled = Counter(folded(entry.file) for entry in entries)
    twins = {entry for entry, count in spelled.items() if count > 1}
    entries_after = []
    for entry in entries:
        if entry.is_folder or entry.file in backup.files:
            continue
        if not is_part and not twins.isdisjoint(map(folded, _ways(entry.file))):
            continue  # a backup can't contain names that look alike, so this removal couldn't be undone
        is_covered = has_logs or not is_log(entry.file)
        if entry.file in absent if is_part else is_covered and entry.file not in left_out:
            with suppress(Trouble):
                names.add(entry.file, folder=False)
                entries_after.append(entry)
    return entries_after


def _ways(name: str) -> Iterator[str]:
    """Yield the path of each folder that contains a file, and the path of the file itself."""
    parts = name.split("/")
    return ("/".join(parts[: count + 1]) for count in range(len(parts)))


class _Project:
    """The project at the time of a restore. Each folder is checked only once, because a folder may contain
    thousands of files.

    Args:
        folder: folder of the project.
        present: files and folders of the project, by path.
    """

    def __init__(self, folder: ProjectFolder, present: dict[str, Here]) -> None:
        self._folder = folder
        self._present = present
        self._spelled = {folded(one): one for one in present}
        self._known = {"": ("", True)}

    def conflict(self, name: str, *, is_folder: bool = False) -> str:
        """Return the reason why a file or folder of a backup can't be written to the project; empty if it
        can be.
        """
        reason, there = self._way(name.rpartition("/")[0])
        return reason or self._step(name, is_folder=is_folder, there=there)

    def _way(self, name: str) -> tuple[str, bool]:
        """Return two values: the reason why nothing can be written to a folder (empty if files can be
        written), and True if the folder exists.
        """
        if name not in self._known:
            reason = self.conflict(name, is_folder=True)
            self._known[name] = reason, name in self._present
        return self._known[name]

    def _step(self, name: str, *, is_folder: bool, there: bool) -> str:
        here = self._present.get(name)
        if here is not None:
            kind = "folder" if here.is_folder else "file"
            return "" if here.is_folder == is_folder else f"{quoted(name)} is a {kind} here"
        like = self._spelled.get(folded(name), name)
        if like != name:
            return f"it looks like {quoted(like)}, which is here"
        if there:
            try:
                path = self._folder.path(name)
            except Trouble as trouble:
                return trouble.what
            if os.path.lexists(path) or path != self._folder.root / name:
                return "an unlisted file or folder here has its name"
        return ""
