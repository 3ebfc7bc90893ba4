"""Carry out INPUT and OUTPUT: declare names for variables of the controller, groups of bits and analogue
signals.
"""

from __future__ import annotations

import re

from yarclang.decisions import DECIMALS, MOST_BITS, group_of, is_group, is_printed, largest_of
from yarclang.diagnostics import Collector
from yarclang.hir import Output, Signal
from yarclang.robot.model import Robot
from yarclang.semantics.declared.meanings import may_be_declared
from yarclang.semantics.declared.variables import Signals
from yarclang.semantics.files import values_of
from yarclang.semantics.names.scope import (
    Input,
    Scope,
    Where,
)
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.values.amounts import AmountError
from yarclang.semantics.values.steps import steps_of
from yarclang.semantics.values.units import amount, number_fault
from yarclang.syntax.ast import Statement, Value, Word

_GROUP = re.compile(r"([A-Z]+)([0-9]{1,6})\.\.([A-Z]+)([0-9]{1,6})")


def declare_signal(
    statement: Statement, scope: Scope, robot: Robot, signals: Signals, findings: Collector
) -> tuple[Output, ...]:
    """Declare an input or output, such as INPUT DOOR M11 or OUTPUT GLUE M1 OFF, or a group of bits, such as
    INPUT JOB M70..M77.

    Returns:
        The output, or each bit of a group of outputs; empty for an input or if the line has errors.
    """
    kind = statement.name.name
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    values = values_of(statement)
    step, values = _step(values, scope, statement, findings)
    most = 3 if kind == "OUTPUT" else 2
    words = values[:2]
    if not 2 <= len(values) <= most or not all(isinstance(value, Word) for value in words):
        example = "INPUT DOOR M11" if kind == "INPUT" else "OUTPUT GLUE M1 OFF"
        message = f"{kind} needs a name and a variable of the controller"
        findings.add("Y0401", message, statement.whole_span, f"for example {example}")
        return ()
    word, variable = words
    assert isinstance(word, Word)
    assert isinstance(variable, Word)
    if not may_be_declared(statement, word, scope, robot, findings):
        return ()
    found = _variables(variable, statement, robot, findings)
    if not found:
        return ()
    signal = Signal(word.name, group_of(found))
    where = Where(findings.source, statement.span(word.place))
    if step is not None and not is_group(signal.variable):
        message = f"{word.text} is a single bit, and STEP needs a group of bits"
        findings.add(
            "Y0470", message, statement.span(variable.place), "write a group of bits, such as M80..M91"
        )
        step = None
    if kind == "INPUT":
        scope.declare(word.name, Input(signal, step), where)
        # One finding is enough for a group whose bits belong to another signal.
        findings.found += [one for bit in signal.bits for one in signals.add("input", bit, None, where)][:1]
        return ()
    safe = state_value(values[2], scope, statement, findings) if len(values) == 3 else None
    if safe is not None and step is not None:
        try:
            safe = steps_of(safe, step, word.text)
        except AmountError as error:
            findings.add_error(error, statement.span(values[2].place))
            safe = None
    if safe is not None and (fault := group_fault(signal, safe)):
        findings.add(
            "Y0470", fault, statement.span(values[2].place), "correct the number, or declare more bits"
        )
        safe = None
    scope.declare(word.name, Output(signal, safe, step), where)
    outputs = tuple(
        Output(bit, safe if not is_group(signal.variable) or safe is None else float(int(safe) >> place & 1))
        for place, bit in enumerate(signal.bits)
    )
    findings.found += [
        found for one in outputs for found in signals.add("output", one.signal, one.safe, where)
    ][:1]
    return outputs


def _step(
    values: list[Value], scope: Scope, statement: Statement, findings: Collector
) -> tuple[float | None, list[Value]]:
    """Find STEP in a declaration of a signal.

    Returns:
        The size of one step of the analogue signal (None without STEP), and the values in the line without
        STEP and this size.
    """
    place = next((at for at, one in enumerate(values) if isinstance(one, Word) and one.name == "STEP"), None)
    if place is None or place < 2:
        return None, values
    rest = [*values[:place], *values[place + 2 :]]
    number = state_value(values[place + 1], scope, statement, findings) if place + 1 < len(values) else None
    if number is None or number <= 0.0:
        message = "STEP needs the size of one step, above 0"
        findings.add(
            "Y0472",
            message,
            statement.span(values[place].place),
            "for example INPUT PRESSURE M80..M91 STEP 0.01",
        )
        return None, rest
    return number, rest


def group_fault(signal: Signal, number: float) -> str:
    """Return the message that a group of bits can't hold a number. Return an empty text if it can, or if the
    signal isn't a group.
    """
    if not is_group(signal.variable):
        return ""
    largest = largest_of(signal.variable)
    if number.is_integer() and 0 <= number <= largest:
        return ""
    return (
        f"{signal.name} has {len(signal.bits)} bits: it is an integer from 0 to {largest}, and can't be "
        f"{number:.15g}"
    )


def _variables(word: Word, statement: Statement, robot: Robot, findings: Collector) -> tuple[str, ...]:
    """Return the controller's variables that a word such as M11 or M70..M77 names; empty with a finding if
    the word is wrong.
    """
    span = statement.span(word.place)
    names = [word.name]
    if ".." in word.name:
        group = _GROUP.fullmatch(word.name)
        first, last = (int(group[2]), int(group[4])) if group is not None else (0, 0)
        if group is None or group[1] != group[3] or not first < last < first + MOST_BITS:
            message = (
                f"{word.text} is no group of bits: a group has 2 to {MOST_BITS} variables of one letter, "
                "the lowest first"
            )
            findings.add("Y0470", message, span, "for example INPUT JOB M70..M77")
            return ()
        names = [f"{group[1]}{number}" for number in range(first, last + 1)]
    found: list[str] = []
    for name in names:
        one = robot.controller.signal(name)
        if one.name is None:
            text = word.text if len(names) == 1 else f"{name} of {word.text}"
            findings.add("Y0413", f"{text} {one.fault}", span, one.remedy)
            return ()
        found.append(one.name)
    return tuple(found)


def state_value(value: Value, scope: Scope, statement: Statement, findings: Collector) -> float | None:
    """Return the state of a signal as a number. The program writes the state as ON, OFF or a number; for any
    other value, return None with a finding.
    """
    if isinstance(value, Word) and value.name in ("ON", "OFF"):
        return float(value.name == "ON")
    span = statement.span(value.place)
    if (fault := number_fault(value)) is not None:
        findings.add("Y0402", f"`{value.text}` is neither ON nor OFF nor a number", span, fault[2])
        return None
    found = amount(value, scope, statement, findings)
    if found is None:
        return None
    try:
        number = found.plain("the value of an input or output")
    except AmountError as error:
        findings.add_error(error, span)
        return None
    if not is_printed(number):
        message = f"{number:.15g} has more than {DECIMALS} decimals, more than the controller's text can have"
        findings.add("Y0434", message, span, f"round it: {round(number, DECIMALS):.15g}")
        return None
    return number
