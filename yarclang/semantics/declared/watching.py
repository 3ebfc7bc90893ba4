"""Carry out ON: declare an input that holds the motion."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

from yarclang.decisions import DECIMALS, MOST_WATCHES, Watch, is_group
from yarclang.diagnostics import Collector
from yarclang.hir import Dwell, Gap, JointMove, LineMove, Motion, SetOutput, Step
from yarclang.semantics.declared.signals import state_value
from yarclang.semantics.files import values_of
from yarclang.semantics.names.scope import Scope
from yarclang.semantics.names.signals import input_named
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.source import Span
from yarclang.syntax.ast import Statement, Word
from yarclang.words.registry import word_specs

REACTIONS = MappingProxyType(
    {
        "HOLD": "the motion is held on its path until a person resumes it",
        "CALL": (
            "the motion is held on its path; after a person confirms, the robot returns to the start of "
            "the motion and carries out a SUB"
        ),
    }
)
"""Words for the robot's reaction while a watched input has the watched state."""


def declare_watch(
    statement: Statement, scope: Scope, watches: Sequence[Watch], findings: Collector
) -> Watch | None:
    """Read a line such as ON CURTAIN OFF HOLD, or ON CURTAIN OFF CALL AWAY.

    Args:
        statement: the line.
        scope: the names in scope at this line.
        watches: watched inputs of the previous lines.
        findings: receives the findings.

    Returns:
        The watched input; None with a finding if the line is wrong.
    """
    before = len(findings.found)
    refuse_parts(statement, NOT_FOR_BLOCKS, findings)
    spec, values = word_specs()["ON"], values_of(statement)
    reaction, *named = [one.name if isinstance(one, Word) else "" for one in values[2:]] or [""]
    if reaction not in REACTIONS or len(named) != (reaction == "CALL") or not all(named):
        message, help_ = f"ON needs {spec.wants}", f"for example {spec.example}, or ON CURTAIN OFF CALL AWAY"
        if reaction == "CALL" and named:
            help_ = "the SUB of an ON has no parameters: write the values in the SUB"
        findings.add("Y0401", message, statement.whole_span, help_)
        return None
    signal = input_named(values[0], scope, statement, findings)
    value = state_value(values[1], scope, statement, findings)
    if signal is None or value is None or any(one.is_error for one in findings.found[before:]):
        return None
    span = statement.span(values[0].place)
    if is_group(signal.variable):
        message = f"{signal.name} is a group of {len(signal.bits)} bits, and ON watches a single bit"
        findings.add("Y0471", message, span, "declare this bit under a name of its own")
        return None
    watch = Watch(signal.variable, round(value, DECIMALS) + 0.0, signal.name, *named)
    if any((one.variable, one.value) == (watch.variable, watch.value) for one in watches):
        message = f"{signal.name} is already watched for this state"
        findings.add("Y0206", message, span, "remove one of the two lines")
        return None
    if len(watches) == MOST_WATCHES:
        message = f"a program watches {MOST_WATCHES} inputs at most"
        findings.add("Y0401", message, span, "combine several of them into one input of the controller")
        return None
    return watch


def check_way_out(steps: Sequence[Step], name: str, span: Span, findings: Collector) -> bool:
    """Check the SUB by which the robot withdraws after an ON has stopped it. Only SETs of outputs, DWELLs,
    and motions without UNTIL are allowed in it, so that it can be planned as a whole from the robot's
    position.

    Args:
        steps: the steps of the SUB that the ON calls.
        name: the SUB.
        span: place of the ON.
        findings: receives the findings.

    Returns:
        False with a finding if the SUB has other steps, or no motion.
    """
    for step in steps:
        if isinstance(step, Gap):
            return False  # its error was already reported
        is_search = isinstance(step, JointMove | LineMove) and step.search is not None
        if is_search or not isinstance(step, Motion | SetOutput | Dwell):
            what = f"{step.origin.label} " if step.origin.label else ""
            what += "UNTIL" if is_search else step.origin.name
            message = (
                f"{name} has {what}: the SUB of an ON may have only motions, SET of outputs and WAIT [t]"
            )
            findings.add("Y0478", message, span, "move this line into the program that is run next")
            return False
    if not any(isinstance(step, Motion) for step in steps):
        message = f"{name} has no motion: the robot can't leave by this SUB"
        findings.add("Y0478", message, span, "add a motion to the SUB, or write HOLD instead of CALL")
        return False
    return True
