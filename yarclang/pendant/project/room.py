"""Check of the free space on a disk. Some space stays reserved for run logs and the audit trail."""

from __future__ import annotations

import os

from yarclang.runtime.actions import Trouble

KEPT = 64 << 20
"""Space that stays free for run logs and the audit trail [bytes]."""


def check_room(disk: os.statvfs_result, size: int, subject: str) -> None:
    """Check that a disk has enough free space.

    Args:
        disk: state of the disk, as returned by `os.statvfs`.
        size: required space [bytes].
        subject: subject and verb of the error message before the size, such as "the backup has".

    Raises:
        Trouble: the disk has too little free space.
    """
    free = disk.f_bavail * disk.f_frsize
    if size + KEPT > free:
        raise Trouble(
            f"{subject} {size:,} bytes, but {free:,} are free on the disk, of which {KEPT:,} are "
            "reserved for logs",
            "make room on the disk", "",
        )  # fmt: skip
