"""Completion: dot commands with what they take, and the words of the language."""

from __future__ import annotations

from collections.abc import Iterable

from prompt_toolkit.completion import CompleteEvent, Completer
from prompt_toolkit.completion import Completion as Choice
from prompt_toolkit.document import Document

from yarclang.repl.dot import dot_commands
from yarclang.repl.interpreter import Interpreter


class Completion(Completer):
    """What may be typed next.

    Args:
        interpreter: of the session: its names and files.
    """

    def __init__(self, interpreter: Interpreter) -> None:
        self._interpreter = interpreter

    def get_completions(self, document: Document, complete_event: CompleteEvent) -> Iterable[Choice]:  # noqa: ARG002
        """The choices at the cursor, each with a line of documentation."""
        text = document.text_before_cursor
        if self._interpreter.asked:
            return
        if text.startswith("."):
            yield from self._dotted(text)

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
