"""Change files in place: all other bytes stay unchanged, including line ends."""

from __future__ import annotations

from pathlib import Path

from yarclang.files import reason_of, replace_file
from yarclang.runtime.actions import Trouble


def read_exactly(path: Path) -> str:
    """Return the text of a file with its line ends unchanged.

    Raises:
        Trouble: the file can't be read. The message has the reason.
    """
    try:
        return path.read_bytes().decode("utf-8")
    except OSError as error:
        raise Trouble(f"{path} can't be read: {reason_of(error)}", "nothing was changed") from None
    except UnicodeDecodeError:
        raise Trouble(f"{path} isn't UTF-8 text any more", "nothing was changed") from None


def write_exactly(path: Path, text: str) -> None:
    """Write a file's text completely or not at all.

    Raises:
        Trouble: the file can't be written. The message has the reason.
    """
    try:
        replace_file(path, text.encode("utf-8"))
    except OSError as error:
        raise Trouble(
            f"{path} can't be written: {reason_of(error)}", "check the access rights and the disk"
        ) from None
