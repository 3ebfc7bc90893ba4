"""Reuse the results of motions that were planned before. The motion and its start must be equal, but its
command may have moved to another line of the file.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import fields, replace
from typing import TypeVar

from yarclang.diagnostics import Collector, Diagnostic, Edit
from yarclang.hir import Origin
from yarclang.memory import Forgetful, Memory
from yarclang.source import Span

T = TypeVar("T")


def told_before(
    memory: Memory,
    key: Hashable,
    origin: Origin,
    findings: Collector,
    make: Callable[[], T],
    *,
    may_look_around: bool = False,
) -> T:
    """Return the earlier result that is stored under a key, and repeat the findings that came with it. If
    there is none, compute the result and its findings.

    Args:
        memory: stores results and findings; the places of findings are relative to the command's line.
        key: everything on which the result depends, without the place of the command.
        origin: the command. Findings may quote its text, so they are repeated only if the text is the same.
        findings: receives the findings, new or repeated.
        make: function that computes the result and adds findings about this command only.
        may_look_around: True if the findings may depend on other lines. A result with such findings isn't
            stored.
    """
    if isinstance(memory, Forgetful):
        return make()
    line = origin.span.line
    kept: tuple[T, tuple[Diagnostic, ...], int, Hashable] | None = memory.get(key)
    if kept is not None:
        value, stored, kept_line, spelling = kept
        if not stored:
            return value
        if spelling == _spelling(origin):
            findings.found += [
                _moved(finding, origin, findings.place, line - kept_line) for finding in stored
            ]
            return value
    before = len(findings.found)
    value = make()
    added = findings.found[before:]
    # Keep a result only if its findings don't depend on other lines.
    if all(_is_of_command(finding, origin) for finding in added) and not (added and may_look_around):
        stored = tuple(replace(finding, source=None) for finding in added)  # don't store the source text
        memory.keep(key, (value, stored, line, _spelling(origin) if stored else None))
    return value


def _spelling(origin: Origin) -> Hashable:
    """Return everything of a command's origin that messages may quote, except its file and its line
    number.
    """
    line = origin.span.line
    places: list[Hashable] = [
        None if one is None else (one.line - line, one.column, one.end_line - line, one.end_column)
        for one in (getattr(origin, name) for name in _SPANS)
    ]
    text = origin.source.lines[line - 1 : _last_line(origin)]
    units = (origin.time_unit, origin.length_unit, origin.angle_unit)
    return origin.index, origin.name, origin.place, *units, origin.time_given, *places, *text


_SPANS = tuple(entry.name for entry in fields(Origin) if "Span" in str(entry.type))


def _last_line(origin: Origin) -> int:
    return max(origin.span.end_line, origin.end_span.end_line if origin.end_span else 0)


def _is_of_command(one: Diagnostic, origin: Origin) -> bool:
    """Return True if a finding concerns only the lines of its command. Any other finding may change when
    other lines are edited.
    """
    spans = [edit.span for edit in one.fix.edits] if one.fix else []
    spans += [one.span] if one.span else []
    last = _last_line(origin)
    return one.source is origin.source and all(
        origin.span.line <= span.line and span.end_line <= last for span in spans
    )


def _moved(one: Diagnostic, origin: Origin, place: str, lines: int) -> Diagnostic:
    """Return a finding, moved down by `lines` lines together with its command."""
    span = None if one.span is None else _shifted(one.span, lines)
    fix = one.fix
    if fix is not None and lines:
        fix = replace(fix, edits=tuple(Edit(_shifted(edit.span, lines), edit.text) for edit in fix.edits))
    return replace(one, source=origin.source, span=span, fix=fix, place=place)


def _shifted(span: Span, lines: int) -> Span:
    return Span(span.line + lines, span.column, span.end_line + lines, span.end_column)
