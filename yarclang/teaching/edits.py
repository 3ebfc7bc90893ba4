"""Changes of a program's text line by line, and the small replacements of text that result from them. All
other bytes stay unchanged.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

from yarclang.assist.changes import changes_to
from yarclang.assist.sketch import Sketch, sketch_of
from yarclang.diagnostics import Edit
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile, Span, lines_with_ends
from yarclang.syntax.ast import Statement
from yarclang.syntax.blocks import arrange
from yarclang.syntax.lines import code_of

_ENDS = ("\r\n", "\n", "\r")


@dataclass(frozen=True, slots=True)
class Edited:
    """A change of a program's text.

    Attributes:
        edits: replacements at places of the old text, in order and without overlaps.
        line: line of the cursor in the new text.
        what: description of the change, in words.
    """

    edits: tuple[Edit, ...]
    line: int
    what: str


def applied(text: str, edits: Iterable[Edit]) -> str:
    """Return a text after some edits. The places of the edits are those of the old text."""
    lines = lines_with_ends(text)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))
    made, done = list[str](), 0
    for edit in sorted(edits, key=lambda one: one.span):
        span = edit.span
        begin = starts[span.line - 1] + span.column - 1
        made += [text[done:begin], edit.text]
        done = starts[span.end_line - 1] + span.end_column - 1
    return "".join((*made, text[done:]))


class Program:
    """The text of a program, as statements and as lines. The text may have errors.

    Args:
        source: the text.
    """

    def __init__(self, source: SourceFile) -> None:
        self.source = source
        self.sketch: Sketch = sketch_of(source)
        self.ended = lines_with_ends(source.text)

    @property
    def size(self) -> int:
        """Return the number of lines."""
        return len(self.ended)

    def content(self, line: int) -> str:
        """Return a line (from 1) without its end."""
        return self.source.line(line)

    @cached_property
    def end(self) -> str:
        """Return the line ending that is most frequent in the first lines: LF, CRLF or CR."""
        ends = [_end(line) for line in self.ended[:100]]
        return max(_ENDS, key=ends.count) if any(ends) else "\n"

    @cached_property
    def faults(self) -> tuple[int, int]:
        """Return the number of lines that can't be parsed, and of incomplete blocks."""
        return len(self.sketch.module.unreadable_lines), len(arrange(self.sketch.module).diagnostics)

    @cached_property
    def unreadable(self) -> dict[int, int]:
        """Return the statements that can't be parsed: for each, the number of its first line and its
        number of lines.
        """
        module = self.sketch.module
        known = {one.line for one in module.statements} | {line for line, _ in module.comment_lines}
        firsts = known | set(module.unreadable_lines)
        return {line: self._rows(line, firsts) for line in module.unreadable_lines}

    def _rows(self, line: int, firsts: set[int]) -> int:
        last = ahead = line
        while code_of(self.content(last)).rstrip().endswith(";"):
            ahead += 1
            if ahead > self.size or ahead in firsts:
                break
            if code_of(self.content(ahead)).strip():
                last = ahead
        return last - line + 1

    @cached_property
    def lost(self) -> dict[tuple[str, bool], list[int]]:
        """Return the names that are used without a declaration above them. The keys are pairs (name, True for
        a frame), the values are the numbers of the lines that use the name.
        """
        found: dict[tuple[str, bool], list[int]] = {}
        for use in self.sketch.names.uses:
            if use.symbol is None and not use.module:
                found.setdefault((use.name, use.is_frame), []).append(use.span.line)
        return found

    def check_line(self, line: int, least: int = 1) -> None:
        """Check that the program has a line with a given number.

        Args:
            line: number of the line.
            least: smallest number that is allowed.

        Raises:
            Trouble: there is no such line.
        """
        if not least <= line <= self.size:
            raise Trouble(
                f"there is no line {line}: the text has {self.size}", "list the program again", "line"
            )

    def statement(self, line: int) -> Statement:
        """Return the statement in a line.

        Raises:
            Trouble: there is no statement in the line, or it can't be parsed.
        """
        self.check_line(line)
        found = self.sketch.statement_at(line)
        if found is None:
            raise Trouble(
                f"line {line} is no command that can be read: {self.content(line).strip()[:60]!r}",
                "correct the line in the text first",
                "unreadable",
            )
        return found

    def last_row(self, line: int) -> int:
        """Return the number of the last line of the statement that contains a line. If no statement contains
        the line, return the line's own number.
        """
        found = self.sketch.statement_at(line)
        if found is not None:
            return found.line + found.rows - 1
        first = next((one for one, rows in self.unreadable.items() if one <= line < one + rows), None)
        return line if first is None else first + self.unreadable[first] - 1

    def indent(self, line: int) -> str:
        """Return the indentation of a line."""
        text = self.content(line)
        return text[: len(text) - len(text.lstrip(" \t"))]


@dataclass(slots=True)
class Draft:
    """Changes of a program, collected before they are made. Line numbers are those of the old text.

    Attributes:
        program: the program to change.
        changed: new contents of lines, by line number.
        added: rows to insert after a line, without line endings, by line number; 0 is the beginning.
        gone: numbers of the lines to remove.
        notes: remarks for the description of the change.
    """

    program: Program
    changed: dict[int, str] = field(default_factory=dict)
    added: dict[int, list[str]] = field(default_factory=dict)
    gone: set[int] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)

    def content(self, line: int) -> str:
        """Return the content of a line with the changes so far."""
        return self.changed.get(line, self.program.content(line))

    def add(self, after: int, *rows: str) -> None:
        """Add rows after a line, below rows that were added there before."""
        self.added.setdefault(after, []).extend(rows)

    def new_line(self, after: int) -> int:
        """Return the line number, in the new text, of the first row that was added after a line."""
        return 1 + sum(line not in self.gone for line in range(1, after + 1)) + self._added_before(after)

    def moved_line(self, line: int) -> int:
        """Return the number of a line in the new text."""
        return sum(one not in self.gone for one in range(1, line + 1)) + self._added_before(line)

    def _added_before(self, line: int) -> int:
        return sum(len(rows) for after, rows in self.added.items() if after < line)

    def finished(self, line: int, what: str) -> Edited:
        """Check the changed program, and return the change of its text.

        Args:
            line: line of the cursor in the new text.
            what: description of the change.

        Raises:
            Trouble: a line couldn't be parsed any more, or a block would be incomplete; nothing is changed.
        """
        text, edits = self._text(), self._edits()
        # If the edits don't give the changed text, for example because the last line has no line ending,
        # compute the edits anew from both texts.
        if applied(self.program.source.text, edits) != text:
            edits = changes_to(self.program.source, text)
        after = Program(SourceFile(self.program.source.name, text))
        self._check(after)
        notes = [*self.notes, *_losses(self.program, after)]
        line = max(1, min(line, after.size))
        return Edited(edits, line, "; ".join((what, *notes)))

    def _check(self, after: Program) -> None:
        before = self.program
        if after.faults[0] > before.faults[0]:
            known = {before.content(one) for one in before.unreadable}
            where = next((one for one in after.unreadable if after.content(one) not in known), 1)
            raise Trouble(
                f"after this change line {where} couldn't be read: {after.content(where).strip()[:60]!r}",
                "correct the lines above first; nothing was changed",
                "unreadable",
            )
        if after.faults[1] > before.faults[1]:
            finding = arrange(after.sketch.module).diagnostics[-1]
            raise Trouble(
                f"this change would break a block: {finding.message}", "nothing was changed", "block"
            )

    def _text(self) -> str:
        program = self.program
        parts: list[str] = []
        parts += [row + program.end for row in self.added.get(0, ())]
        for line, old in enumerate(program.ended, 1):
            if line not in self.gone:
                parts.append(self.content(line) + _end(old))
            parts += [row + program.end for row in self.added.get(line, ())]
        open_end = bool(program.ended) and not _end(program.ended[-1])
        for number, row in enumerate(parts[:-1]):
            if not _end(row):
                parts[number] = row + program.end
        if parts and open_end:
            parts[-1] = parts[-1].removesuffix(_end(parts[-1]))
        return "".join(parts)

    def _edits(self) -> tuple[Edit, ...]:
        program, edits = self.program, list[Edit]()
        added = {after: "".join(row + program.end for row in rows) for after, rows in self.added.items()}
        for line, text in self.changed.items():
            if line not in self.gone and (edit := _inside(line, program.content(line), text)):
                edits.append(edit)
        for first, last in _stretches(self.gone):
            put = "".join(added.pop(after, "") for after in range(first - 1, last + 1))
            edits.append(Edit(Span(first, 1, last + 1, 1), put))
        for after, put in added.items():
            if after == program.size and program.ended and not _end(program.ended[-1]):
                column = len(program.ended[-1]) + 1
                edits.append(
                    Edit(Span(after, column, after, column), program.end + put.removesuffix(program.end))
                )
            else:
                edits.append(Edit(Span(after + 1, 1, after + 1, 1), put))
        if any(edit.span.end_line > program.size + 1 for edit in edits) or self._is_open_end():
            return changes_to(program.source, self._text())
        return tuple(sorted(edits, key=lambda one: one.span))

    def _is_open_end(self) -> bool:
        """Return True if the last line is removed and has no line ending."""
        program = self.program
        return program.size in self.gone and not _end(program.ended[-1])


def _end(line: str) -> str:
    return next((end for end in _ENDS if line.endswith(end)), "")


def _stretches(lines: set[int]) -> Iterable[tuple[int, int]]:
    """Yield the first and the last line of each run of consecutive lines."""
    ordered = sorted(lines)
    first = 0
    for number, line in enumerate(ordered):
        if number + 1 == len(ordered) or ordered[number + 1] != line + 1:
            yield ordered[first], line
            first = number + 1


def _inside(line: int, old: str, new: str) -> Edit | None:
    """Return the smallest edit that turns a line into another; None if both are equal."""
    if old == new:
        return None
    same = _alike(old, new)
    tail = _alike(old[same:][::-1], new[same:][::-1])
    span = Span.on_line(line, same + 1, len(old) - tail + 1)
    return Edit(span, new[same : len(new) - tail])


def _alike(one: str, other: str) -> int:
    """Return the length of the common prefix of two texts."""
    shorter = min(len(one), len(other))
    return next((at for at in range(shorter) if one[at] != other[at]), shorter)


def _losses(before: Program, after: Program) -> Iterable[str]:
    """Yield a message for each name whose declaration the change has removed, although lines of the program
    still use the name.
    """
    for (name, is_frame), lines in after.lost.items():
        if len(lines) > len(before.lost.get((name, is_frame), ())) and before.sketch.names.declared(
            name, is_frame
        ):
            shown = f"{{{name}}}" if is_frame else name
            others = f" and {len(lines) - 1} more" * (len(lines) > 1)
            yield f"{shown} is used in line {lines[0]}{others}, where it would no longer be declared"
