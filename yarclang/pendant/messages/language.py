"""Messages about the language of programs."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message


class Language(Message):
    """The words of the language by their kinds, in upper case (units as they are written), longest first
    where one begins like another.
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
