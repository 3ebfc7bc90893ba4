"""Detect run logs."""

from __future__ import annotations

from pathlib import Path

MAGIC = b"\x89MCAP0\r\n"
"""First bytes of every MCAP file."""


def is_log(path: str) -> bool:
    """Return True if a file is the log of a run, by its name or its first bytes."""
    file = Path(path)
    if file.suffix.lower() == ".mcap":
        return True
    try:
        if not file.is_file():
            return False
        with file.open("rb") as stream:
            return stream.read(len(MAGIC)) == MAGIC
    except (OSError, ValueError):  # reported when it is read
        return False
