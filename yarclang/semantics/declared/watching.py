"""ON: declare an input that holds the motion."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

from yarclang.decisions import DECIMALS, MOST_WATCHES, Watch, is_group
from yarclang.diagnostics import Collector
from yarclang.semantics.declared.signals import state_value
from yarclang.semantics.files import values_of
from yarclang.semantics.names.scope import Scope
from yarclang.semantics.names.signals import input_named
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.syntax.ast import Statement, Word
from yarclang.words.registry import word_specs

REACTIONS = MappingProxyType({"HOLD": "the motion is held on its path, and a person says when it goes on"})
"""Reactions of the robot while a watched input is in its state."""


def declare_watch(
    statement: Statement, scope: Scope, watches: Sequence[Watch], findings: Collector
) -> Watch | None:
    """Read ON CURTAIN OFF HOLD.

    Args:
        statement: the line.
        scope: the names that are known there.
        watches: watched inputs of the lines before.
        findings: receives the findings.

    Returns:
        The watched input; None with a finding if the line is wrong.
    """
    before = len(findings.found)
    refuse_parts(statement, NOT_FOR_BLOCKS, findings)
    spec, values = word_specs()["ON"], values_of(statement)
    last = values[-1] if values else None
    if len(values) != len(spec.slots) or not isinstance(last, Word) or last.name not in REACTIONS:
        message, help_ = f"ON wants {spec.wants}", f"for example {spec.example}"
        findings.add("Y0401", message, statement.whole_span, help_)
        return None
    signal = input_named(values[0], scope, statement, findings)
    value = state_value(values[1], scope, statement, findings)
    if signal is None or value is None or any(one.is_error for one in findings.found[before:]):
        return None
    span = statement.span(values[0].place)
    if is_group(signal.variable):
        message = f"{signal.name} is a group of {len(signal.bits)} bits, and ON watches a single one"
        findings.add("Y0471", message, span, "declare the bit by a name of its own")
        return None
    watch = Watch(signal.variable, round(value, DECIMALS) + 0.0, signal.name)
    if any((one.variable, one.value) == (watch.variable, watch.value) for one in watches):
        message = f"{signal.name} is watched for this state already"
        findings.add("Y0206", message, span, "leave one of both lines")
        return None
    if len(watches) == MOST_WATCHES:
        message = f"a program watches {MOST_WATCHES} inputs at most"
        findings.add(
            "Y0401", message, span, "let the controller or the cell join some of them into one input"
        )
        return None
    return watch
