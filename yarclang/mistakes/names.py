"""Recognise unknown names: suggest the intended name, or point out a declaration that comes too late."""

from __future__ import annotations

import re
from dataclasses import replace

from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.mistakes.line import Around
from yarclang.source import SourceFile, Span
from yarclang.subjects import Name
from yarclang.suggestions import is_slip

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")


def with_name(source: SourceFile, finding: Diagnostic, name: str) -> Fix | None:
    """Return the fix that replaces the name at a finding's place by another; None if the place isn't exactly
    one name.

    Args:
        source: the program's file.
        finding: the finding about the name.
        name: the new name.
    """
    span = finding.span
    if span is None or span.line != span.end_line:
        return None
    written = source.line(span.line)[span.column - 1 : span.end_column - 1]
    words = list(_NAME.finditer(written))
    if len(words) != 1:
        return None
    start = span.column + words[0].start()
    return Fix(f"write {name}", (Edit(Span.on_line(span.line, start, span.column + words[0].end()), name),))


def named(one: Diagnostic, source: SourceFile, around: Around) -> Diagnostic:
    """Improve a finding about an unknown name: add a fix, or the line of the name's declaration.

    If the name is declared further down, the help names that line. If it looks like a typing error of exactly
    one known name, the finding gets a fix. Any other finding is returned unchanged.
    """
    if one.fix is not None or not isinstance(one.subject, Name) or one.span is None:
        return one
    if (line := around.lines_of.get(one.subject.name, 0)) > one.span.line:
        return replace(
            one, help=f"{one.subject.name} is declared only in line {line}: use it after that line"
        )
    meant = one.subject.meant
    if meant and not one.subject.others and is_slip(one.subject.name, meant):
        return replace(one, fix=with_name(source, one, meant))
    return one
