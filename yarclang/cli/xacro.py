"""Convert xacro files to URDF in a separate process, with bounded time and memory."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from yarclang.diagnostics import Diagnostic
from yarclang.source import SourceFile

LONGEST = 30.0
"""Time after which the process is killed [s]. Without a limit, a recursion in the file could run for ever."""

LARGEST = 20_000_000
"""Largest output [bytes]; the same limit applies to any URDF."""

MEMORY = 2_000_000_000
"""Largest memory of the process [bytes]."""


def expanded(path: Path, packages: Sequence[Path], given: Mapping[str, str]) -> SourceFile | Diagnostic:
    """Return the URDF of a xacro file.

    Args:
        path: path of the xacro file.
        packages: folders with the ROS packages that `$(find ...)` names.
        given: values of the file's arguments.
    """
    import json
    import subprocess
    from importlib.util import find_spec

    if find_spec("xacro") is None:
        remedy = (
            "Install it: pip install 'yarclang[xacro]'; or run xacro yourself and name the URDF that it "
            "writes."
        )
        return Diagnostic("Y1341", f"{path.name[:80]} is xacro, and xacro isn't installed.", help=remedy)
    # -P: import nothing from the current folder, which may be an untrusted archive
    arguments = [
        sys.executable,
        "-P",
        "-m",
        __name__,
        str(path),
        json.dumps(dict(given)),
        *map(str, packages),
    ]
    try:
        done = subprocess.run(
            arguments, capture_output=True, timeout=LONGEST, check=False, stdin=subprocess.DEVNULL
        )
    except subprocess.TimeoutExpired:
        message = f"xacro hasn't finished {path.name[:80]} within {LONGEST:g} s."
        return Diagnostic("Y1341", message, help="Look for a macro that calls itself.")
    if done.returncode:
        lines = [line for line in done.stderr.decode("utf-8", "replace").splitlines() if line.strip()]
        said = "".join(one if one.isprintable() else "?" for one in (lines or ["no word"])[-1])[:200]
        remedy = (
            "Correct the file, name the folders of its packages with --package-path, or give its arguments "
            "with --arg NAME=VALUE."
        )
        return Diagnostic("Y1341", f"xacro fails on {path.name[:80]}: {said}", help=remedy)
    if len(done.stdout) > LARGEST:
        message = f"xacro produces more than {LARGEST:,} bytes from {path.name[:80]}."
        return Diagnostic("Y1341", message, help="Look for a macro that repeats without end.")
    return SourceFile(str(path), done.stdout.decode("utf-8", "replace"))


def _child(path: str, given: str, packages: Sequence[str]) -> None:
    """Convert the xacro file in this separate process, and write the URDF to standard output."""
    import json
    import resource
    from types import ModuleType

    import xacro

    from yarclang.robot.new.packages import Packages

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    known = Packages(Path(path), map(Path, packages))

    def share(name: str) -> str:
        folder = known.folder(name)
        if folder is None:
            raise LookupError(f"the ROS package {name} wasn't found")
        return str(folder)

    # replace the modules by which xacro looks up packages, so that ROS isn't needed
    index, module = ModuleType("ament_index_python"), ModuleType("ament_index_python.packages")
    module.get_package_share_directory = share  # type: ignore[attr-defined]
    sys.modules |= {index.__name__: index, module.__name__: module}
    sys.stdout.buffer.write(
        xacro.process_file(path, mappings=json.loads(given)).toprettyxml(indent="  ").encode("utf-8")
    )


if __name__ == "__main__":
    _child(sys.argv[1], sys.argv[2], sys.argv[3:])
