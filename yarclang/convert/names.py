"""Check whether names in converted files are allowed in a program."""

from __future__ import annotations

import re

from yarclang.commands.registry import actions, commands
from yarclang.semantics.declared.meanings import FIXED_FRAMES
from yarclang.syntax.words import RESERVED

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_INDEX = re.compile(r"P[0-9]+")


def legal_name(text: str, is_frame: bool = False) -> str:
    """Return the reason why a text can't be the name of a joint position or frame; empty if it can be."""
    name = text.upper()
    if not _NAME.fullmatch(text):
        return (
            f"{text[:40]!r} isn't a name: a name has letters A to Z, digits and _, and doesn't begin "
            "with a digit"
        )
    if is_frame:
        return f"{{{name}}} comes from the robot and can't be declared" if name in FIXED_FRAMES else ""
    if name in RESERVED or name in commands() or name in actions() or _INDEX.fullmatch(name):
        return f"{text} is a word of the language"
    return ""
