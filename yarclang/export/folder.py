"""Write an exported package into a folder, without overwriting files of the user."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from yarclang.diagnostics import Diagnostic
from yarclang.export.package import Package
from yarclang.files import read_whole, reason_of, replace_file

LIST = "yarc-export.json"
"""Name of the file with the checksums of all files that an export has written."""
_LISTED = 5
_LARGEST_LIST = 10_000_000


def judged(folder: Path, package: Package, *, overwrite: bool) -> tuple[Diagnostic, ...]:
    """Return an error if a package would overwrite files of the user; empty if the package may be written.
    Files of the user are those in the folder that no export has written, and those that were changed after
    the export.

    Args:
        folder: the folder to write into.
        package: the package.
        overwrite: True to overwrite all files. If a folder or other non-file has the name of a file of the
            package, this remains an error.
    """
    try:
        return _judged(folder, package, overwrite=overwrite)
    except OSError as error:
        reason = reason_of(error)
        message = f"{folder} can't be read: {reason}"
        return (Diagnostic("Y0107", message, help="check the path and its permissions"),)


def _judged(folder: Path, package: Package, *, overwrite: bool) -> tuple[Diagnostic, ...]:
    if folder.exists() and not folder.is_dir():
        return (_error(folder, "it exists, but isn't a folder", "write elsewhere with -o"),)
    known = _known(folder)
    odd = [path for path in package.files if (folder / path).exists() and not (folder / path).is_file()]
    if odd:
        return (_error(folder, f"{_some(odd)} isn't a regular file", "write elsewhere with -o"),)
    foreign, changed = [], []
    for path in (*package.files, LIST):
        place = folder / path
        # A link without a target belongs to the user; writing to it would create its target.
        if overwrite or not (place.exists() or place.is_symlink()):
            continue
        if path == LIST:
            foreign += [path] * (known is None)
        elif known is None or path not in known:
            foreign.append(path)
        elif known[path] != _digest(place):
            changed.append(path)
    said = [
        f"{_some(paths)} {'was' if len(paths) == 1 else 'were'} {what}"
        for paths, what in (
            (foreign, "not written by an export"),
            (changed, "changed since the export that wrote it"),
        )
        if paths
    ]
    if not said:
        return ()
    help_ = "write elsewhere with -o, or replace them with --overwrite"
    return (_error(folder, "; ".join(said), help_),)


def write_folder(folder: Path, package: Package) -> tuple[Diagnostic, ...]:
    """Write a package into a folder. Files of an earlier export are removed if they are unchanged and no
    longer in the package.

    Returns:
        An error if a file can't be written; otherwise empty. After an error, the files before the failed one
        have been written, and the list of checksums contains the files of both exports.
    """
    known = _known(folder) or {}
    sums = {path: hashlib.sha256(data).hexdigest() for path, data in package.files.items()}
    # List the files before they are written. If the export fails, the next one then recognises all files that
    # this one has written.
    listed = json.dumps({"files": {**known, **sums}}, indent=1) + "\n"
    try:
        replace_file(folder / LIST, listed.encode())
        for path, data in package.files.items():
            replace_file(folder / path, data)
            if path in package.programs:
                _make_program(folder / path)
        for path in known.keys() - sums.keys():
            place = folder / path
            if ".." not in Path(path).parts and place.is_file() and _digest(place) == known[path]:
                place.unlink()
        replace_file(folder / LIST, (json.dumps({"files": sums}, indent=1) + "\n").encode())
    except OSError as error:
        reason = reason_of(error)
        where = error.filename or folder
        help_ = "check the path, its permissions and the free space on the disk, then export again"
        return (Diagnostic("Y0107", f"{where} can't be written: {reason}", help=help_),)
    return ()


def _make_program(path: Path) -> None:
    """Make a file executable for all users who are allowed to read it."""
    mode = path.stat().st_mode
    path.chmod(mode | (mode & 0o444) >> 2)


def _known(folder: Path) -> dict[str, str] | None:
    """Return the checksums of the files that an earlier export wrote; None if the folder has no readable list
    of them.
    """
    try:
        files = json.loads(read_whole(folder / LIST, _LARGEST_LIST))["files"]
        return {path: digest for path, digest in files.items() if isinstance(digest, str)}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""


def _error(folder: Path, what: str, help_: str) -> Diagnostic:
    return Diagnostic("Y1536", f"{folder}: {what}", help=help_)


def _some(paths: list[str]) -> str:
    more = f" and {len(paths) - _LISTED} more" if len(paths) > _LISTED else ""
    return f"{', '.join(paths[:_LISTED])}{more}"
