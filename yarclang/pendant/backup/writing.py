"""Writer of backups. It produces the zip as pieces of bytes: neither a whole file nor the whole zip is
ever in memory.
"""

from __future__ import annotations

import hashlib
import os
import stat
import zipfile
from collections.abc import Generator
from dataclasses import dataclass
from datetime import datetime

from yarclang.pendant.backup.bounds import LARGEST_FILE, MANIFEST, MOST_BYTES, MOST_FILES
from yarclang.pendant.backup.manifest import FORMAT, Head, LeftOut, ListedFile, Manifest
from yarclang.pendant.backup.naming import Names
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.project.names import quoted
from yarclang.pendant.project.tree import Entry, moment
from yarclang.runtime.actions import Trouble

LOGS = ".mcap"
"""File name extension of run logs."""

_PIECE = 1 << 18
_LARGEST_DEFLATED = 32_000_000
"""Size above which a file is stored uncompressed [bytes]. Such large files are mostly logs and meshes."""
_MUCH, _RATIO = 50_000_000, 50
"""Limit on compression, which keeps every backup within the limits that a restore checks. If the files that
are already in the zip have an unpacked size of more than `_MUCH` [bytes] plus `_RATIO` times the size of the
zip, the next file is stored uncompressed.
"""
_EARLIEST = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class About:
    """Data about yarclang and the robot for the head of a backup's manifest.

    Attributes:
        yarclang: version of yarclang.
        robot: name of the robot.
        fingerprint: fingerprint of the robot.
        made: time of the backup (ISO 8601, UTC).
    """

    yarclang: str
    robot: str
    fingerprint: str
    made: str


@dataclass(frozen=True, slots=True)
class Selection:
    """Files that a backup will contain.

    Attributes:
        files: files of the project.
        folders: empty folders.
        left_out: files that can't be included, with the reasons.
        logs: True if logs of runs are included.
        skipped: run logs that are left out on request.
        absent: for the backup that undoes a restore, the files that the restore will create; None for a
            backup of the whole project.
    """

    files: tuple[Entry, ...]
    folders: tuple[str, ...]
    left_out: tuple[LeftOut, ...]
    logs: bool
    skipped: tuple[Entry, ...] = ()
    absent: tuple[str, ...] | None = None

    @property
    def size(self) -> int:
        """Size of all files [bytes]."""
        return sum(one.size for one in self.files)


def is_log(name: str) -> bool:
    """Return True if a file name is that of a run log."""
    return name.lower().endswith(LOGS)


def selected(folder: ProjectFolder, *, logs: bool) -> Selection:
    """Return the files that a backup of a project will contain.

    Args:
        folder: folder of the project.
        logs: True to include logs of runs.

    Raises:
        Trouble: the project exceeds the limits on a backup's size.
    """
    entries, cut = folder.entries(MOST_FILES)
    if cut:
        raise Trouble(
            f"the project has more than {MOST_FILES:,} files, or too many in one folder for a backup",
            "move files that aren't needed out of the project, or copy the folder on the computer "
            "itself", "large",
        )  # fmt: skip
    names = Names()
    files: list[Entry] = []
    folders: list[Entry] = []
    left_out: list[LeftOut] = []
    skipped: list[Entry] = []
    for entry in entries:
        if is_log(entry.file) and not logs and not entry.is_folder:
            skipped.append(entry)
            continue
        try:
            if entry.size > LARGEST_FILE:
                what = f"it has {entry.size:,} bytes, but at most {LARGEST_FILE:,} are backed up"
                raise Trouble(what, "", "")
            if (folder.root / entry.file).is_symlink():
                raise Trouble("it is a link: its target is backed up under the target's name", "", "")
            names.add(entry.file, folder=entry.is_folder)
        except Trouble as trouble:
            left_out.append(LeftOut(file=entry.file[:1000], why=trouble.what))
            continue
        (folders if entry.is_folder else files).append(entry)
    used = {"/".join(entry.file.split("/")[:-1]) for entry in (*files, *folders, *skipped)}
    selection = Selection(
        tuple(files),
        tuple(entry.file for entry in folders if entry.file not in used),
        tuple(left_out),
        logs,
        tuple(skipped),
    )
    if selection.size > MOST_BYTES:
        raise Trouble(
            f"the project has {selection.size:,} bytes, but a backup may have at most {MOST_BYTES:,}",
            "exclude the logs of runs, or copy the folder on the computer itself", "large",
        )  # fmt: skip
    return selection


class _Sink:
    """Output for a zip that is written front to back. Unlike a file, it can't be rewound."""

    def __init__(self) -> None:
        self.size = 0
        self._pieces: list[bytes] = []

    def write(self, data: bytes) -> int:
        self._pieces.append(bytes(data))
        self.size += len(data)
        return len(data)

    def flush(self) -> None:
        """Do nothing, because nothing is buffered."""

    def taken(self) -> bytes:
        """Return and clear the collected bytes."""
        found = b"".join(self._pieces)
        self._pieces.clear()
        return found


def zipped(
    folder: ProjectFolder, selection: Selection, about: About, *, strict: bool = False
) -> Generator[bytes]:
    """Yield the bytes of a backup's zip, piece by piece. This waits for the disk: compute each piece in a
    thread.

    Args:
        folder: folder of the project.
        selection: files for the backup. A file that is gone or can't be read is left out, and the manifest
            says so.
        about: data about yarclang and the robot for the manifest.
        strict: True to fail if a file can't be read, or changes while it is read.

    Raises:
        Trouble: `strict` is true, and a file can't be read or has changed.
    """
    sink = _Sink()
    listed: list[ListedFile] = []
    left_out = [*selection.left_out]
    read = 0
    with zipfile.ZipFile(sink, "w") as archive:  # type: ignore[call-overload]  # it needs `write` alone
        for name in selection.folders:
            archive.writestr(_info(f"{name}/", stat.S_IFDIR | 0o755), b"")
        for file in selection.files:
            try:
                row = yield from _added(folder, file.file, archive, sink, MOST_BYTES - read)
                read += row.size
                listed.append(row)
                if strict and row.changing:
                    raise Trouble(f"{quoted(file.file)} is being changed, or is too large", "try again", "")
            except Trouble as trouble:
                if strict:
                    raise
                left_out.append(LeftOut(file=file.file, why=trouble.what))
        head = Head(
            format=FORMAT,
            yarclang=about.yarclang,
            robot=about.robot,
            fingerprint=about.fingerprint,
            made=about.made,
            logs=selection.logs,
            part=selection.absent is not None,
        )
        manifest = Manifest(head, tuple(listed), tuple(left_out[:MOST_FILES]), selection.absent or ())
        info = _info(MANIFEST, stat.S_IFREG | 0o644, about.made)
        info.compress_type = zipfile.ZIP_DEFLATED
        archive.writestr(info, b"".join(manifest.lines()))
    yield sink.taken()


def _added(
    folder: ProjectFolder, name: str, archive: zipfile.ZipFile, sink: _Sink, most: int
) -> Generator[bytes, None, ListedFile]:
    """Add a file to a zip, and yield the new bytes of the zip. The generator's return value is the file's
    entry for the manifest.

    Args:
        folder: folder of the project.
        name: path of the file in the project.
        archive: the zip.
        sink: output to which the zip is written.
        most: largest number of bytes that are read from the file.
    """
    with folder.opened(name) as (handle, status, _):
        info = _info(name, stat.S_IFREG | 0o644, moment(status.st_mtime))
        info.file_size = size = min(status.st_size, LARGEST_FILE, most)
        if size <= _LARGEST_DEFLATED and MOST_BYTES - most <= _MUCH + _RATIO * sink.size:
            info.compress_type = zipfile.ZIP_DEFLATED
        digest, count = hashlib.sha256(), 0
        with archive.open(info, "w") as target:
            while count < size and (data := os.read(handle, min(_PIECE, size - count))):
                digest.update(data)
                count += len(data)
                target.write(data)
                yield sink.taken()
        after = os.fstat(handle)
    before = (status.st_mtime_ns, status.st_size, status.st_size)
    changing = (after.st_mtime_ns, after.st_size, count) != before
    return ListedFile(file=name, size=count, sha256=digest.hexdigest(), changing=changing)


def _info(name: str, mode: int, changed: str = "") -> zipfile.ZipInfo:
    moment = _EARLIEST
    if changed and (at := datetime.fromisoformat(changed).timetuple()[:6]) > _EARLIEST and at[0] < 2100:
        moment = at
    info = zipfile.ZipInfo(name, moment)
    info.create_system = 3
    info.external_attr = mode << 16 | (0x10 if stat.S_ISDIR(mode) else 0)
    return info
