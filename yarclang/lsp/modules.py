"""Find modules and other files that open texts refer to, and the open texts that refer to a changed file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from yarclang.assist.sketch import Sketch, sketch_of
from yarclang.consulted import modules_in
from yarclang.lsp.documents import PROGRAM, Document
from yarclang.pipeline.modules import loader
from yarclang.pipeline.sources import read_source

if TYPE_CHECKING:
    from yarclang.lsp.analyses import Analyses


_MOST_FILES = 2_000
"""Largest number of files that are read for one folder of the workspace. The same number of files is cached.
"""


class Modules:
    """Modules of the open texts. A module that is open takes precedence over its saved file."""

    def __init__(self, documents: Mapping[str, Document]) -> None:
        self._documents = documents
        self._sketches: dict[Path, tuple[int, Sketch]] = {}

    def in_folder(self, folder: Path) -> Callable[[str], Sketch | None]:
        """Return a function that finds the modules of a folder by name in upper case, and reads each once."""
        open_ = self._open()
        load = loader(folder, {path: one.source for path, one in open_.items()})
        known: dict[str, Sketch | None] = {}

        def find(name: str) -> Sketch | None:
            if name not in known:
                module = load(name).value
                one = open_.get(Path(module.source.name).absolute()) if module is not None else None
                known[name] = one.sketch if one else sketch_of(module.source) if module else None
            return known[name]

        return find

    def files(self, folder: Path, names: Iterable[str] = ()) -> Iterator[Sketch]:
        """Yield the programs and modules of a folder, and the files `names`, unless they are open in the
        editor.
        """
        open_ = self._open()
        for path in dict.fromkeys([*modules_in(folder), *map(Path, names)]):
            if path.absolute() not in open_ and (sketch := self._saved(path)) is not None:
                yield sketch

    def everywhere(self, roots: Iterable[Path]) -> list[Sketch]:
        """Return all programs and modules below some folders, and the open ones."""
        open_ = self._open()
        found = [one.sketch for one in open_.values() if one.is_program]
        for root in roots:
            paths = islice(root.rglob(f"*{PROGRAM}"), _MOST_FILES)
            saved = (self._saved(path) for path in paths if path.absolute() not in open_)
            found += [sketch for sketch in saved if sketch is not None]
        return found

    def _open(self) -> dict[Path, Document]:
        return {one.path: one for one in list(self._documents.values()) if one.path is not None}

    def _saved(self, path: Path) -> Sketch | None:
        """Return the statements and names of a saved file. The file is read again only if it has changed."""
        try:
            stamp = path.stat().st_mtime_ns
        except OSError:
            return None
        known = self._sketches.get(path)
        if known is not None and known[0] == stamp:
            return known[1]
        read = read_source(str(path)).value
        if read is None:
            return None
        sketch = sketch_of(read)
        if len(self._sketches) >= _MOST_FILES:
            self._sketches.pop(next(iter(self._sketches)))
        self._sketches[path] = stamp, sketch
        return sketch

    def changed(self, document: Document, analyses: Analyses) -> None:
        """Check the open texts again that may refer to a changed text."""
        for other in list(self._documents.values()):
            if other.uri != document.uri and _may_speak_of(other, document):
                analyses.again(other.uri)


def _may_speak_of(user: Document, used: Document) -> bool:
    """Return True if the findings of a text may depend on another text.

    The other text may be a module of the folder, a table of waypoints that the text names, or any
    description of a cell, robot or project.
    """
    if used.path is None:
        return False
    if used.is_table:
        return user.is_program and used.path.name in user.text
    if used.path.suffix.lower() != PROGRAM:
        return True
    return used.folder == user.folder and user.is_program and used.path.stem.upper() in user.text.upper()
