"""Check that a typed text is complete: each block has its END, and each list of waypoints its last
waypoint.
"""

from __future__ import annotations

from yarclang.source import SourceFile
from yarclang.syntax.lines import code_of
from yarclang.syntax.parse import parse
from yarclang.syntax.words import BLOCK_ENDS, opens_block


def is_whole(text: str) -> bool:
    """Return True if a typed text is complete: no block or list of waypoints needs a further line."""
    if text.lstrip().startswith("."):
        return True
    source = SourceFile("<line>", text)
    lines = [code for line in source.lines if (code := code_of(line).strip())]
    if lines and lines[-1].endswith(";"):
        return False
    module = parse(source).value
    assert module is not None  # parsing always returns a tree
    return sum(opens_block(one) - (one.name.name in BLOCK_ENDS) for one in module.statements) <= 0
