"""Read files and decode their bytes to source text."""

from __future__ import annotations

import codecs
import errno
import sys
from collections.abc import Mapping
from pathlib import Path

from yarclang.diagnostics import Diagnostic, Result
from yarclang.files import read_stream, read_whole, reason_of
from yarclang.source import SourceFile, Span
from yarclang.syntax.characters import NOT_TEXT, character_name

STANDARD_INPUT = "-"

LARGEST_PROGRAM = 20_000_000
"""Largest size of a program [bytes]. A larger file is probably a mistake."""

LARGEST_DATA = 400_000_000
"""Largest size of a generated file [bytes]: controller texts of several hours, recordings."""

NO_TEXTS: Mapping[Path, SourceFile] = {}  # a plain dictionary can be sent to another process
"""No open files: all files are read from the disk."""

_REMEDIES = {
    errno.EFBIG: "check if this is the intended file: it isn't a program in text form",
    errno.EINVAL: "give a file, or - and the text on standard input",
}
_PLAIN_CONTROLS = frozenset(b"\t\n\v\f\r")
_NO_TEXT = "\ufffd"
"""Replacement for a byte that isn't text."""

_OTHER_MARKS = (
    (codecs.BOM_UTF32_LE, "UTF-32"),  # before UTF-16, whose mark is a prefix of this one
    (codecs.BOM_UTF32_BE, "UTF-32"),
    (codecs.BOM_UTF16_LE, "UTF-16"),
    (codecs.BOM_UTF16_BE, "UTF-16"),
)


def read_source(path: str, most: int = LARGEST_PROGRAM) -> Result[SourceFile]:
    """Read a program from a file, or from standard input (`-`).

    A byte order mark is removed. If the content isn't UTF-8 text, the finding is at the first invalid byte.

    Args:
        path: the file's path, or `-`.
        most: largest number of bytes to read.
    """
    content = read_content(path, most)
    if content.value is None:
        return Result(None, content.diagnostics)
    return decode_source(name_of(path), content.value)


def name_of(path: str) -> str:
    """Return the name of a file, or of standard input, for findings."""
    return "<stdin>" if path == STANDARD_INPUT else path


def read_content(path: str, most: int = LARGEST_PROGRAM) -> Result[bytes]:
    """Read at most `most` bytes of a file, or of standard input (`-`)."""
    if path == STANDARD_INPUT and sys.stdin is None:
        return Result(None, (Diagnostic("Y0107", "standard input is closed", help="give a file's name"),))
    try:
        if path == STANDARD_INPUT:
            content = read_stream(sys.stdin.buffer, most)
        else:
            content = read_whole(Path(path), most)
    except OSError as error:
        reason = reason_of(error)
        help_ = _REMEDIES.get(error.errno or 0, "check the path and its permissions")
        return Result(None, (Diagnostic("Y0107", f"{name_of(path)} can't be read: {reason}", help=help_),))
    return Result(content)


def decode_source(name: str, content: bytes) -> Result[SourceFile]:
    """Decode the bytes of a file called `name` as a source text."""
    content = content.removeprefix(codecs.BOM_UTF8)
    for mark, encoding in _OTHER_MARKS:
        if content.startswith(mark):
            first = " ".join(f"{one:02X}" for one in mark)
            message = f"this is {encoding} text, by its first bytes {first}, not UTF-8"
            source = SourceFile(name, "")
            return Result(None, (Diagnostic("Y0103", message, source, Span.on_line(1, 1, 2), NOT_TEXT),))
    bad = _first_bad_byte(content)
    if bad is None:
        return Result(SourceFile(name, content.decode("utf-8")))
    before = content[:bad].replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    line = before.count(b"\n") + 1
    column = len(before[before.rfind(b"\n") + 1 :].decode("utf-8")) + 1
    what = f"0x{content[bad]:02X}" + (f" ({character_name(chr(content[bad]))})" if content[bad] < 128 else "")
    message = f"this is not text: the first byte that isn't is {what}, at line {line}, column {column}"
    shown = SourceFile(name, before.decode("utf-8") + _NO_TEXT)
    return Result(
        None, (Diagnostic("Y0103", message, shown, Span.on_line(line, column, column + 1), NOT_TEXT),)
    )


def _first_bad_byte(content: bytes) -> int | None:
    """Return the position of the first invalid byte: a control character, or bytes that aren't UTF-8."""
    end = len(content)
    try:
        content.decode("utf-8")
    except UnicodeDecodeError as error:
        end = error.start
    controls = [code for code in range(32) if code not in _PLAIN_CONTROLS]
    places = [place for code in (*controls, 127) if (place := content.find(bytes([code]), 0, end)) >= 0]
    if places:
        return min(places)
    return end if end < len(content) else None
