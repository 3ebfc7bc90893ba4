"""Cache of prepared large meshes, and of meshes that were divided into convex pieces, in the user's cache
folder. To read and sort a million triangles takes seconds; to read the cached result takes a fraction of
that.

An entry is named after the content of the mesh's file (SHA-256), so that a file that has changed is prepared
again. Entries are signed: an entry that is damaged, or that another user has made, is prepared again as well.
If no folder can be written, nothing is cached.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from yarclang.files import cache_folder, replace_file
from yarclang.frozen import frozen
from yarclang.meshes.pieces import MOST_PIECES, Piece
from yarclang.signing import SIZE, is_signed, own_secret, signature

MOST_BYTES = 1_000_000_000
"""Largest size of all entries together [bytes]. If they are larger, the least recently used ones are
removed.
"""
_MAGIC = b"yarclang mesh 1\n"
_SUFFIX = ".mesh"
_HEAD = np.dtype([("corners", np.int64), ("faces", np.int64), ("closed", np.int64)])
_OF_PIECE = np.dtype([("low", "<f8", 3), ("high", "<f8", 3), ("corners", np.int64)])

T = TypeVar("T")


@frozen(eq=False)
class Prepared:
    """A mesh in which equal corners are merged.

    Attributes:
        corners: (V, 3) [m].
        faces: (T, 3) the corners of each triangle, in an order in which neighbours are near each other.
        closed: True if the triangles enclose a volume.
    """

    corners: NDArray[np.float64]
    faces: NDArray[np.int64]
    closed: bool


def kept(key: str, make: Callable[[], Prepared | None]) -> Prepared | None:
    """Return the prepared mesh that belongs to a key: from the cache, or else by calling `make`.

    Args:
        key: contains everything on which the prepared mesh depends.
        make: function that prepares the mesh. If it returns None, None is returned and nothing is cached.
    """
    return _kept(key, make, _written, _mesh)


def kept_pieces(key: str, make: Callable[[], tuple[Piece, ...] | None]) -> tuple[Piece, ...] | None:
    """Return the convex pieces of a mesh, cached as by `kept`."""
    return _kept(key, make, _written_pieces, _pieces)


def _kept(
    key: str,
    make: Callable[[], T | None],
    written: Callable[[T], bytes],
    read: Callable[[memoryview], T | None],
) -> T | None:
    cache, secret = cache_folder(), own_secret()
    if cache is None or secret is None:
        return make()
    folder = cache / "meshes"
    path = folder / (hashlib.sha256(key.encode()).hexdigest() + _SUFFIX)
    payload = _payload(path, key, secret)
    found = None if payload is None else read(payload)
    if found is not None:
        with suppress(OSError):
            os.utime(path)  # marks the entry as recently used
        return found
    made = make()
    if made is not None:
        with suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            replace_file(path, _entry(key, written(made), secret))
            _remove_old(folder, path)
    return made


def _entry(key: str, payload: bytes, secret: bytes) -> bytes:
    return _MAGIC + signature(secret, (key.encode(), payload)) + payload


def _payload(path: Path, key: str, secret: bytes) -> memoryview | None:
    """Return the content of a cache entry; None if the entry is missing, damaged, or signed for another key
    or by another user.
    """
    if not path.is_file():  # missing, or a file such as a pipe that could block
        return None
    try:
        content = memoryview(path.read_bytes())
    except OSError:
        return None
    begin = len(_MAGIC) + SIZE
    if content[: len(_MAGIC)] != _MAGIC or len(content) < begin:
        return None
    payload = content[begin:]
    return payload if is_signed(content[len(_MAGIC) : begin], secret, (key.encode(), payload)) else None


def _written(mesh: Prepared) -> bytes:
    head = np.array([(len(mesh.corners), len(mesh.faces), mesh.closed)], dtype=_HEAD)
    return b"".join(
        (head.tobytes(), mesh.corners.astype("<f8").tobytes(), mesh.faces.astype("<i4").tobytes())
    )


def _mesh(payload: memoryview) -> Prepared | None:
    """Return the mesh in a cache entry; None if the entry contains no mesh."""
    if len(payload) < _HEAD.itemsize:
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


def _written_pieces(pieces: tuple[Piece, ...]) -> bytes:
    head = np.array([(one.low, one.high, len(one.corners)) for one in pieces], dtype=_OF_PIECE)
    corners = (one.corners.astype("<f8").tobytes() for one in pieces)
    return b"".join((len(pieces).to_bytes(8, "little"), head.tobytes(), *corners))


def _pieces(payload: memoryview) -> tuple[Piece, ...] | None:
    """Return the convex pieces in a cache entry; None if the entry contains no pieces."""
    count = int.from_bytes(payload[:8], "little")
    begin = 8 + count * _OF_PIECE.itemsize
    if not 1 <= count <= MOST_PIECES or len(payload) < begin:
        return None
    head = np.frombuffer(payload, _OF_PIECE, count, 8)
    sizes = head["corners"]
    if sizes.min() < 1 or sizes.max() > len(payload) or len(payload) != begin + 24 * int(sizes.sum()):
        return None
    corners = np.frombuffer(payload, "<f8", 3 * int(sizes.sum()), begin).reshape(-1, 3)
    parts = np.split(corners, np.cumsum(sizes)[:-1])
    return tuple(Piece(one["low"], one["high"], part) for one, part in zip(head, parts, strict=True))


def _remove_old(folder: Path, newest: Path) -> None:
    """Remove the least recently used cache entries until at most `MOST_BYTES` are left; the newest entry is
    kept. Half-written files of a process that was killed count as entries.
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
