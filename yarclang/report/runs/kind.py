"""Which files are logs of runs."""

from __future__ import annotations

from pathlib import Path

MAGIC = b"\x89MCAP0\r\n"
"""What every MCAP file begins with."""


def is_log(path: str) -> bool:
    """Whether a file is the log of a run: it is called so, or begins so."""
    file = Path(path)
    if file.suffix.lower() == ".mcap":
        return True
    try:
        if not file.is_file():
            return False
        with file.open("rb") as stream:
            return stream.read(len(MAGIC)) == MAGIC
    except (OSError, ValueError):  # told of when it is read
        return False
