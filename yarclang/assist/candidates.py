"""Completion candidates: texts that an editor may insert. Those for declared names are created here."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from yarclang.assist.cursor import Cursor
from yarclang.assist.declared import module_lines, sub_lines
from yarclang.assist.snippets import plain_text
from yarclang.assist.symbols import Symbol
from yarclang.assist.view import View
from yarclang.assist.vocabulary import FRAMES, OTHERS, entry_text
from yarclang.consulted import modules_in
from yarclang.pipeline.modules import library_folder
from yarclang.semantics.names.scope import BASE, JointPosition, Library, Named
from yarclang.source import Span
from yarclang.syntax.lines import code_of
from yarclang.syntax.words import FUNCTIONS

Kind = Literal[
    "command",
    "declaration",
    "frame",
    "number",
    "table",
    "joints",
    "pose",
    "input",
    "register",
    "output",
    "tool",
    "sub",
    "module",
    "parameter",
    "unit",
    "option",
    "time",
    "function",
    "word",
    "robot",
    "finding",
]
_AMOUNTS = ("number", "parameter")


@dataclass(frozen=True, slots=True)
class Candidate:
    """A text that completion offers at a place in a program.

    Attributes:
        label: text that is shown, and compared with the typed text.
        kind: kind of the candidate.
        detail: a few words that are shown beside the label.
        documentation: documentation in Markdown.
        text: text to insert, with placeholders such as `${1:x}`.
        span: the range that the text replaces.
        rank: sort key; candidates with smaller ranks come first.
    """

    label: str
    kind: Kind
    detail: str
    documentation: str
    text: str
    span: Span
    rank: int = 0

    @property
    def plain(self) -> str:
        """Return the text to insert, without placeholders."""
        return plain_text(self.text)


class NameMaker:
    """Creates completion candidates from the declared names that may be used at a place in a program.

    Args:
        view: the program's text and its analysis.
        cursor: the place.
        span: the range that a candidate replaces.
        behind: the character after the place.
    """

    def __init__(self, view: View, cursor: Cursor, span: Span, behind: str) -> None:
        self.view = view
        self.cursor = cursor
        self.span = span
        self.behind = behind

    def numbers(self) -> Iterator[Candidate]:
        """Yield the names of numbers."""
        for symbol in self.symbols():
            if symbol.kind in _AMOUNTS and not symbol.is_frame:
                yield self._symbol(symbol)
        yield from self._of_modules("number")

    def tables(self) -> Iterator[Candidate]:
        """Yield the tables, with a placeholder for the index."""
        for symbol in self.symbols():
            if symbol.kind == "table":
                yield replace(self._symbol(symbol), text=f"{symbol.name}[${{1:0}}]")
        for one in self._of_modules("table"):
            yield replace(one, text=f"{one.label}[${{1:0}}]")

    def functions(self) -> Iterator[Candidate]:
        """Yield the functions of the program, of its modules and of the language, and PI."""
        for symbol in self.symbols():
            if symbol.kind == "function":
                yield replace(self._symbol(symbol), text=f"{symbol.name}(${{1}})")
        for one in self._of_modules("function"):
            yield replace(one, text=f"{one.label}(${{1}})")
        for name in FUNCTIONS:
            entry = OTHERS[name]
            yield self.make(name, "function", entry.summary, entry_text(name, entry), f"{name}(${{1}})", 1)
        yield self.make("PI", "number", OTHERS["PI"].summary, entry_text("PI", OTHERS["PI"]), "PI", 1)

    def frames(self, *, closing: bool = True) -> Iterator[Candidate]:
        """Yield the frames in their braces."""
        seen: set[str] = set()
        for symbol in self.symbols():
            if symbol.is_frame and symbol.name not in seen:
                seen.add(symbol.name)
                yield self._frame(symbol.name, _line_of(self.view, symbol), closing)
        scope = self.view.scope
        names = list(scope.frame_names()) if scope is not None else []
        if self.view.robot is not None:
            names += [BASE, *self.view.robot.flange_from_frame]
        for name in dict.fromkeys([*names, *FRAMES]):
            if name not in seen and not self._is_own(name, True):
                seen.add(name)
                yield self._frame(name, FRAMES[name].summary if name in FRAMES else "", closing, 1)
        for module, inner in self._module_symbols():
            if inner.is_frame:
                yield self._frame(f"{module}.{inner.name}", "", closing, 2)

    def _frame(self, name: str, detail: str, closing: bool, rank: int = 0) -> Candidate:
        text = f"{{{name}" + ("}" if closing else "")
        return self.make(f"{{{name}}}", "frame", detail, "", text, rank)

    def known(self, kind: type[Named], called: Kind) -> Iterator[Candidate]:
        """Yield the names of a kind that are declared in the file, its modules, the cell and the robot."""
        for symbol in self.symbols():
            if (
                not symbol.is_frame
                and symbol.kind in {called, "parameter"}
                and not (called == "sub" and symbol.kind == "parameter")
            ):
                yield self._symbol(symbol)
        yield from self._of_modules(called)
        scope = self.view.scope
        for name in dict.fromkeys(scope.names(kind)) if scope is not None else ():
            if not self._is_own(name, False) and (scope is None or not isinstance(scope.name(name), Library)):
                yield self.make(name, called, "", "", name, 1)
        robot = self.view.robot
        if kind is JointPosition and robot is not None:
            for name in robot.positions:
                yield self.make(name, called, "a joint position of the robot", "", name, 1)

    def _of_modules(self, kind: str) -> Iterator[Candidate]:
        for module, inner in self._module_symbols():
            if inner.kind == kind and not inner.is_frame:
                name = f"{module}.{inner.name}"
                sketch = self.view.module(module)
                documentation = "\n".join(sub_lines(sketch, inner.name)) if sketch and kind == "sub" else ""
                yield self.make(name, inner.kind, f"of the module {module}", documentation, name, 1)

    def _module_symbols(self) -> Iterator[tuple[str, Symbol]]:
        """Yield the declarations of the modules whose USE lines are above the place, each with the module's
        name.
        """
        for symbol in self.symbols():
            module = self.view.module(symbol.name) if symbol.kind == "module" else None
            for inner in module.names.symbols if module else ():
                if module and module.names.declared(inner.name, inner.is_frame) is inner:
                    yield symbol.name, inner

    def modules(self) -> Iterator[Candidate]:
        """Yield the files that USE may name: those that contain a SUB."""
        folder = Path(self.view.sketch.source.name).parent
        own = Path(self.view.sketch.source.name).stem.upper()
        for place in (folder, library_folder()):
            for path in modules_in(place):
                name = path.stem.upper()
                if (
                    name != own
                    and re.fullmatch(r"[A-Z_][A-Z0-9_]*", name)
                    and (module := self.view.module(name))
                ) and any(one.kind == "sub" for one in module.names.symbols):
                    yield self.make(name, "module", "a module", "\n".join(module_lines(module)), name)

    def symbols(self) -> Iterable[Symbol]:
        """Return the declarations of the file that may be used at the place."""
        return self.view.sketch.names.known_in(self.cursor.line)

    def _is_own(self, name: str, is_frame: bool) -> bool:
        """Return True if the program's file declares a name anywhere, even if the name can't be used at this
        place.
        """
        return any((one.name, one.is_frame) == (name, is_frame) for one in self.view.sketch.names.symbols)

    def _symbol(self, symbol: Symbol) -> Candidate:
        lines = sub_lines(self.view.sketch, symbol.name) if symbol.kind == "sub" else []
        return self.make(symbol.name, symbol.kind, _line_of(self.view, symbol), "\n".join(lines), symbol.name)

    def make(
        self, label: str, kind: Kind, detail: str, documentation: str, text: str, rank: int = 0
    ) -> Candidate:
        """Return a completion candidate that replaces the typed text."""
        return Candidate(label, kind, detail, documentation, text, self.span, rank)


def _line_of(view: View, symbol: Symbol) -> str:
    """Return the line that declares a name, without its comment."""
    return code_of(view.sketch.source.line(symbol.statement.line)).strip()
