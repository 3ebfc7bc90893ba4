"""Completion of dot commands and their arguments, and of the language in the same way as in an editor."""

from __future__ import annotations

import re
from collections.abc import Iterable

from prompt_toolkit.completion import CompleteEvent, Completer
from prompt_toolkit.completion import Completion as Choice
from prompt_toolkit.document import Document

from yarclang.assist.candidates import Candidate
from yarclang.assist.completion import candidates_at
from yarclang.assist.sketch import Sketch, sketch_of
from yarclang.assist.view import View
from yarclang.pipeline.checking import Checked
from yarclang.pipeline.inputs import Opened
from yarclang.pipeline.modules import loader
from yarclang.repl.dot import dot_commands
from yarclang.repl.interpreter import Interpreter

_INDEX = re.compile(r"P\d+ +")


class Completion(Completer):
    """Completes the typed text.

    Args:
        interpreter: session with its names and files.
    """

    def __init__(self, interpreter: Interpreter) -> None:
        self._interpreter = interpreter

    def get_completions(self, document: Document, complete_event: CompleteEvent) -> Iterable[Choice]:  # noqa: ARG002
        """Yield the choices at the cursor, each with a line of documentation."""
        text = document.text_before_cursor
        if self._interpreter.asked:
            return
        if text.startswith("."):
            yield from self._dotted(text)
        else:
            yield from self._spoken(document)

    def _dotted(self, text: str) -> Iterable[Choice]:
        name, blank, rest = text.partition(" ")
        if not blank:
            for one in dot_commands().values():
                if one.name.startswith(name):
                    yield Choice(one.name, -len(name), display=one.line, display_meta=one.summary)
            return
        command = dot_commands().get(name)
        if command is not None and command.complete is not None:
            for choice in command.complete(self._interpreter, rest):
                yield Choice(choice, -len(rest))

    def _spoken(self, document: Document) -> Iterable[Choice]:
        """Yield completion candidates for a line of the language, as if it were typed after all declarations
        of the session.
        """
        interpreter = self._interpreter
        typed = interpreter.lines.behind(document.text)
        line = typed.before + document.cursor_position_row + 1
        column = document.cursor_position_col + 1
        sketch = sketch_of(typed.source)
        opened = Opened(sketch.module, interpreter.planner.request(interpreter.robot.home))
        view = View(sketch, Checked((), typed.source, opened), interpreter.robot, self._module)
        begun = typed.source.line(line)[: column - 1]
        found = [one for one in candidates_at(view, line, column) if _fits(one, begun)]
        for one in sorted(found, key=lambda one: (one.rank, one.label)):
            text = _INDEX.sub("", one.plain) if one.kind == "command" else one.plain
            yield Choice(text, one.span.column - column, display=one.label, display_meta=one.detail)

    def _module(self, name: str) -> Sketch | None:
        found = loader(self._interpreter.folder)(name).value
        return None if found is None else Sketch(found.source, found)


def _fits(one: Candidate, begun: str) -> bool:
    """Return True if a candidate starts with the typed text, ignoring its index."""
    already = begun[one.span.column - 1 :].upper()
    return one.label.upper().startswith(already) or one.plain.upper().startswith(already)
