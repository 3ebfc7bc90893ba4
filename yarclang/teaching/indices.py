"""Indices and indentation of inserted commands."""

from __future__ import annotations

import re

from yarclang.runtime.actions import Trouble
from yarclang.syntax.words import BLOCK_ENDS, LONGEST_INDEX, opens_block
from yarclang.teaching.edits import Draft, Program

_INDEX = re.compile(r"\s*[Pp]([0-9]+)(?![^\s;\[\](){}!,\"])")
_STEP = 10
_INDENT = "  "


def index_of(line: str) -> int | None:
    """Return the index at the beginning of a line, even if the line can't be parsed."""
    match = _INDEX.match(line)
    return int(match[1]) if match and len(match[1]) <= LONGEST_INDEX else None


def shown_index(number: int) -> str:
    """Return an index as text for a program."""
    return f"P{number:04d}"


def free_indices(program: Program, after: int, count: int, gone: frozenset[int] = frozenset()) -> list[int]:
    """Return indices (such as P0030) for new commands after a line, between the indices of the commands
    around them.

    Args:
        program: the program.
        after: number of the line.
        count: number of new commands.
        gone: numbers of lines whose indices count as unused.

    Returns:
        Unused indices; empty if there aren't enough between the neighbours' indices.
    """
    numbers = {
        one.line: int(one.index.text[1:])
        for one in program.sketch.module.statements
        if one.index and one.line not in gone
    }
    numbers |= {
        line: number
        for line in program.unreadable
        if line not in gone and (number := index_of(program.content(line))) is not None
    }
    taken = set(numbers.values())
    above = max((line for line in numbers if line <= after), default=None)
    below = min((line for line in numbers if line > after), default=None)
    low = 0 if above is None else numbers[above]
    high = 10**LONGEST_INDEX if below is None else numbers[below]
    if high <= low:  # The indices don't ascend here: continue from the command above.
        high = 10**LONGEST_INDEX
    if below is None or high - low > _STEP * (count + 1) + _STEP:
        found, number = list[int](), low // _STEP * _STEP
        while len(found) < count and number + _STEP < high:
            number += _STEP
            if number not in taken:
                found.append(number)
        return found if len(found) == count else []
    return _between(low, high, count, taken)


def _between(low: int, high: int, count: int, taken: set[int]) -> list[int]:
    room = [number for number in range(low + 1, high) if number not in taken]
    if len(room) < count:
        return []
    if count == 1:
        middle = (low + high) / 2
        return [min(room, key=lambda one: (-(one % 10 == 0), -(one % 5 == 0), abs(one - middle)))]
    return [room[(number + 1) * (len(room) + 1) // (count + 1) - 1] for number in range(count)]


def index_for(draft: Draft, after: int) -> int:
    """Return an index for a new command after a line. If no index is free between the neighbours' indices,
    all commands are renumbered.
    """
    found = free_indices(draft.program, after, 1)
    if found:
        return found[0]
    return renumber(draft, after, 1)


def renumber(draft: Draft, after: int = -1, room: int = 0) -> int:
    """Give all commands ascending indices.

    Args:
        draft: receives the new indices.
        after: number of the line after which further commands will be inserted; -1 for none.
        room: number of these further commands, for which indices are kept free.

    Returns:
        The index for the first of the further commands.

    Raises:
        Trouble: there are more commands than indices.
    """
    program, number, mine, changed = draft.program, 0, 0, 0
    module = program.sketch.module
    lines = {one.line: one.index for one in module.statements if one.index}
    unread = [line for line in program.unreadable if index_of(program.content(line)) is not None]
    for line in sorted((*lines, *unread)):
        if line > after >= 0 and not mine:
            mine = number + _STEP
            number += _STEP * room
        number += _STEP
        if number >= 10**LONGEST_INDEX:
            raise Trouble("there are more commands than indices", "divide the program", "index")
        old = program.content(line)
        match = _INDEX.match(old)
        if match is not None and int(match[1]) != number:
            start = match.start(1) - 1
            draft.changed[line] = f"{old[:start]}{shown_index(number)}{old[match.end(1) :]}"
            changed += 1
    if room:
        count = f"{changed} command{'s have new ones' if changed != 1 else ' has a new one'}"
        draft.notes.append(f"no index was free between the neighbours: {count}")
    return mine or number + _STEP


def indentation(program: Program, after: int) -> str:
    """Return the indentation of a line that is inserted after a given line: that of its neighbours."""
    statements = program.sketch.module.statements
    above = [one for one in statements if one.line <= after]
    below = next((one for one in statements if one.line > after), None)
    if not above:
        return program.indent(below.line) if below else ""
    last = above[-1]
    if opens_block(last) or last.name.name in ("ELSE", "OF"):
        if below is not None and below.name.name not in (*BLOCK_ENDS, "ELSE", "OF"):
            return program.indent(below.line)
        return program.indent(last.line) + _INDENT
    return program.indent(last.line)
