"""Properties of the installed yarclang on which results depend in addition to the user's files: the package,
its library, the versions of other libraries, Python, and the kind of processor.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import sys
from pathlib import Path
from typing import NamedTuple

from yarclang.robot.library import stdlib_folder

_READ = (".py", ".lark", ".json", ".yarc", ".toml", ".urdf", ".stl", ".dae", ".obj")
"""Extensions of the files in the package and its library on which results depend."""


class Installation(NamedTuple):
    """Properties of the installed yarclang on which results depend.

    Attributes:
        version: version of yarclang.
        content: digest of the files of the package and its library.
        others: names and versions of the other libraries, in order.
        python: version of Python, and the kinds of processor and system.
    """

    version: str
    content: str
    others: tuple[str, ...]
    python: str

    @property
    def digest(self) -> str:
        """Return a digest of all properties."""
        return hashlib.sha256(json.dumps(self).encode()).hexdigest()

    def difference(self, other: Installation) -> str:
        """Return the first difference between another installation and this one, in words; empty if they
        don't differ.
        """
        if other.version != self.version:
            return f"it has yarclang {other.version}, but this computer has {self.version}"
        if other.python != self.python:
            return f"it has {other.python}, but this computer has {self.python}"
        if strange := sorted(set(other.others) ^ set(self.others)):
            name = strange[0].partition("-")[0]
            theirs, ours = (
                next((one for one in side if one.partition("-")[0] == name), f"no {name}")
                for side in (other.others, self.others)
            )
            return f"it has {theirs}, but this computer has {ours}"
        if other.content != self.content:
            return f"its files of yarclang {other.version} differ from those of this computer"
        return ""


def this_installation() -> Installation:
    """Return the installation in which this process runs. The files of the package are read."""
    from yarclang import __version__

    content = hashlib.sha256()
    for name, path in _files():
        content.update(f"{name}\0".encode())
        content.update(hashlib.sha256(path.read_bytes()).digest())
    machine = f"Python {platform.python_version()} on {platform.machine()} {sys.platform}"
    return Installation(__version__, content.hexdigest(), _libraries(), machine)


def stamp() -> str:
    """Return a value that changes when a file of the package is written, another library is installed, or
    Python changes. The files themselves aren't read.
    """
    found = [(name, seen.st_mtime_ns, seen.st_size, seen.st_ino) for name, seen in _stats()]
    machine = (platform.python_version(), platform.machine(), sys.platform)
    return hashlib.sha256(json.dumps((found, _libraries(), machine)).encode()).hexdigest()


def _files() -> list[tuple[str, Path]]:
    """Return the files of the package and its library as pairs (path relative to the package or the library,
    absolute path).
    """
    return [(name, Path(path)) for name, path in _walked()]


def _stats() -> list[tuple[str, os.stat_result]]:
    return [(name, os.stat(path)) for name, path in _walked()]  # noqa: PTH116 (a thousand files)


def _walked() -> list[tuple[str, str]]:
    found = []
    for folder in (str(Path(__file__).resolve().parents[1]), str(stdlib_folder())):
        for place, folders, names in os.walk(folder):
            folders[:] = [one for one in folders if one not in ("__pycache__", "bundles")]
            inside = os.path.relpath(place, folder)
            found += [(f"{inside}/{one}", f"{place}/{one}") for one in names if one.endswith(_READ)]
    return sorted(found)


def _libraries() -> tuple[str, ...]:
    """Return the installed libraries as `name-version`, in order."""
    found: set[str] = set()
    for folder in sys.path:
        try:
            names = os.listdir(folder or ".")  # noqa: PTH208 (names alone)
        except OSError:
            continue
        found.update(one.removesuffix(".dist-info") for one in names if one.endswith(".dist-info"))
    return tuple(sorted(one for one in found if not one.startswith("yarclang-")))
