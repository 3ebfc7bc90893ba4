"""Commands that move nothing: WAIT, SET, HOLD, and the heads of WHEN."""

from __future__ import annotations

from yarclang.diagnostics import Collector
from yarclang.hir import Dwell, Hold, Origin, SetOutput, Step, WaitInput, When
from yarclang.semantics.amounts import AmountError, missing_unit
from yarclang.semantics.context import Defaults
from yarclang.semantics.files import values_of
from yarclang.semantics.naming import state_value
from yarclang.semantics.parts import refuse_parts
from yarclang.semantics.scope import Scope
from yarclang.semantics.signal_names import input_named, output_named
from yarclang.semantics.to_hir import origin_of
from yarclang.semantics.units import amount, resolve_units
from yarclang.subjects import LeftOut
from yarclang.syntax.ast import Computed, Number, Statement, Text

LONGEST_WAIT = 3600.0
"""The controller's timer counts no further by far [s]."""


def read_action(statement: Statement, scope: Scope, defaults: Defaults, findings: Collector) -> Step | None:
    """WAIT, SET or HOLD; None with findings where it can't be understood."""
    origin = origin_of(statement, statement.name.name, findings)
    before = len(findings.found)
    step: Step | None
    match statement.name.name:
        case "WAIT":
            step = _wait(statement, origin, scope, defaults, findings)
        case "SET":
            step = _set(statement, origin, scope, findings)
        case _:
            step = _hold(statement, origin, findings)
    return None if any(found.is_error for found in findings.found[before:]) else step


def read_when(statement: Statement, scope: Scope, findings: Collector) -> When | None:
    """The head of a WHEN."""
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    values = values_of(statement)
    if len(values) != 2:
        message = "WHEN wants an input and what it is"
        findings.add("Y0401", message, statement.whole_span, "for example WHEN DOOR OFF")
        return None
    signal = input_named(values[0], scope, statement, findings)
    value = state_value(values[1], scope, statement, findings)
    if signal is None or value is None:
        return None
    return When(origin_of(statement, "WHEN", findings), signal, value)


def _wait(
    statement: Statement, origin: Origin, scope: Scope, defaults: Defaults, findings: Collector
) -> Step | None:
    refuse_parts(statement, ("a moving frame", "a base frame", "options"), findings)
    values = values_of(statement)
    if values and len(values) != 2:
        message = "WAIT wants a time, or an input and what it shall be"
        findings.add(
            "Y0401", message, statement.whole_span, "for example WAIT [2] (s), or WAIT DOOR ON [5] (s)"
        )
        return None
    seconds = _seconds(statement, scope, defaults, findings)
    if not values:
        if statement.time is None:
            findings.add(
                "Y0406",
                "WAIT doesn't say how long",
                statement.head_span,
                "for example WAIT [2] (s)",
                subject=LeftOut("how long it waits"),
            )
        return None if seconds is None else Dwell(origin, seconds)
    signal = input_named(values[0], scope, statement, findings)
    value = state_value(values[1], scope, statement, findings)
    if statement.time is None:
        message = "this waits for ever if the input never gets there"
        findings.add("Y1003", message, statement.head_span, "give a time: WAIT DOOR ON [5] (s)")
    if signal is None or value is None:
        return None
    return WaitInput(origin, signal, value, seconds)


def _seconds(statement: Statement, scope: Scope, defaults: Defaults, findings: Collector) -> float | None:
    """What stands in square brackets [s]."""
    units = resolve_units(statement, statement.units, findings)
    time = statement.time
    if time is None or units is None:
        return None
    span = statement.span(time.place)
    if len(time.items) != 1 or not isinstance(item := time.items[0], Number | Computed):
        findings.add("Y0407", "WAIT takes a time", span, "for example [2]")
        return None
    found = amount(item, scope, statement, findings)
    if found is None:
        return None
    unit = units.get("time") or defaults.units.get("time") or found.unit
    if unit is None:
        findings.add_error(missing_unit("time", "the time"), span)
        return None
    try:
        seconds = found.in_unit(unit) * unit.factor
        if unit.kind != "time":
            raise AmountError("Y0307", f"{found} isn't a time")
    except AmountError as error:
        findings.add_error(error, span)
        return None
    if not 0.0 < seconds <= LONGEST_WAIT:
        message = f"[{found}]: a wait is above 0 and at most {LONGEST_WAIT:g} s"
        findings.add("Y0407", message, span)
        return None
    return seconds


def _set(statement: Statement, origin: Origin, scope: Scope, findings: Collector) -> Step | None:
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    values = values_of(statement)
    if len(values) != 2:
        message = "SET wants an output and its value"
        findings.add("Y0401", message, statement.whole_span, "for example SET GRIP ON")
        return None
    output = output_named(values[0], scope, statement, findings)
    value = state_value(values[1], scope, statement, findings)
    return None if output is None or value is None else SetOutput(origin, output, value)


def _hold(statement: Statement, origin: Origin, findings: Collector) -> Step:
    refuse_parts(statement, ("a moving frame", "a motion time", "units", "a base frame", "options"), findings)
    values = values_of(statement)
    if len(values) > 1 or (values and not isinstance(values[0], Text)):
        findings.add(
            "Y0401", "HOLD takes a text in quotes, or nothing", statement.whole_span, 'HOLD "shut the door"'
        )
    text = values[0].text.strip('"') if values and isinstance(values[0], Text) else ""
    return Hold(origin, text)
