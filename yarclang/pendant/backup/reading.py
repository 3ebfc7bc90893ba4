"""Reader for untrusted zips. The structure of a zip is checked before anything is unpacked, and the unpacked
files are compared with the sizes and checksums in the zip's directory (its table of contents).

Only the layout that `writing` and common programs produce is accepted: the files one after the other without
gaps, then one directory, then the end record. So no two files can share bytes, no bytes are hidden, and the
directory agrees with the header of each file.
"""

from __future__ import annotations

import os
import stat
import struct
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

from yarclang.pendant.backup.bounds import (
    LARGEST_FILE,
    MANIFEST,
    MOST_BYTES,
    MOST_FILES,
    MOST_MANIFEST,
    RATIO,
    RATIO_FREE,
)
from yarclang.pendant.backup.naming import Names
from yarclang.pendant.project.names import MOST_PATH, quoted
from yarclang.runtime.actions import Trouble

STORED, DEFLATED = 0, 8

_END = struct.Struct("<4s4H2LH")
_CENTRAL = struct.Struct("<4s6H3L5H2L")
_LOCAL = struct.Struct("<4s5H3L2H")
_SIGNS = (b"PK\5\6", b"PK\1\2", b"PK\3\4", b"PK\7\x08")
_MOST_EXTRA = 2000
"""Largest total size of the extra fields and the comment of one entry in the directory [bytes]."""
_MOST_DIRECTORY = (MOST_FILES + 1) * (_CENTRAL.size + 200)
_ENCRYPTED = 0x0001 | 0x0040 | 0x2000
_PATCHED = 0x0020
_DESCRIBED, _UTF8 = 0x0008, 0x0800
_ZIP64, _OTHER_NAME = 0x0001, 0x7075
_PIECE = 1 << 16
_BREATH = 100
"""Number of directory entries after which the reading thread pauses briefly, so that it doesn't block the
loop that streams to the controller.
"""
_REMEDY = "restore a zip that System > Backup has made, or one made of its files by a common program"


@dataclass(frozen=True, slots=True)
class Entry:
    """A file or folder in a zip.

    Attributes:
        name: path in the zip, without a slash at its end.
        is_folder: True for a folder.
        method: `STORED` or `DEFLATED`.
        crc: CRC-32 of the unpacked content.
        packed: size of the content in the zip [bytes].
        size: size of the unpacked content [bytes].
        begins: offset of the content in the zip [bytes].
    """

    name: str
    is_folder: bool
    method: int
    crc: int
    packed: int
    size: int
    begins: int


@dataclass(frozen=True, slots=True)
class _Listed:
    """An entry of the zip's directory.

    Attributes:
        entry: the file or folder.
        raw: name of the file or folder, as the bytes in the zip.
        flags: general purpose bit flags of the entry.
        at: offset of the file's local header in the zip, as the directory states it [bytes].
    """

    entry: Entry
    raw: bytes
    flags: int
    at: int


def refused(problem: str) -> Trouble:
    """Return the exception for a zip that is refused."""
    return Trouble(f"this backup is refused: {problem}", _REMEDY, "hostile")


def entries_of(handle: int, size: int) -> tuple[Entry, ...]:
    """Check the structure of a zip and return its entries, including the manifest.

    Args:
        handle: descriptor of the open zip.
        size: size of the zip [bytes].

    Raises:
        Trouble: the structure of the zip is wrong; the message names the entry and the reason.
    """
    begins, rows = _directory(handle, size)
    names, listed, at = Names(), [], 0
    total = 0
    for count in range(rows.count):
        if count % _BREATH == _BREATH - 1:
            time.sleep(0.0005)
        row, at = _row(rows.data, at)
        if row.entry.name != MANIFEST or row.entry.is_folder:
            try:
                names.add(row.entry.name, folder=row.entry.is_folder)
            except Trouble as trouble:
                raise refused(trouble.what) from None
        elif row.entry.size > MOST_MANIFEST:
            raise refused(f"its list {MANIFEST} has more than {MOST_MANIFEST:,} bytes")
        total += row.entry.size
        if total > MOST_BYTES + MOST_MANIFEST:
            raise refused(f"its files have more than {MOST_BYTES:,} bytes together")
        listed.append(row)
    if at != len(rows.data):
        raise refused("its directory has bytes outside of all entries")
    if sum(row.entry.name == MANIFEST for row in listed) > 1:
        raise refused(f"its list {MANIFEST} exists twice")
    if total > RATIO_FREE + RATIO * size:
        raise refused(
            f"its {size:,} bytes would become {total:,}, but at most {RATIO} times as many are unpacked"
        )
    return _placed(handle, listed, begins)


@dataclass(frozen=True, slots=True)
class _Rows:
    """The bytes of the zip's directory, and the number of its entries according to the zip's end record."""

    data: bytes
    count: int


def _directory(handle: int, size: int) -> tuple[int, _Rows]:
    """Return the offset of the directory, and its bytes."""
    end = os.pread(handle, _END.size, max(0, size - _END.size))
    if len(end) < _END.size or end[:4] != _SIGNS[0]:
        raise refused("it isn't a zip, is truncated, or has data after its end")
    _, disk, first, here, count, length, begins, comment = _END.unpack(end)
    if 0xFFFF in (here, count) or 0xFFFFFFFF in (length, begins):
        raise refused("it is a zip64, which no backup of this size needs")
    if disk or first or here != count or comment:
        raise refused("it is a part of several, or has a comment")
    if count > MOST_FILES + 1:
        raise refused(f"it has {count:,} entries, but at most {MOST_FILES:,} are unpacked")
    if begins + length + _END.size != size:
        raise refused("its directory isn't at the position that its end record gives")
    if length > _MOST_DIRECTORY:
        raise refused(f"its directory has {length:,} bytes, but at most {_MOST_DIRECTORY:,} are read")
    data = os.pread(handle, length, begins)
    if len(data) != length:
        raise refused("it is truncated")
    return begins, _Rows(data, count)


def _row(data: bytes, at: int) -> tuple[_Listed, int]:
    """Return the row at an offset of the directory, and the offset of the next row."""
    if len(data) - at < _CENTRAL.size or data[at : at + 4] != _SIGNS[1]:
        raise refused("its directory is damaged, or has fewer entries than it says")
    fields = _CENTRAL.unpack_from(data, at)
    _, _, _, flags, method, _, _, crc, packed, size, named, extra, comment, disk, _, kind, place = fields
    at += _CENTRAL.size
    if named + extra + comment > len(data) - at:
        raise refused("its directory is truncated")
    raw = data[at : at + named]
    _check_extra(data[at + named : at + named + extra], raw)
    name = _named(raw, flags)
    is_folder = name.endswith("/")
    _check_kind(name, kind, flags, method, is_folder=is_folder)
    if disk or 0xFFFFFFFF in (packed, size, place):
        raise refused(f"{quoted(name)} is a zip64 entry, or lies in another part")
    if size > LARGEST_FILE:
        raise refused(f"{quoted(name)} has {size:,} bytes, but at most {LARGEST_FILE:,} are unpacked")
    if is_folder and (size or packed > 2):
        raise refused(f"the folder {quoted(name)} has a content")
    if method == STORED and packed != size:
        raise refused(f"{quoted(name)} isn't compressed, but has two sizes")
    entry = Entry(name.removesuffix("/"), is_folder, method, crc, packed, size, 0)
    return _Listed(entry, raw, flags, place), at + named + extra + comment


def _named(raw: bytes, flags: int) -> str:
    if len(raw) > MOST_PATH + 1:
        raise refused(f"a name has {len(raw)} bytes, but at most {MOST_PATH} are allowed")
    try:
        return raw.decode("utf-8" if flags & _UTF8 else "ascii")
    except UnicodeDecodeError:
        raise refused(f"the name {raw[:60]!r} isn't UTF-8, or isn't marked so") from None


def _check_kind(name: str, kind: int, flags: int, method: int, *, is_folder: bool) -> None:
    if flags & _ENCRYPTED:
        raise refused(f"{quoted(name)} is encrypted")
    if flags & _PATCHED or method not in (STORED, DEFLATED):
        raise refused(f"{quoted(name)} is compressed by method {method}, which isn't supported")
    sort = stat.S_IFMT(kind >> 16)
    if sort not in (0, stat.S_IFREG, stat.S_IFDIR):
        what = "a link" if sort == stat.S_IFLNK else "a device, a pipe or something else"
        raise refused(f"{quoted(name)} is {what}, not a file")
    if (sort == stat.S_IFDIR or bool(kind & 0x10)) != is_folder and (sort or kind & 0x10):
        raise refused(
            f"{quoted(name)} is a file by its name and a folder by its kind, or the other way round"
        )


def _check_extra(extra: bytes, raw: bytes) -> None:
    """Check that no extra field of an entry contains a second name or second sizes."""
    at = 0
    if len(extra) > _MOST_EXTRA:
        raise refused(f"{len(extra):,} extra bytes follow the name {raw[:60]!r}")
    while at + 4 <= len(extra):
        key, length = struct.unpack_from("<2H", extra, at)
        if key == _ZIP64:
            raise refused(f"{raw[:60]!r} is a zip64 entry, which no backup of this size needs")
        if key == _OTHER_NAME:
            raise refused(f"{raw[:60]!r} has a second name")
        at += 4 + length


def _placed(handle: int, listed: list[_Listed], end: int) -> tuple[Entry, ...]:
    """Return the zip's entries with the offsets of their contents. Check that the entries fill the zip
    without gaps from the zip's beginning to its directory.
    """
    placed, at = [], 0
    for row in sorted(listed, key=lambda one: one.at):
        if row.at != at:
            problem = (
                "shares bytes with another entry" if row.at < at else "follows bytes outside of all entries"
            )
            raise refused(f"{quoted(row.entry.name)} {problem}")
        begins = _begins(handle, row)
        at = begins + row.entry.packed
        if at > end:
            raise refused(f"{quoted(row.entry.name)} has more bytes than the file")
        if row.flags & _DESCRIBED:
            at += _described(handle, row, at)
        placed.append(
            Entry(
                row.entry.name, row.entry.is_folder, row.entry.method, row.entry.crc, row.entry.packed,
                    row.entry.size, begins
            )
        )  # fmt: skip
    if at != end:
        raise refused("it has bytes before its directory, outside of all entries")
    return tuple(placed)


def _begins(handle: int, row: _Listed) -> int:
    """Return the offset of an entry's content."""
    name = quoted(row.entry.name)
    head = os.pread(handle, _LOCAL.size, row.at)
    if len(head) != _LOCAL.size or head[:4] != _SIGNS[2]:
        raise refused(f"{name} isn't where the directory says")
    _, _, flags, method, _, _, crc, packed, size, named, extra = _LOCAL.unpack(head)
    more = os.pread(handle, named + extra, row.at + _LOCAL.size)
    if len(more) != named + extra or more[:named] != row.raw:
        raise refused(f"{name} has another name in its local header")
    _check_extra(more[named:], row.raw)
    entry = row.entry
    known = (entry.crc, entry.packed, entry.size)
    sizes = {known, (0, 0, 0)} if flags & _DESCRIBED else {known}
    if (flags, method) != (row.flags, entry.method) or (crc, packed, size) not in sizes:
        raise refused(f"{name} has another size or kind in its local header than in the directory")
    length: int = named + extra
    return row.at + _LOCAL.size + length


def _described(handle: int, row: _Listed, at: int) -> int:
    """Check the data descriptor after the content of a file, which repeats the checksum and sizes. Return the
    length of the descriptor [bytes].
    """
    entry = row.entry
    told = struct.pack("<3L", entry.crc, entry.packed, entry.size)
    after = os.pread(handle, 16, at)
    for length, wanted in ((16, _SIGNS[3] + told), (12, told)):
        if after[:length] == wanted:
            return length
    raise refused(f"{quoted(entry.name)} has another size after its content than in the directory")


def content(handle: int, entry: Entry) -> Iterator[bytes]:
    """Yield the unpacked content of a file as pieces of bytes. The pieces together are never longer than the
    size that the zip's directory states.

    Args:
        handle: descriptor of the open zip.
        entry: the file in the zip.

    Raises:
        Trouble: the content doesn't have the size or checksum that the entry states.
    """
    unpacking = None if entry.method == STORED else zlib.decompressobj(-15)
    at, bytes_left, size, crc = entry.begins, entry.packed, 0, 0
    unread = b""
    while True:
        if not unread and bytes_left:
            unread = os.pread(handle, min(_PIECE, bytes_left), at)
            if not unread:
                raise _differs(entry)
            at, bytes_left = at + len(unread), bytes_left - len(unread)
        if unpacking is None:
            piece, unread = unread, b""
        else:
            try:
                piece = unpacking.decompress(unread, _PIECE)
            except zlib.error:
                raise _differs(entry) from None
            unread = unpacking.unconsumed_tail
        size += len(piece)
        if size > entry.size:
            raise _differs(entry)
        crc = zlib.crc32(piece, crc)
        if piece:
            yield piece
        elif not unread and not bytes_left:
            break
    is_whole = unpacking is None or (unpacking.eof and not unpacking.unused_data)
    if size != entry.size or crc != entry.crc or not is_whole:
        raise _differs(entry)


def _differs(entry: Entry) -> Trouble:
    return refused(
        f"{quoted(entry.name)} isn't the {entry.size:,} bytes that the directory claims, or is damaged"
    )
