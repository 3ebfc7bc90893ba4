"""A cell as text."""

from __future__ import annotations

from yarclang.cell.model import Cell


def cell_text(cell: Cell) -> str:
    """Return the line that names the cell that a robot keeps to: `cell: cell.toml`."""
    return f"cell: {cell.source.name}"
