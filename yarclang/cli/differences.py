"""How a file differs from what it would become, and how it is written back."""

from __future__ import annotations

import codecs
from difflib import unified_diff
from pathlib import Path

from yarclang.cli.outputs import STANDARD
from yarclang.source import SourceFile


def difference(path: str, before: str | None, after: str | None) -> str:
    """A unified diff; lines end with LF in it, whatever they end with in the file."""
    name = "<stdin>" if path == STANDARD else path
    old, new = (SourceFile(name, text or "").lines for text in (before, after))
    lines = unified_diff(old, new, name, name, lineterm="")
    return "".join(line + "\n" for line in lines)


def with_mark(path: Path, text: str) -> bytes:
    """A text as the bytes of a file that keeps its byte order mark, if it has one."""
    try:
        with path.open("rb") as file:
            marked = file.read(len(codecs.BOM_UTF8)) == codecs.BOM_UTF8
    except OSError:
        marked = False
    return codecs.BOM_UTF8 * marked + text.encode("utf-8")
