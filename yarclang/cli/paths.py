"""Find the files that the paths on a command line mean."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

import click

from yarclang.cli.outputs import STANDARD

SUFFIX = ".yarc"


def programs(paths: Iterable[str]) -> list[str]:
    """Return the program files that a command reads, in order, each once. A folder means all .yarc files in
    it and its subfolders.

    Raises:
        click.UsageError: a folder has no such file.
    """
    found: dict[str, str] = {}
    for path in paths:
        if path == STANDARD or not os.path.isdir(path):  # noqa: PTH112 (Path.is_dir raises where a folder can't be searched)
            found.setdefault(path if path == STANDARD else os.path.realpath(path), path)
            continue
        inside = sorted(_inside(Path(path)))
        if not inside:
            raise click.UsageError(f"the folder {path} has no {SUFFIX} file")
        for one in inside:
            found.setdefault(os.path.realpath(one), one)
    return list(found.values())


def _inside(folder: Path) -> Iterator[str]:
    """Yield the programs in a folder, except those in hidden folders."""
    for root, folders, files in os.walk(folder):
        folders[:] = [one for one in folders if not one.startswith(".")]
        yield from (str(Path(root) / one) for one in files if one.lower().endswith(SUFFIX))
