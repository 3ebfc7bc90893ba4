"""Versions of yarclang, its libraries and the operating system, for bug reports. They contain no names of
people, machines or folders.
"""

from __future__ import annotations

import platform
from functools import cache
from importlib import metadata
from pathlib import Path

from yarclang import __version__

_LIBRARIES = (
    "numpy",
    "scipy",
    "pin",
    "coal",
    "toppra",
    "ompl",
    "lark",
    "pydantic",
    "starlette",
    "uvicorn",
    "websockets",
    "mcap",
)


@cache
def versions() -> tuple[tuple[str, str], ...]:
    """Return pairs (name, version). Reads files: call it in a thread."""
    pairs = [("yarclang", __version__), ("Python", platform.python_version())]
    for name in _LIBRARIES:
        try:
            pairs.append((name, metadata.version(name)))
        except metadata.PackageNotFoundError:
            pairs.append((name, "not installed"))
    system = f"{platform.system()} {platform.release()} {platform.machine()}"
    return (*pairs, ("Operating system", f"{_distribution()}{system}"))


def _distribution() -> str:
    try:
        for line in Path("/etc/os-release").read_text("utf-8", "replace")[:10_000].splitlines():
            key, _, value = line.partition("=")
            if key == "PRETTY_NAME":
                return f"{value.strip().strip(chr(34))[:80]}, "
    except OSError:
        pass
    return ""
