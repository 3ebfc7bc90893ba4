"""Findings as other programs read them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module

from yarclang.diagnostics import Diagnostic

FORMATS = ("json", "sarif", "github", "junit")


def document(format_: str, files: Sequence[str], found: Sequence[Diagnostic], *, strict: bool = False) -> str:
    """Findings in a format, with the last line's end.

    Args:
        format_: one of FORMATS.
        files: all files that were checked.
        found: what was found in them.
        strict: whether a warning counts as an error.
    """
    write: Callable[..., str] = import_module(f"yarclang.cli.formats.{format_}").write
    return write(files, found, strict=strict)


def path_of(one: Diagnostic) -> str:
    """The file of a finding as it was named on the command line; empty where it has none."""
    return one.source.name if one.source is not None else ""
