"""Find declarations and uses of names, in a file and in the files that use it; rename these names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePath

from yarclang.assist.sketch import Sketch
from yarclang.assist.symbols import Symbol, Use
from yarclang.assist.view import View
from yarclang.diagnostics import Edit
from yarclang.semantics.declared.meanings import FIXED_FRAMES, is_word
from yarclang.source import SourceFile, Span

NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


@dataclass(frozen=True, slots=True)
class Place:
    """A range of a file.

    Attributes:
        source: the file.
        span: the range.
    """

    source: SourceFile
    span: Span


@dataclass(frozen=True, slots=True)
class Target:
    """A declaration of a name, and the file that contains it.

    Attributes:
        sketch: statements and names of the file.
        symbol: the declaration.
    """

    sketch: Sketch
    symbol: Symbol

    @property
    def place(self) -> Place:
        """Return the place of the name."""
        return Place(self.sketch.source, self.symbol.span)

    def is_same(self, other: Target | None) -> bool:
        """Return True if another target is the same declaration, even if the two were read from different
        versions of a text.
        """
        return (
            other is not None
            and self.sketch.source.name == other.sketch.source.name
            and self.symbol.span == other.symbol.span
        )


class RenameError(ValueError):
    """The new name isn't allowed. The message has the reason."""


def target_at(view: View, line: int, column: int) -> Target | None:
    """Return the declaration of the name at a place (line and column from 1), in this file or in one of
    its modules.
    """
    named = view.sketch.named_at(line, column)
    return None if named is None else target_of(view, named)


def target_of(view: View, named: Symbol | Use) -> Target | None:
    """Return the declaration of a name; None if no program file declares it."""
    if isinstance(named, Symbol):
        return Target(view.sketch, named)
    if named.symbol is not None:
        return Target(view.sketch, named.symbol)
    if not named.module:
        return None
    symbol = view.sketch.names.meant(named.module, False, named.span.line)
    module = view.module(named.module) if symbol and symbol.kind == "module" else None
    found = module.names.meant_by(named) if module else None
    return Target(module, found) if module and found else None


def definition_at(view: View, line: int, column: int) -> Place | None:
    """Return the place where the name at a place (line and column from 1) is declared: in this file, a
    module, the cell or the robot.

    For a module's name, return the beginning of the module's file.
    """
    named = view.sketch.named_at(line, column)
    if named is None:
        return None
    found = target_of(view, named)
    if found is not None:
        if found.symbol.kind == "module" and (module := view.module(found.symbol.name)):
            return Place(module.source, Span.on_line(1, 1, 1))
        return found.place
    return _outside(view, named)


def _outside(view: View, named: Symbol | Use) -> Place | None:
    """Return the place where the cell or the robot declares a name."""
    scope, name = view.scope, named.name
    if scope is not None:
        where = scope.where_frame(name) if named.is_frame else scope.where(name)
        if where is not None:
            return Place(where.source, where.span)
    robot = view.robot
    if robot is None:
        return None
    known = robot.flange_from_frame if named.is_frame else robot.positions
    return _in_description(robot.folder, name) if name in known else None


def _in_description(folder: Path, name: str) -> Place | None:
    """Return the place where a robot.toml has a name as a key."""
    from yarclang.robot.library import DESCRIPTION

    try:
        text = (folder / DESCRIPTION).read_text(encoding="utf-8")
    except (OSError, ValueError):
        return None
    source = SourceFile(str(folder / DESCRIPTION), text)
    for number, line in enumerate(source.lines, 1):
        match = re.match(rf"\s*(?:\[\w+\.)?\"?({re.escape(name)})\"?\s*[=\]]", line, re.IGNORECASE)
        if match:
            return Place(source, Span.on_line(number, match.start(1) + 1, match.end(1) + 1))
    return Place(source, Span.on_line(1, 1, 1))


def references(target: Target, views: Iterable[View], *, declaration: bool = True) -> Iterator[Place]:
    """Yield every use of a declared name in some files.

    Args:
        target: the declaration.
        views: the file with the declaration, and those that may use it.
        declaration: True if the declaration itself is yielded as well.
    """
    if declaration:
        yield target.place
    for view in views:
        for use in view.sketch.names.uses:
            if use.name == target.symbol.name and use.is_frame == target.symbol.is_frame:
                found = target_of(view, use)
                if target.is_same(found):
                    yield Place(view.sketch.source, use.span)


def renamable_at(view: View, line: int, column: int) -> Place:
    """Return the range of the name at a place (line and column from 1), if the name can be changed.

    Raises:
        RenameError: there is no name, or it is declared outside of programs.
    """
    named = view.sketch.named_at(line, column)
    if named is None:
        raise RenameError("there is no name here")
    target = target_of(view, named)
    if target is None:
        shown = f"{{{named.name}}}" if named.is_frame else named.name
        raise RenameError(f"{shown} isn't declared in a program or module: it can't be renamed here")
    if target.symbol.kind == "module":
        raise RenameError(f"{target.symbol.name} is a module: rename its file, and its USE lines")
    return Place(view.sketch.source, named.span)


def rename(target: Target, views: Iterable[View], name: str) -> dict[SourceFile, list[Edit]]:
    """Return the edits that rename a declared name and all its uses.

    Raises:
        RenameError: the new name isn't allowed.
    """
    views = list(views)
    new = name.strip().strip("{}").strip()
    _check(target, views, new)
    edits: dict[SourceFile, list[Edit]] = {}
    for place in references(target, views):
        edits.setdefault(place.source, []).append(Edit(place.span, new))
    return edits


def _check(target: Target, views: list[View], name: str) -> None:
    """Check that a new name is allowed for a declaration."""
    symbol, upper = target.symbol, name.upper()
    if NAME.fullmatch(name) is None:
        raise RenameError(
            f"`{name}` is no name: names have letters, digits and _, and don't begin with a digit"
        )
    if not symbol.is_frame and is_word(upper, of_pose=symbol.kind == "pose"):
        raise RenameError(f"{upper} is a word of the language")
    if symbol.is_frame and upper in FIXED_FRAMES:
        raise RenameError(f"{{{upper}}} comes from the robot and can't be declared")
    if upper == symbol.name:
        return
    for other in target.sketch.names.symbols:
        if (other.name, other.is_frame) == (upper, symbol.is_frame) and _meet(symbol, other):
            raise RenameError(f"{upper} is declared already, in line {other.span.line}")
    own = next((one for one in views if one.sketch.source.name == target.sketch.source.name), None)
    scope = own.scope if own else None
    if scope is not None:
        taken = scope.frame(upper) if symbol.is_frame else scope.name(upper)
        where = scope.where_frame(upper) if symbol.is_frame else scope.where(upper)
        if taken is not None and (where is None or where.source.name != target.sketch.source.name):
            whose = PurePath(where.source.name).name if where else "the robot"
            raise RenameError(f"{upper} is declared already, in {whose}")


def _meet(one: Symbol, other: Symbol) -> bool:
    """Return True if there is a line in which both declared names may be used."""
    return one.first <= other.last and other.first <= one.last
