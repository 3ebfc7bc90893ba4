"""Describe a cell as text."""

from __future__ import annotations

from pathlib import Path


def cell_text(name: str) -> str:
    """Return a line of text that names the cell.toml of a robot, relative to the working folder:
    `cell: cell.toml`.
    """
    path, here = Path(name), Path.cwd()
    return f"cell: {path.relative_to(here) if path.is_relative_to(here) else path}"
