"""Find commands by their places: an index such as P0010, the calls and loops around an index such as
`P0020(I=2)>P0010`, or a part of such a place.
"""

from __future__ import annotations

import re

from yarclang.frozen import frozen
from yarclang.hir import Else, EndLoop, EndWhen, Gap, NextPass, Program
from yarclang.syntax.words import LONGEST_INDEX

_PART = re.compile(rf"P([0-9]{{1,{LONGEST_INDEX}}})(?:\(([^()]*)\))?", re.IGNORECASE)


@frozen
class Part:
    """One part of a place: `P0020(I=2)` is command 20 in a loop in which I is 2."""

    number: int
    loops: tuple[str, ...]

    def fits(self, pattern: Part) -> bool:
        """Return True if this part of a place matches `pattern`. Loop counters that `pattern` omits may
        have any value.
        """
        return self.number == pattern.number and set(pattern.loops) <= set(self.loops)


def parts_of(text: str) -> tuple[Part, ...] | None:
    """Split a place at `>`: return its calls and loops from the outermost to the innermost, then the command;
    None if the text is no place.
    """
    parts: list[Part] = []
    for piece in re.sub(r"\s+", "", text).split(">"):
        found = _PART.fullmatch(piece)
        if found is None:
            return None
        loops = tuple(one.upper() for one in (found[2] or "").split(",") if one)
        parts.append(Part(int(found[1]), loops))
    return tuple(parts)


def labels_of(program: Program) -> dict[int, str]:
    """Return the places of a program's steps, by the number of the step; steps without a place are
    missing.
    """
    return {
        number: step.origin.label
        for number, step in enumerate(program.steps)
        if not isinstance(step, Gap | Else | EndWhen | NextPass | EndLoop) and step.origin.label
    }


def matching(labels: dict[int, str], text: str) -> tuple[int, ...]:
    """Return the numbers of the steps whose places match a text, in order.

    A complete place matches only itself. Otherwise the text may be the beginning of a place, as written in
    the program's own file: the index of a CALL matches all commands of the call. If no place begins so, the
    text may be the end of a place, as written in a SUB. Loop counters that the text omits may have any value.

    Args:
        labels: places by the number of the step.
        text: the text.
    """
    pattern = parts_of(text)
    if pattern is None:
        return ()
    parts = {number: parts_of(label) or () for number, label in labels.items()}
    exact = [number for number, found in parts.items() if found == pattern]
    if exact:
        return tuple(exact)
    size = len(pattern)
    begin = [number for number, found in parts.items() if _fit(found[:size], pattern)]
    return tuple(begin or [number for number, found in parts.items() if _fit(found[-size:], pattern)])


def _fit(parts: tuple[Part, ...], pattern: tuple[Part, ...]) -> bool:
    return len(parts) == len(pattern) and all(
        one.fits(other) for one, other in zip(parts, pattern, strict=True)
    )
