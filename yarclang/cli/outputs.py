"""Find paths for output files, so that none overwrites a source or another output file."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import click

STANDARD = "-"


def beside(file: str, suffix: str, folder: Path | None = None) -> str:
    """Return the path of an output file: `file` with another suffix, in a folder or beside the original."""
    if file == STANDARD:
        return STANDARD if folder is None else str(folder / f"stdin{suffix}")
    path = Path(file)
    return str((path.parent if folder is None else folder) / f"{path.stem or 'program'}{suffix}")


def refuse_collisions(sources: Iterable[str], results: Iterable[tuple[str, str]]) -> None:
    """Reject output files that would overwrite a source or each other, as a usage error.

    Args:
        sources: the files that are read.
        results: path of each output file, and its source.
    """
    read = {_real(source): source for source in sources if source != STANDARD}
    taken: dict[str, str] = {}
    for path, made_of in results:
        if path == STANDARD or (os.path.exists(path) and not os.path.isfile(path)):  # noqa: PTH110, PTH113 (never raise)
            continue
        real = _real(path)
        if real in read:
            raise click.UsageError(f"{path} would overwrite the source {read[real]}; write elsewhere with -o")
        if real in taken:
            raise click.UsageError(f"{path} would be written twice: for {taken[real]} and for {made_of}")
        taken[real] = made_of


def _real(path: str) -> str:
    """Return the path of a file with all links resolved, so that all links to one file give the same path."""
    return os.path.realpath(path)
