"""Rename frames and joint positions of a cell, in the cell.toml and in all programs that use the cell."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from yarclang.assist.navigation import NAME, Place, RenameError, target_of
from yarclang.assist.symbols import Symbol, Use
from yarclang.assist.view import View
from yarclang.diagnostics import Edit
from yarclang.pipeline.project import find_project
from yarclang.semantics.declared.meanings import FIXED_FRAMES, is_word
from yarclang.semantics.files import values_of
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Text

_FRAME_KEYS = ("parent", "frame", "grips", "leads_to", "leaves")
"""Keys of a cell.toml whose values are names of frames."""


def cell_of_name(view: View, named: Symbol | Use) -> Place | None:
    """Return the place where the cell of a program declares a frame or joint position; None if the cell
    doesn't declare it.
    """
    scope = view.scope
    if scope is None or target_of(view, named) is not None:
        return None
    where = scope.where_frame(named.name) if named.is_frame else scope.where(named.name)
    if where is None or not where.source.name.lower().endswith(".toml"):
        return None
    kind = "frames" if named.is_frame else "joints"
    places = list(_declared(where.source, kind, named.name))
    return Place(where.source, places[0]) if places else None


def rename_in_cell(
    place: Place, named: Symbol | Use, name: str, views: Iterable[View]
) -> dict[SourceFile, list[Edit]]:
    """Return the edits that rename a frame or joint position of a cell.

    Args:
        place: place of its declaration in the cell.toml.
        named: one of its uses in a program.
        name: the new name.
        views: programs that may use the cell.

    Raises:
        RenameError: the new name isn't allowed.
    """
    new = name.strip().strip("{}").strip()
    _check(place.source, named, new)
    edits = {place.source: [Edit(span, new) for span in _in_cell(place.source, named)]}
    for view in views:
        if not _keeps_to(view, Path(place.source.name)):
            continue
        for use in view.sketch.names.uses:
            if (use.name, use.is_frame) == (named.name, named.is_frame) and target_of(view, use) is None:
                edits.setdefault(view.sketch.source, []).append(Edit(use.span, new))
        for symbol in view.sketch.names.symbols:
            if (symbol.name, symbol.is_frame) == (new.upper(), named.is_frame):
                where = f"{Path(view.sketch.source.name).name}, line {symbol.span.line}"
                raise RenameError(f"{new.upper()} is declared already, in {where}")
    return edits


def _in_cell(source: SourceFile, named: Symbol | Use) -> Iterator[Span]:
    yield from _declared(source, "frames" if named.is_frame else "joints", named.name)
    if named.is_frame:
        wanted = re.compile(
            rf"\s*(?:{'|'.join(_FRAME_KEYS)})\s*=\s*[\"']({re.escape(named.name)})[\"']", re.I
        )
        for number, line in enumerate(source.lines, 1):
            if match := wanted.match(line):
                yield Span.on_line(number, match.start(1) + 1, match.end(1) + 1)


def _declared(source: SourceFile, kind: str, name: str) -> Iterator[Span]:
    """Yield the places in a cell.toml that declare a name: tables such as `[frames.NAME]`, and keys of
    `[frames]` or `[joints]`.
    """
    word = rf"[\"']?({re.escape(name)})[\"']?"
    header = re.compile(rf"\s*\[\s*{kind}\s*\.\s*{word}\s*\]", re.I)
    key = re.compile(rf"\s*(?:{kind}\s*\.\s*)?{word}\s*=", re.I)
    table = ""
    for number, line in enumerate(source.lines, 1):
        if match := header.match(line):
            yield Span.on_line(number, match.start(1) + 1, match.end(1) + 1)
        if opened := re.match(r"\s*\[\[?\s*([A-Za-z_.\"']+)\s*\]", line):
            table = opened[1].lower()
        elif (match := key.match(line)) and (table == kind or line.lstrip().lower().startswith(kind)):
            yield Span.on_line(number, match.start(1) + 1, match.end(1) + 1)


def _check(source: SourceFile, named: Symbol | Use, name: str) -> None:
    upper = name.upper()
    if NAME.fullmatch(name) is None:
        raise RenameError(
            f"`{name}` is no name: names have letters, digits and _, and don't begin with a digit"
        )
    if named.is_frame and upper in FIXED_FRAMES:
        raise RenameError(f"{{{upper}}} comes from the robot and can't be declared")
    if not named.is_frame and is_word(upper):
        raise RenameError(f"{upper} is a word of the language")
    kind = "frames" if named.is_frame else "joints"
    if upper != named.name and any(_declared(source, kind, upper)):
        raise RenameError(f"{upper} is declared already, in {Path(source.name).name}")


def _keeps_to(view: View, cell: Path) -> bool:
    """Return True if a program uses a cell: its CELL line names the cell or, without a CELL line, its
    project does.
    """
    folder = Path(view.sketch.source.name).parent
    for statement in view.sketch.module.statements:
        if statement.name.name == "CELL":
            texts = [value.text[1:-1] for value in values_of(statement) if isinstance(value, Text)]
            return any((folder / one).resolve() == cell.resolve() for one in texts)
    project = find_project(folder).value
    given = project.cell if project is not None else None
    return project is not None and given is not None and (project.folder / given).resolve() == cell.resolve()
