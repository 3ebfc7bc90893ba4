"""Which files have changed, again and again."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from yarclang.cli.paths import SUFFIX, programs

_BESIDE = (SUFFIX, ".toml", ".urdf", ".csv")
"""What a program is made of besides itself: modules, cells, settings, robots, tables of way-points."""


def changes(paths: Sequence[str], pause: Callable[[], None]) -> Iterator[list[str]]:
    """The programs to check: at first all, then, behind each pause, those that have changed. Where something beside a program has changed, it
    counts as changed as well.

    Args:
        paths: files and folders, as on the command line.
        pause: waits a little.
    """
    seen: dict[str, dict[str, tuple[int, int]]] = {}
    while True:
        now = {file: _stamps(Path(file)) for file in programs(paths)}
        if changed := [file for file, stamps in now.items() if seen.get(file) != stamps]:
            yield changed
        seen = now
        pause()


def _stamps(file: Path) -> dict[str, tuple[int, int]]:
    """When each file that a program may be made of was written, and its size."""
    stamps: dict[str, tuple[int, int]] = {}
    beside = [file]
    with contextlib.suppress(OSError):
        beside += [one for one in file.parent.iterdir() if one.suffix.lower() in _BESIDE]
    for one in beside:
        try:
            state = one.stat()
        except OSError:
            continue
        stamps[one.name] = (state.st_mtime_ns, state.st_size)
    return stamps
