"""Formats of findings for other programs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module

from yarclang.diagnostics import Diagnostic

FORMATS = ("json", "sarif", "github", "junit")


def document(format_: str, files: Sequence[str], found: Sequence[Diagnostic], *, strict: bool = False) -> str:
    """Return findings as a document in an output format, with a final newline.

    Args:
        format_: one of FORMATS.
        files: all files that were checked.
        found: findings about these files.
        strict: True if warnings count as errors.
    """
    write: Callable[..., str] = import_module(f"yarclang.cli.formats.{format_}").write
    return write(files, found, strict=strict)


def path_of(one: Diagnostic) -> str:
    """Return a finding's file as written on the command line; empty if it has none."""
    return one.source.name if one.source is not None else ""
