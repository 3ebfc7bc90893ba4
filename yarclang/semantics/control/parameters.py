"""The parameters of a SUB, and the arguments of a CALL."""

from __future__ import annotations

from collections.abc import Container

import numpy as np

from yarclang.diagnostics import Collector
from yarclang.hir import Output
from yarclang.robot.model import Robot
from yarclang.semantics.control.arguments import Given, names_in
from yarclang.semantics.control.matching import (
    arguments_by_name,
    matched,
    names_of_parameters,
    parameters_of,
    word_of,
)
from yarclang.semantics.declared.meanings import frame_may_be_declared, may_be_declared
from yarclang.semantics.files import Sub
from yarclang.semantics.names.frames import known_frame
from yarclang.semantics.names.scope import KINDS, Frame, Input, JointPosition, Named, Pose, Scope, Where
from yarclang.semantics.values.amounts import Amount, AmountError, no_unit
from yarclang.semantics.values.evaluate import EvaluationError, is_place, place_named
from yarclang.semantics.values.units import amount
from yarclang.source import SourceFile
from yarclang.subjects import unknown
from yarclang.syntax.ast import Computed, FrameName, Number, Parameter, Quantity, Statement, Value, Word
from yarclang.units import UNITS, Unit


def check_parameters(head: Statement, scope: Scope, robot: Robot, findings: Collector) -> None:
    """Check the names, units and defaults of a SUB's parameters.

    Args:
        head: the SUB line.
        scope: the names in scope at the SUB line.
        robot: the robot.
        findings: receives the findings.
    """
    seen = Scope(scope)
    for parameter in parameters_of(head):
        if isinstance(parameter, FrameName):
            if frame_may_be_declared(head, parameter, seen, findings):
                seen.declare_frame(parameter.name, Frame(np.eye(4), on_flange=False))
            continue
        word = word_of(parameter)
        if word is not None and may_be_declared(head, word, seen, robot, findings, may_hide=True):
            seen.declare(word.name, Amount(0.0), Where(findings.source, head.span(word.place)))
        if isinstance(parameter, Parameter) and (unit := parameter.unit) and unit.text.lower() not in UNITS:
            findings.add_error(no_unit(unit.text), head.span(unit.place))
        elif isinstance(parameter, Parameter) and parameter.default is not None:
            # A default can use the names that the SUB sees, but not the parameters before it.
            where = Where(findings.source, head.span(parameter.place))
            _bind_one(parameter, parameter.default, Scope(), head, scope, where, findings)


def bind(statement: Statement, scope: Scope, findings: Collector, sub: Sub) -> Scope | None:
    """Declare the parameters of a SUB with the arguments of a CALL as their values.

    Args:
        statement: the CALL.
        scope: the names in scope at the CALL.
        findings: the findings of the CALL's file; receives one for each argument that doesn't fit its
            parameter.
        sub: the SUB.

    Returns:
        The scope of the SUB's body, with the parameters; None if an argument doesn't fit.
    """
    head, source = sub.block.head, sub.file.findings.source
    given = matched(statement, head, findings)
    if given is None:
        return None
    inner, fine = Scope(sub.scope), True
    for parameter, value in zip(parameters_of(head), given, strict=True):
        where = Where(source, head.span(parameter.place))
        if value is None:
            fine &= _bind_default(parameter, inner, sub, where)
        else:
            fine &= _bind_one(parameter, value, inner, statement, scope, where, findings)
    return inner if fine else None


def bind_some(
    statement: Statement, scope: Scope, source: SourceFile, sub: Sub, names: Container[str]
) -> tuple[Scope, tuple[Named | None, ...]] | None:
    """Declare some parameters of a SUB with the arguments of a CALL as their values, without findings.

    Args:
        statement: the CALL.
        scope: the names in scope at the CALL.
        source: the CALL's file.
        sub: the SUB.
        names: the parameters, in upper case; frames are never declared.

    Returns:
        The scope of the SUB's body, in which these parameters are declared; and the meanings of the
        parameters. None if an argument doesn't fit its parameter.
    """
    head, silent = sub.block.head, Collector(source)
    given = matched(statement, head, silent)
    if given is None:
        return None
    inner, where = Scope(sub.scope), Where(source, head.whole_span)
    found: list[Named | None] = []
    for name, parameter, value in zip(names_of_parameters(head), parameters_of(head), given, strict=True):
        if name in names:
            if value is None:
                fine = _bind_default(parameter, inner, sub, where)
            else:
                fine = _bind_one(parameter, value, inner, statement, scope, where, silent)
            if not fine:
                return None
            found.append(inner.declared(name))
    return inner, tuple(found)


def _bind_default(parameter: Value, inner: Scope, sub: Sub, where: Where) -> bool:
    """Declare a parameter with its default value. A wrong default was already reported at the SUB."""
    assert isinstance(parameter, Parameter)
    assert parameter.default is not None
    silent = Collector(sub.file.findings.source)
    return _bind_one(parameter, parameter.default, inner, sub.block.head, sub.scope, where, silent)


def _bind_one(
    parameter: Value,
    value: Value,
    inner: Scope,
    statement: Statement,
    scope: Scope,
    where: Where,
    findings: Collector,
) -> bool:
    """Declare one parameter of a SUB with its argument as the value; add a finding if the argument is of
    another kind.

    Args:
        parameter: the parameter, in the SUB line.
        value: the argument, in the CALL.
        inner: the scope of the SUB's body; receives the parameter.
        statement: the CALL.
        scope: the names in scope at the CALL.
        where: place of the parameter's declaration.
        findings: the findings of the CALL's file.

    Returns:
        True if the argument fits.
    """
    span = statement.span(value.place)
    if isinstance(parameter, FrameName):
        if not isinstance(value, FrameName):
            message = f"the parameter {parameter.text} is a frame, and {value.text} is none"
            findings.add("Y0411", message, span, subject=unknown(value.text))
            return False
        frame = known_frame(statement, value, scope, findings)
        if frame is not None:
            inner.declare_frame(parameter.name, frame)
        return frame is not None
    word = parameter.word if isinstance(parameter, Parameter) else parameter
    unit = _unit_of(parameter)
    meaning: Named | None
    if isinstance(value, FrameName):
        findings.add("Y0411", f"{word.text} isn't a frame", span, subject=unknown(value.text))
        return False
    if isinstance(value, Word):
        meaning = scope.name(value.name)
        if isinstance(meaning, Amount):
            help_ = f"write ${value.text} for its value"
            findings.add("Y0411", f"{value.text} is a number", span, help_, subject=unknown(value.text))
            return False
        if not isinstance(meaning, JointPosition | Pose | Input | Output):
            known = sorted(set(scope.names(JointPosition, Pose, Input, Output)))
            subject = unknown(value.text, known)
            message = (
                f"{value.text} is {KINDS[type(meaning)]}" if meaning else f"no name {value.text} is declared"
            )
            findings.add("Y0411", message, span, subject.question, subject=subject)
            return False
        if unit is not None:
            message = f"{word.text} is a number of {unit.name}, not {KINDS[type(meaning)]}"
            findings.add("Y0411", message, span, subject=unknown(value.text))
            return False
    elif isinstance(value, Computed) and is_place(value.expression, scope):
        try:
            meaning = place_named(value.expression, scope)
        except EvaluationError as error:
            findings.add_error(error, statement.span(error.place))
            return False
        assert meaning is not None
        if unit is not None:
            message = f"{word.text} is a number of {unit.name}, not {KINDS[type(meaning)]}"
            findings.add("Y0411", message, span, subject=unknown(value.text))
            return False
    elif isinstance(value, Number | Computed | Quantity):
        found = amount(value, scope, statement, findings)
        if found is None:
            return False
        try:
            meaning = found if unit is None else Amount(found.in_unit(unit), unit)
        except AmountError as error:
            message = f"{word.text}: {error.message}"
            findings.add("Y0411", message, span, error.help, subject=unknown(value.text))
            return False
    else:
        findings.add("Y0411", f"`{value.text}` can't be an argument", span, subject=unknown(value.text))
        return False
    inner.declare(word.text.upper(), meaning, where)
    return True


def given_by(
    statement: Statement, caller: SourceFile, head: Statement, source: SourceFile, outer: Given
) -> Given:
    """Return texts about the arguments of a CALL, for findings in the SUB, by the name of the parameter.

    Args:
        statement: the CALL.
        caller: the CALL's file.
        head: the SUB's first line.
        source: the SUB's file.
        outer: texts about the arguments of the SUB around the CALL. They are appended if the CALL's own
            arguments use that SUB's parameters.
    """
    told: dict[str, str] = {}
    given = arguments_by_name(statement, head)
    for parameter in parameters_of(head):
        word = word_of(parameter)
        if word is None:
            continue
        if (value := given.get(word.name)) is not None:
            line = Where(caller, statement.span(value.place)).seen_from(source)
            said = [f"{word.text} is `{value.text}` in {line}"]
            if isinstance(value, Computed):
                said += (outer[name] for name in dict.fromkeys(names_in(value.expression)) if name in outer)
            told[word.name] = ", and there ".join(said)
        elif isinstance(parameter, Parameter) and parameter.default is not None:
            told[word.name] = f"{word.text} is `{parameter.default.text}` by default"
    return told


def _unit_of(parameter: Value) -> Unit | None:
    if not isinstance(parameter, Parameter) or parameter.unit is None:
        return None
    return UNITS.get(parameter.unit.text.lower())
