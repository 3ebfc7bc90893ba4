"""Look for changed files repeatedly."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from yarclang.cli.paths import SUFFIX, programs

_BESIDE = (SUFFIX, ".toml", ".urdf", ".csv")
"""Suffixes of the files that a program may use: modules, cells, settings, robots, tables of waypoints."""


def changes(paths: Sequence[str], pause: Callable[[], None]) -> Iterator[list[str]]:
    """Yield, again and again, the list of programs to check: first all of them, then, after each pause, those
    that have changed. A program also counts as changed if a file in its folder that it may use has changed.

    Args:
        paths: files and folders on the command line.
        pause: function that waits for a short time.
    """
    seen: dict[str, dict[str, tuple[int, int]]] = {}
    while True:
        now = {file: _stamps(Path(file)) for file in programs(paths)}
        if changed := [file for file, stamps in now.items() if seen.get(file) != stamps]:
            yield changed
        seen = now
        pause()


def _stamps(file: Path) -> dict[str, tuple[int, int]]:
    """Return the time and size of each file that a program may depend on."""
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
