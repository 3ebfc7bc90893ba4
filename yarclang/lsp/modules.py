"""The files that open texts speak of: modules, as they are open or saved; and who speaks of a file that has changed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from yarclang.assist.sketch import Sketch, sketch_of
from yarclang.lsp.documents import DESCRIPTION, Document
from yarclang.pipeline.modules import loader

if TYPE_CHECKING:
    from yarclang.lsp.analyses import Analyses


class Modules:
    """Modules by the text that uses them; what is open goes before what is saved."""

    def __init__(self, documents: Mapping[str, Document]) -> None:
        self._documents = documents

    def beside(self, document: Document) -> Callable[[str], Sketch | None]:
        """How the modules of a text are found: by name in upper case, each read once."""
        open_ = {one.path: one for one in self._documents.values() if one.path is not None}
        load = loader(document.folder, {path: one.source for path, one in open_.items()})
        known: dict[str, Sketch | None] = {}

        def find(name: str) -> Sketch | None:
            if name not in known:
                module = load(name).value
                one = open_.get(Path(module.source.name)) if module is not None else None
                known[name] = one.sketch if one else sketch_of(module.source) if module else None
            return known[name]

        return find

    def changed(self, document: Document, analyses: Analyses) -> None:
        """Have the open texts looked at again that speak of a text."""
        for other in self._documents.values():
            if other.uri != document.uri and other.is_program and _speaks_of(other, document):
                analyses.again(other.uri)


def _speaks_of(user: Document, used: Document) -> bool:
    """Whether what is said of a text may depend on another one."""
    if used.path is None:
        return False
    text = user.text.upper()
    if not used.is_program:
        return used.path.name.upper() in text or DESCRIPTION.upper() not in text
    return used.folder == user.folder and used.path.stem.upper() in text
