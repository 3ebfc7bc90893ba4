"""When what is typed is whole: a block has its END, a list of way-points its last one."""

from __future__ import annotations

from yarclang.source import SourceFile
from yarclang.syntax.lines import code_of
from yarclang.syntax.parse import parse
from yarclang.syntax.words import BLOCK_ENDS, BLOCK_HEADS


def is_whole(text: str) -> bool:
    """Whether nothing is missing behind a text."""
    if text.lstrip().startswith("."):
        return True
    source = SourceFile("<line>", text)
    lines = [code for line in source.lines if (code := code_of(line).strip())]
    if lines and lines[-1].endswith(";"):
        return False
    module = parse(source).value
    assert module is not None  # parsing always gives a tree
    words = [one.name.name for one in module.statements if one.index is None]
    return sum((word in BLOCK_HEADS) - (word in BLOCK_ENDS) for word in words) <= 0
