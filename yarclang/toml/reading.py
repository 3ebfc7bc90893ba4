"""Read TOML files: decode bytes to a text and its data, or return one finding."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from yarclang.consulted import is_folder
from yarclang.diagnostics import Diagnostic
from yarclang.files import read_whole
from yarclang.source import SourceFile, Span

_LARGEST_FILE = 20_000_000


def read_text(path: Path, remedy: str) -> SourceFile | Diagnostic:
    """Return the text of a file, or a finding. The finding has a position only if it is about the content of
    the file.

    Args:
        path: the file.
        remedy: help of the finding for a file that can't be read.
    """
    name = (path.name or str(path))[:80]
    try:
        if is_folder(path):
            return Diagnostic("Y1302", f"{name} is a folder, not a file.", help=remedy)
        content = read_whole(path, _LARGEST_FILE)
    except OSError as error:
        reason = error.strerror or str(error)
        return Diagnostic("Y1302", f"{str(path)[-200:]!r} can't be read: {reason}.", help=remedy)
    try:
        return SourceFile(str(path), content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        text = content.decode("utf-8", errors="replace")
        line = content[: error.start].count(b"\n") + 1
        message = f"{name} is not UTF-8 text: byte {error.start:,} is 0x{content[error.start]:02x}."
        remedy = "Save the file as UTF-8 text."
        return Diagnostic("Y1302", message, SourceFile(str(path), text), Span.on_line(line, 1, 1), remedy)


def parse_toml(source: SourceFile) -> dict[str, Any] | Diagnostic:
    """Return the data of a TOML text, or a finding."""
    import tomllib

    remedy = "Correct this line or the one above it: often a bracket, a quote or an = is missing."
    try:
        return tomllib.loads(source.text)
    except RecursionError:
        return Diagnostic("Y1303", "Brackets are nested too deep.", source, Span.on_line(1, 1, 1), remedy)
    except ValueError as error:
        what, _, _ = str(error).partition(" (at ")
        place = re.search(r"at line (\d+), column (\d+)", str(error))
        line, column = (int(place[1]), int(place[2])) if place else (max(len(source.lines), 1), 1)
        if "integer string conversion" in what:
            digits = re.search(r"\d[\d_]{4000}", source.text)
            what, line = "An integer has too many digits", 1
            if digits is not None:
                line = source.text.count("\n", 0, digits.start()) + 1
        return Diagnostic(
            "Y1303", f"{what}: this is not TOML.", source, Span.on_line(line, column, column + 1), remedy
        )
