"""Run checks that never raise an exception. An exception in a stage becomes a finding about the program, at
the statement that was being processed if it is known.
"""

from __future__ import annotations

from yarclang.diagnostics import Diagnostic
from yarclang.hir import Origin
from yarclang.internal_errors import frames_of, internal_error
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Statement


def failure(error: Exception, source: SourceFile | None = None) -> Diagnostic:
    """Return a finding for an exception that ended a stage.

    Args:
        error: the exception, with its traceback.
        source: the program's file, if there is one.
    """
    found = _statement_of(error, source)
    return internal_error(error, *(found or (source, None)))


def _statement_of(error: Exception, source: SourceFile | None) -> tuple[SourceFile, Span] | None:
    """Return the statement that was being processed when an exception was raised: the statement in a local
    variable of the innermost function that has a statement.
    """
    for frame, _ in reversed(list(frames_of(error))):
        for value in list(frame.f_locals.values()):
            origin = value if isinstance(value, Origin) else _origin_of(value)
            if origin is not None:
                return origin.source, origin.span
            if isinstance(value, Statement) and source is not None and _is_in(value, source):
                return source, value.whole_span
    return None


def _origin_of(value: object) -> Origin | None:
    """Return the origin of a program's step; None for anything else."""
    if type(value).__module__ != Origin.__module__:
        return None
    origin = getattr(value, "origin", None)
    return origin if isinstance(origin, Origin) else None


def _is_in(statement: Statement, source: SourceFile) -> bool:
    """Return True if a statement belongs to this file: the file must have the statement's name at the
    statement's place. (A statement of a module may have the same line number.)
    """
    name = statement.name
    line = source.line(statement.line + name.place.row)
    return line[name.place.start - 1 : name.place.end - 1] == name.text
