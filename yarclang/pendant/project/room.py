"""Room on a disk, of which some is kept for logs."""

from __future__ import annotations

import os

from yarclang.runtime.actions import Trouble

KEPT = 64 << 20
"""Room that stays free for run logs and the audit trail [bytes]."""


def check_room(disk: os.statvfs_result, size: int, what: str) -> None:
    """Check that a disk has room.

    Args:
        disk: which, as the operating system tells it.
        size: what is needed [bytes].
        what: what needs it, with its verb: "the backup has".

    Raises:
        Trouble: there is too little.
    """
    free = disk.f_bavail * disk.f_frsize
    if size + KEPT > free:
        raise Trouble(
            f"{what} {size:,} bytes, and {free:,} are free on the disk, of which {KEPT:,} are kept for logs",
            "make room on the disk", "",
        )  # fmt: skip
