"""Resolve names of inputs and outputs at the place where they are used."""

from __future__ import annotations

from yarclang.diagnostics import Collector
from yarclang.hir import Output, Signal
from yarclang.semantics.names.frames import Placed
from yarclang.semantics.names.scope import KINDS, Input, Scope
from yarclang.subjects import unknown
from yarclang.syntax.ast import Value, Word


def input_named(value: Value, scope: Scope, statement: Placed, findings: Collector) -> Signal | None:
    """Return the input that a value names; None with a finding if it names none."""
    found = scope.name(value.name) if isinstance(value, Word) else None
    if isinstance(found, Input):
        return found.signal
    _wrong(value, found, (Input,), "input", "INPUT DOOR M11", scope, statement, findings)
    return None


def output_named(value: Value, scope: Scope, statement: Placed, findings: Collector) -> Signal | None:
    """Return the output that a value names; None with a finding if it names none."""
    found = scope.name(value.name) if isinstance(value, Word) else None
    if isinstance(found, Output):
        return found.signal
    _wrong(value, found, (Output,), "output", "OUTPUT GLUE M1 OFF", scope, statement, findings)
    return None


def signal_named(value: Value, scope: Scope, statement: Placed, findings: Collector) -> Signal | None:
    """Return the input or output that a value names; None with a finding if it names none."""
    found = scope.name(value.name) if isinstance(value, Word) else None
    if isinstance(found, Input | Output):
        return found.signal
    _wrong(value, found, (Input, Output), "input or output", "INPUT DOOR M11", scope, statement, findings)
    return None


def _wrong(
    value: Value,
    found: object,
    kinds: tuple[type, ...],
    what: str,
    example: str,
    scope: Scope,
    statement: Placed,
    findings: Collector,
) -> None:
    span = statement.span(value.place)
    if found is not None:
        findings.add("Y0209", f"{value.text} is {KINDS[type(found)]}, not an {what}", span)
        return
    known = sorted(set(scope.names(*kinds)))
    subject = unknown(value.text, known)
    help_ = subject.question or (f"there are {', '.join(known)}" if known else f"declare it: {example}")
    findings.add("Y0210", f"no {what} is named {value.text}", span, help_, subject=subject)
