"""Find the names that both branches of an IF declare. These names are known after the END of the IF, whatever
its condition is.
"""

from __future__ import annotations

from yarclang.semantics.files import values_of
from yarclang.syntax.ast import Block, Node, Word

_NAMES = frozenset({"LET", "POSE", "JOINTS"})
_FRAMES = frozenset({"FRAME", "FRAME_QUAT"})


class KnownBehind:
    """Cache of the names that are known after each IF, since an IF in a loop is carried out many times."""

    def __init__(self) -> None:
        self._found: dict[int, tuple[Block, frozenset[tuple[str, bool]]]] = {}

    def of(self, block: Block) -> frozenset[tuple[str, bool]]:
        """Return the cached result of `known_behind`."""
        found = self._found.get(id(block))
        if found is None:
            found = self._found[id(block)] = (
                block,
                known_behind(block),
            )  # keeps the block alive, so that no other block can get its id
        return found[1]


def known_behind(block: Block) -> frozenset[tuple[str, bool]]:
    """Return the names that both branches of an IF declare: these names have a meaning after its END.

    Args:
        block: an IF, with an ELSE or without.

    Returns:
        Names in upper case, each with True if it is the name of a frame; empty without an ELSE.
    """
    if block.otherwise is None:
        return frozenset()
    return _declared(block.body) & _declared(block.otherwise)


def _declared(nodes: tuple[Node, ...]) -> frozenset[tuple[str, bool]]:
    """Return the names that a group of lines always declares: outside of any IF, or in both branches of an
    IF.
    """
    found: set[tuple[str, bool]] = set()
    for node in nodes:
        if isinstance(node, Block):
            if node.head.name.name == "IF":
                found |= known_behind(node)
            continue
        word = node.name.name
        if node.index is not None:
            continue
        if word in _FRAMES and node.moving is not None:
            found.add((node.moving.name, True))
        elif word in _NAMES and (values := values_of(node)) and isinstance(values[0], Word):
            found.add((values[0].name, False))
    return frozenset(found)
