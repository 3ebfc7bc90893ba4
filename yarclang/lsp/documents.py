"""The texts that are open in the client, with the client's content."""

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
    """One version of a text that is open in the editor.

    Attributes:
        uri: the client's name for the text.
        version: the client's number for the version.
        text: the content.
    """

    uri: str
    version: int
    text: str

    @cached_property
    def path(self) -> Path | None:
        """Return the path of the file; None if the text was never saved."""
        path = to_fs_path(self.uri)
        return Path(path) if path else None

    @cached_property
    def folder(self) -> Path:
        """Return the folder to which file names in the text are relative."""
        return self.path.parent if self.path else Path.cwd()

    @cached_property
    def source(self) -> SourceFile:
        """Return the text with the name of its file, without a byte order mark."""
        return SourceFile(str(self.path) if self.path else self.uri, self.text.removeprefix("\ufeff"))

    @cached_property
    def sketch(self) -> Sketch:
        """Return the statements, blocks and names of the text."""
        return sketch_of(self.source)

    @property
    def is_program(self) -> bool:
        """Return True for a program or a module. Other texts describe a cell, robot or project, or are tables
        of waypoints.
        """
        return not self.uri.lower().endswith((DESCRIPTION, TABLE))

    @property
    def is_table(self) -> bool:
        """Return True for a table of waypoints. Only a program that names the table can check it."""
        return self.uri.lower().endswith(TABLE)


def changed(
    document: Document,
    changes: Iterable[types.TextDocumentContentChangeEvent],
    version: int,
    encoding: str,
) -> Document:
    """Apply the client's changes to a text, and return its next version.

    Each change refers to the text that results from the previous changes.
    """
    text = document.text
    for change in changes:
        if isinstance(change, types.TextDocumentContentChangePartial):
            source = SourceFile(document.uri, text)
            span = span_of(source, change.range, encoding)
            text = edited(source, [Fix("", (Edit(span, change.text),))])
        else:
            text = change.text
    return Document(document.uri, version, text)
