"""Measurements of disks, memory and load. Values that the operating system doesn't provide are None. The
functions wait for the disk: call them in a thread.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

_MOST_SEEN = 100_000
"""Largest number of files of which the total size is computed."""
_PROC = Path("/proc")


@dataclass(frozen=True, slots=True)
class Disk:
    """A disk that contains files of the pendant.

    Attributes:
        holds: kinds of the pendant's files that are on the disk, in words.
        free: free space [bytes].
        total: size of the disk [bytes].
    """

    holds: str
    free: int
    total: int


@dataclass(frozen=True, slots=True)
class Machine:
    """Measured state of the computer and of this process at one moment. A value that the operating system
    doesn't provide is None.

    Attributes:
        disks: disks that hold files of the pendant.
        own: memory that this process uses [bytes].
        peak: largest memory that this process has used since its start [bytes].
        available: available memory of the computer [bytes].
        memory: all memory of the computer [bytes].
        load: average number of processes that wanted a processor in the last minute, per processor.
        cpu: processor time that this process has used since its start [s].
    """

    disks: tuple[Disk, ...]
    own: int | None
    peak: int | None
    available: int | None
    memory: int | None
    load: float | None
    cpu: float


def machine(places: Iterable[tuple[str, Path]]) -> Machine:
    """Measure the computer and this process.

    Args:
        places: folders with files of the pendant, whose disks are measured, as pairs (description, path).
            Missing folders are ignored.
    """
    own_table = _table(_PROC / "self" / "status")
    whole = _table(_PROC / "meminfo")
    return Machine(
        disks_of(places),
        own_table.get("VmRSS"),
        own_table.get("VmHWM"),
        whole.get("MemAvailable"),
        whole.get("MemTotal"),
        _load(),
        time.process_time(),
    )


def disks_of(places: Iterable[tuple[str, Path]]) -> tuple[Disk, ...]:
    """Return the disks that contain the given folders (description, path). If a disk contains several of the
    folders, it is returned once, with all their descriptions.
    """
    by_device: dict[int, list[str]] = {}
    rooms: dict[int, tuple[int, int]] = {}
    for name, place in places:
        try:
            device, told = place.stat().st_dev, shutil.disk_usage(place)
        except OSError:
            continue
        by_device.setdefault(device, []).append(name)
        rooms[device] = (told.free, told.total)
    return tuple(Disk(_joined(names), *rooms[device]) for device, names in by_device.items())


def _joined(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def size_of(folder: Path) -> int | None:
    """Return the size of all files in a folder [bytes], without following links; None if the folder
    contains more than `_MOST_SEEN` files.
    """
    total, entries_seen = 0, 0
    for top, _, files in os.walk(folder):
        for name in files:
            entries_seen += 1
            if entries_seen > _MOST_SEEN:
                return None
            if entries_seen % 200 == 0:
                time.sleep(0.0005)  # leave the interpreter to the loop that streams
            try:
                total += os.lstat(f"{top}/{name}").st_size
            except OSError:
                continue
    return total


def sizes_of(*files: Path) -> int:
    """Return the total size of files [bytes]. Missing files count as empty."""
    total = 0
    for one in files:
        try:
            total += one.stat().st_size
        except OSError:
            continue
    return total


def _load() -> float | None:
    try:
        return os.getloadavg()[0] / (os.cpu_count() or 1)
    except (OSError, AttributeError):
        return None


def _table(path: Path) -> dict[str, int]:
    """Return the memory sizes [bytes] that a file of /proc lists, by their names; empty if there is no
    such file.
    """
    sizes = {}
    try:
        for line in path.read_text("ascii", "replace").splitlines():
            name, _, rest = line.partition(":")
            words = rest.split()
            if len(words) == 2 and words[1] == "kB" and words[0].isdigit():
                sizes[name] = int(words[0]) * 1024
    except OSError:
        return {}
    return sizes
