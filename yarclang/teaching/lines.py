"""Operations on whole lines: insert, delete, move and renumber commands."""

from __future__ import annotations

from yarclang.runtime.actions import Trouble
from yarclang.syntax.ast import Block, Node
from yarclang.syntax.words import BLOCK_ENDS, opens_block
from yarclang.teaching.edits import Draft, Edited, Program
from yarclang.teaching.indices import (
    free_indices,
    indentation,
    index_for,
    index_of,
    renumber,
    shown_index,
)


def insert(program: Program, after: int, code: str, *, has_index: bool = True, use: str = "") -> Edited:
    """Insert a line into a program.

    Args:
        program: the program.
        after: number of the line after which the new line is inserted; 0 is the beginning.
        code: the line without index and indentation.
        has_index: True if the line is a command, which gets an index.
        use: module that the line needs; a USE line is inserted if it is missing.

    Raises:
        Trouble: the line isn't allowed there.
    """
    from yarclang.teaching.declaring import place_of_declarations
    from yarclang.teaching.motions import place_of_command

    draft = Draft(program)
    if has_index:
        after = place_of_command(draft, after)
    else:
        if after:
            program.check_line(after)
        after = program.last_row(after) if after else 0
    if use and not any(one.kind == "module" and one.name == use for one in program.sketch.names.symbols):
        first = min((one.line for one in program.sketch.module.statements), default=program.size + 1)
        draft.add(
            min(place_of_declarations(program, min(first + program.size, after + 1)), after), f"USE {use}"
        )
        draft.notes.append(f"USE {use} was put in")
    index = f"{shown_index(index_for(draft, after))} " if has_index else ""
    draft.add(after, indentation(program, after) + index + code)
    line = draft.new_line(after) + len(draft.added[after]) - 1
    return draft.finished(line, f"inserted {index}{code[:60]}")


def delete(program: Program, first: int, last: int) -> Edited:
    """Delete lines. A statement of several lines is deleted as a whole, and so is a block whose first line is
    deleted.

    Args:
        program: the program.
        first: the first line.
        last: the last line.

    Raises:
        Trouble: there are no such lines, or an END would be deleted without its block.
    """
    program.check_line(first)
    program.check_line(last, first)
    draft = Draft(program)
    draft.gone = _whole(program, set(range(first, last + 1)))
    count = len(draft.gone)
    what = (
        f"deleted line {min(draft.gone)}"
        if count == 1
        else f"deleted {count} lines from line {min(draft.gone)} on"
    )
    line = draft.moved_line(min(draft.gone) - 1) + 1 if min(draft.gone) > 1 else 1
    return draft.finished(line, what)


def _whole(program: Program, lines: set[int]) -> set[int]:
    """Return the given lines, extended to all rows of their statements and blocks."""
    whole = set(lines)
    for line in lines:
        statement = program.sketch.statement_at(line)
        if statement is not None:
            whole.update(range(statement.line, statement.line + statement.rows))
    for first, rows in program.unreadable.items():
        span = range(first, first + rows)
        if any(line in lines for line in span):
            whole.update(span)
    _add_blocks(program.sketch.nodes, whole)
    return whole


def _add_blocks(nodes: tuple[Node, ...], found: set[int]) -> None:
    for block in nodes:
        if not isinstance(block, Block):
            continue
        head, turn, end = block.head, block.otherwise_head, block.end
        last = (
            end.line
            if end is not None
            else max([head.line, *map(_last, block.body), *map(_last, block.otherwise or ())])
        )
        if head.line in found:
            found.update(range(head.line, last + 1))
        elif end is not None and end.line in found:
            raise Trouble(
                f"the END in line {end.line} belongs to {head.name.name} in line {head.line}",
                f"delete line {head.line}: this deletes its whole block",
                "block",
            )
        elif turn is not None and turn.line in found:
            found.update(range(turn.line, last + (end is None)))
        else:
            _add_blocks((*block.body, *(block.otherwise or ())), found)


def _last(node: Node) -> int:
    if not isinstance(node, Block):
        return node.line + node.rows - 1
    if node.end is not None:
        return node.end.line
    return max([node.head.line, *map(_last, node.body), *map(_last, node.otherwise or ())])


def move(program: Program, line: int, before: int) -> Edited:
    """Move a statement or a block to another line, and indent it like its new neighbours.

    Args:
        program: the program.
        line: line of the statement, or first line of the block.
        before: number of the line before which it is inserted; the number of lines plus one for the end.

    Raises:
        Trouble: the statement or block isn't allowed there.
    """
    program.check_line(line)
    if not 1 <= before <= program.size + 1:
        raise Trouble(
            f"there is no line {before}: the text has {program.size}", "list the program again", "line"
        )
    lines = sorted(_whole(program, {line}))
    moved = program.sketch.statement_at(line)
    if moved is not None and moved.name.name == "ELSE":
        raise Trouble("ELSE stays between IF, WHEN or CASE and its END", "move the whole block", "block")
    if moved is not None and moved.name.name == "OF":
        raise Trouble("OF stays in its CASE", "move the lines after it, or the whole block", "block")
    first, last = lines[0], lines[-1]
    after = before - 1
    row_end = program.last_row(after) if after else 0
    after = row_end if row_end != after and after not in range(first, last + 1) else after
    if first <= after < last:
        raise Trouble(
            f"lines {first} to {last} can't be moved into themselves",
            "choose a line outside of them",
            "block",
        )
    if after in (first - 1, last):
        return Edited((), first, f"line {first} is there already")
    draft = Draft(program)
    draft.gone = set(lines)
    rows = _indented(program, lines, _indent_at(program, after, frozenset(lines)))
    rows = _numbered(draft, rows, after, frozenset(lines))
    draft.add(after, *rows)
    return draft.finished(draft.new_line(after), f"moved {_called(len(lines), first)}")


def _called(count: int, first: int) -> str:
    return f"line {first}" if count == 1 else f"{count} lines from line {first} on"


def _indent_at(program: Program, after: int, without: frozenset[int]) -> str:
    """Return the indentation of a line that is inserted after a given line. The lines in `without` are
    ignored.
    """
    statements = [one for one in program.sketch.module.statements if one.line not in without]
    above = max((one.line for one in statements if one.line <= after), default=0)
    head = next((one for one in statements if one.line == above), None)
    below = next((one for one in statements if one.line > after), None)
    if head is not None and (opens_block(head) or head.name.name in ("ELSE", "OF")):
        if below is not None and below.name.name not in (*BLOCK_ENDS, "ELSE", "OF"):
            return program.indent(below.line)
        return program.indent(above) + "  "
    if above:
        return program.indent(above)
    return program.indent(below.line) if below else ""


def _indented(program: Program, lines: list[int], wanted: str) -> list[str]:
    """Return lines that are shifted to the left or right, so that the first line has a given indentation."""
    old, rows = program.indent(lines[0]), []
    for line in lines:
        text = program.content(line)
        if text.startswith(old) and text.strip():
            text = wanted + text[len(old) :]
        rows.append(text)
    return rows


def _numbered(draft: Draft, rows: list[str], after: int, moved: frozenset[int]) -> list[str]:
    """Return lines whose commands have indices between those of their new neighbours. Indices that already
    fit stay unchanged.
    """
    with_index = [(at, number) for at, row in enumerate(rows) if (number := index_of(row)) is not None]
    if not with_index:
        return rows
    program = draft.program
    numbers = [
        (one.line, int(one.index.text[1:]))
        for one in program.sketch.module.statements
        if one.index and one.line not in moved
    ]
    low = max(((line, number) for line, number in numbers if line <= after), default=(0, 0))[1]
    high = min(((line, number) for line, number in numbers if line > after), default=(0, 10**9))[1]
    own = [number for _, number in with_index]
    if own == sorted(own) and low < own[0] and own[-1] < high:
        return rows
    free = free_indices(program, after, len(own), moved)
    if not free:
        draft.notes.append("the indices no longer ascend: renumber the program")
        return rows
    rows = list(rows)
    for (at, number), new in zip(with_index, free, strict=True):
        start = len(rows[at]) - len(rows[at].lstrip())
        end = start + 1
        while end < len(rows[at]) and rows[at][end].isdigit():
            end += 1
        if number != new:
            rows[at] = f"{rows[at][:start]}{shown_index(new)}{rows[at][end:]}"
    draft.notes.append("its index changes there" if len(own) == 1 else "their indices change there")
    return rows


def renumbered(program: Program) -> Edited:
    """Give all commands the indices P0010, P0020 and so on, and change nothing else."""
    draft = Draft(program)
    renumber(draft)
    count = len(draft.changed)
    what = f"{count} command{'s have new indices' if count != 1 else ' has a new index'}"
    return draft.finished(1, what if count else "all indices have these numbers already")
