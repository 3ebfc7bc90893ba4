"""Large meshes that were prepared before, in the user's cache folder: reading and sorting a million triangles
takes seconds, reading the result a fraction of that.

An entry is named after the content of the mesh's file (SHA-256), so that a file that has changed is prepared
anew. It is signed: an entry that is damaged, or that somebody else has made, is prepared anew as well. Without a
folder that can be written, nothing is kept.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from yarclang.files import cache_folder, replace_file
from yarclang.frozen import frozen
from yarclang.signing import SIZE, is_signed, own_secret, signature

MOST_BYTES = 1_000_000_000
"""Size of all entries together [bytes]; beyond it, those that were used least lately are removed."""
_MAGIC = b"yarclang mesh 1\n"
_SUFFIX = ".mesh"
_HEAD = np.dtype([("corners", np.int64), ("faces", np.int64), ("closed", np.int64)])


@frozen(eq=False)
class Prepared:
    """A mesh without equal corners.

    Attributes:
        corners: (V, 3) [m].
        faces: (T, 3) the corners of each triangle, in an order in which neighbours are near each other.
        closed: True if the triangles enclose a volume.
    """

    corners: NDArray[np.float64]
    faces: NDArray[np.int64]
    closed: bool


def kept(key: str, make: Callable[[], Prepared | None]) -> Prepared | None:
    """Return a prepared mesh: the one that was kept under a key, or else the one that `make` returns.

    Args:
        key: names all on which the result depends.
        make: prepares the mesh; None is handed on, and not kept.
    """
    cache, secret = cache_folder(), own_secret()
    if cache is None or secret is None:
        return make()
    folder = cache / "meshes"
    path = folder / (hashlib.sha256(key.encode()).hexdigest() + _SUFFIX)
    found = _read(path, key, secret)
    if found is not None:
        with suppress(OSError):
            os.utime(path)  # it was used lately
        return found
    made = make()
    if made is not None:
        with suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            replace_file(path, _entry(key, made, secret))
            _remove_old(folder, path)
    return made


def _entry(key: str, mesh: Prepared, secret: bytes) -> bytes:
    head = np.array([(len(mesh.corners), len(mesh.faces), mesh.closed)], dtype=_HEAD)
    payload = b"".join(
        (head.tobytes(), mesh.corners.astype("<f8").tobytes(), mesh.faces.astype("<i4").tobytes())
    )
    return _MAGIC + signature(secret, (key.encode(), payload)) + payload


def _read(path: Path, key: str, secret: bytes) -> Prepared | None:
    """Return the mesh of an entry; None if it is missing, damaged, or signed for another key or by another user."""
    if not path.is_file():  # nor anything that could block
        return None
    try:
        content = memoryview(path.read_bytes())
    except OSError:
        return None
    begin = len(_MAGIC) + SIZE
    if content[: len(_MAGIC)] != _MAGIC or len(content) < begin + _HEAD.itemsize:
        return None
    payload = content[begin:]
    if not is_signed(content[len(_MAGIC) : begin], secret, (key.encode(), payload)):
        return None
    head = np.frombuffer(payload, _HEAD, 1)[0]
    count, size = int(head["corners"]), int(head["faces"])
    at = _HEAD.itemsize + 24 * count
    if count < 1 or size < 1 or len(payload) != at + 12 * size:
        return None
    corners = np.frombuffer(payload, "<f8", 3 * count, _HEAD.itemsize).reshape(-1, 3)
    faces = np.frombuffer(payload, "<i4", 3 * size, at).astype(np.int64).reshape(-1, 3)
    if faces.min() < 0 or faces.max() >= count:
        return None
    return Prepared(corners, faces, bool(head["closed"]))


def _remove_old(folder: Path, newest: Path) -> None:
    """Remove what was used least lately, down to `MOST_BYTES`, but not the newest entry. Files that a killed
    process has left half written count as well.
    """
    found = []
    for path in folder.iterdir():
        with suppress(OSError):  # another process may have removed it
            known = path.stat()
            found.append((known.st_mtime_ns, known.st_size, path))
    size = sum(one for _, one, _ in found)
    for _, one, path in sorted(found, key=lambda row: row[0]):
        if size <= MOST_BYTES:
            break
        if path != newest:
            path.unlink(missing_ok=True)
            size -= one
