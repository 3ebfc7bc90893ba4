"""Compare a file with its new text, and encode the new text."""

from __future__ import annotations

import codecs
from difflib import unified_diff
from pathlib import Path

from yarclang.cli.outputs import STANDARD
from yarclang.source import SourceFile


def difference(path: str, before: str | None, after: str | None) -> str:
    """Return a unified diff. Its lines end with LF, whatever line ends the file has."""
    name = "<stdin>" if path == STANDARD else path
    old, new = (SourceFile(name, text or "").lines for text in (before, after))
    lines = unified_diff(old, new, name, name, lineterm="")
    return "".join(line + "\n" for line in lines)


def with_mark(path: Path, text: str) -> bytes:
    """Return a text as the bytes of a file, with a byte order mark if the file has one."""
    try:
        with path.open("rb") as file:
            marked = file.read(len(codecs.BOM_UTF8)) == codecs.BOM_UTF8
    except OSError:
        marked = False
    return codecs.BOM_UTF8 * marked + text.encode("utf-8")
