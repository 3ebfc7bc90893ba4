"""Messages about the language of programs."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message


class Language(Message):
    """The words of the language by kind, in upper case, except for units, which are written as usual. If a
    word is the beginning of another word, the longer word comes first.
    """

    blocks: tuple[str, ...]
    declarations: tuple[str, ...]
    commands: tuple[str, ...]
    suffixes: tuple[str, ...]
    options: tuple[str, ...]
    operators: tuple[str, ...]
    functions: tuple[str, ...]
    constants: tuple[str, ...]
    units: tuple[str, ...]
