"""The texts that the client has open, as it has them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from lsprotocol import types
from pygls.uris import to_fs_path

from yarclang.assist.sketch import Sketch, sketch_of
from yarclang.diagnostics import Edit, Fix
from yarclang.lsp.positions import span_of
from yarclang.pipeline.fixing import edited
from yarclang.semantics.motions.trajectory_file import SUFFIX
from yarclang.source import SourceFile

PROGRAM = ".yarc"
DESCRIPTION = ".toml"
TABLE = SUFFIX


@dataclass(frozen=True, eq=False)
class Document:
    """One version of an open text. `path` is where it is saved, or would be; `name` is how findings call it."""

    uri: str
    version: int
    text: str

    @cached_property
    def path(self) -> Path | None:
        """Where the file is; None of a text that was never saved."""
        path = to_fs_path(self.uri)
        return Path(path) if path else None

    @cached_property
    def folder(self) -> Path:
        """Where the files are that it speaks of."""
        return self.path.parent if self.path else Path.cwd()

    @cached_property
    def source(self) -> SourceFile:
        """The text under its file's name; a byte order mark is no part of it."""
        return SourceFile(str(self.path) if self.path else self.uri, self.text.removeprefix("\ufeff"))

    @cached_property
    def sketch(self) -> Sketch:
        """What the text looks like."""
        return sketch_of(self.source)

    @property
    def is_program(self) -> bool:
        """True of a program or a module; else the text describes a cell, a robot or a project, or is a table of way-points."""
        return not self.uri.lower().endswith((DESCRIPTION, TABLE))

    @property
    def is_table(self) -> bool:
        """True of a table of way-points, which only a program that names it can judge."""
        return self.uri.lower().endswith(TABLE)


def changed(
    document: Document,
    changes: Iterable[types.TextDocumentContentChangeEvent],
    version: int,
    encoding: str,
) -> Document:
    """The next version of a document: each change counts in the text that the ones before have made."""
    text = document.text
    for change in changes:
        if isinstance(change, types.TextDocumentContentChangePartial):
            source = SourceFile(document.uri, text)
            span = span_of(source, change.range, encoding)
            text = edited(source, [Fix("", (Edit(span, change.text),))])
        else:
            text = change.text
    return Document(document.uri, version, text)
