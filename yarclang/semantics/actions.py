"""Read assignments to registers and outputs, all other commands that don't move the robot, and the conditions
of WHEN and WAIT.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from yarclang.commands.registry import actions
from yarclang.commands.spec import ActionArguments, ActionForm, ActionSpec, ActionValue
from yarclang.decisions import (
    Between,
    Constant,
    DecisionError,
    Register,
    RegisterValue,
    equals,
    evaluated,
    in_words,
    inputs_of,
    is_group,
    largest_of,
    names_in,
    registers_of,
    shown_variable,
    simple,
)
from yarclang.decisions import Value as Condition
from yarclang.diagnostics import Collector
from yarclang.hir import Action, Assign, Output, Say, Signal, WaitInput, WaitUntil, When
from yarclang.semantics.context import Defaults
from yarclang.semantics.declared.signals import group_fault, state_value
from yarclang.semantics.files import values_of
from yarclang.semantics.motions.to_hir import origin_of
from yarclang.semantics.names.scope import KINDS, Input, Scope
from yarclang.semantics.names.signals import input_named, output_named
from yarclang.semantics.names.taught import taught_name
from yarclang.semantics.names.tools import tool_named
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.semantics.values.amounts import AmountError, missing_unit
from yarclang.semantics.values.deciding import condition_of, number_of
from yarclang.semantics.values.evaluate import EvaluationError
from yarclang.semantics.values.steps import steps_of
from yarclang.semantics.values.units import amount, resolve_units
from yarclang.subjects import LeftOut, unknown
from yarclang.syntax.ast import Computed, Number, Statement, Text, Value, Word
from yarclang.words.registry import word_specs
from yarclang.words.spec import Slot

LONGEST_WAIT = 3600.0
"""Longest wait [s] that a program may state. The controller's timer has a much higher limit."""


def read_action(
    statement: Statement, spec: ActionSpec, scope: Scope, defaults: Defaults, findings: Collector
) -> tuple[Action, ...] | None:
    """Return the steps of a command that doesn't move the robot; None with findings if it has an error."""
    before = len(findings.found)
    origin = origin_of(statement, spec.name, findings)
    refused = ("a moving frame", "a base frame", "options")
    refuse_parts(statement, refused if spec.takes_time else NOT_FOR_BLOCKS, findings)
    given = values_of(statement)
    form = spec.form_of(len(given))
    if form is None or not all(_may_be(slot, value) for slot, value in zip(form.slots, given, strict=True)):
        _tell_wanted(statement, spec.name, spec.wants, spec.examples, findings)
        return None
    seconds = _seconds(statement, form, scope, defaults, findings)
    values = [_value(*one, scope, statement, findings) for one in zip(form.slots, given, strict=True)]

    def report(code: str, message: str, help_: str) -> None:
        findings.add(code, message, statement.head_span, help_)

    if any(found.is_error for found in findings.found[before:]):
        return None
    known = _in_steps(
        tuple(value for value in values if value is not None), given, scope, statement, findings
    )
    if known is None:
        return None
    if not _keeps_to_groups(statement, form, known, findings):
        return None
    steps = spec.build(ActionArguments(origin, known, seconds, report))
    if all(
        _says_registers(step, given[0], scope, statement, findings)
        for step in steps
        if isinstance(step, Say) and not step.teaches
    ):
        return steps
    return None


def _in_steps(
    values: tuple[ActionValue, ...],
    given: Sequence[Value],
    scope: Scope,
    statement: Statement,
    findings: Collector,
) -> tuple[ActionValue, ...] | None:
    """Convert the physical values in a command to integers, if the command names an analogue signal. The
    integers are numbers of the signal's steps.

    Returns:
        All values of the command, unchanged without an analogue signal. None with a finding if a physical
        value is out of range or is between two steps.
    """
    found = next((scope.name(one.name) for one in given if isinstance(one, Word)), None)
    if not isinstance(found, Output | Input) or found.step is None:
        return values
    largest = largest_of(found.signal.variable) * found.step
    for value in values:
        if isinstance(value, float) and not 0.0 <= value <= largest:
            message = f"{found.signal.name} has the values 0 to {largest:.10g}, and can't be {value:.10g}"
            findings.add("Y0470", message, statement.whole_span, "correct the number, or declare more bits")
            return None
    try:
        return tuple(
            steps_of(value, found.step, found.signal.name) if isinstance(value, float) else value
            for value in values
        )
    except AmountError as error:
        findings.add_error(error, statement.whole_span)
        return None


def _says_registers(step: Say, value: Value, scope: Scope, statement: Statement, findings: Collector) -> bool:
    """Return True if every name in braces in the text of a SAY is a register; otherwise report the first name
    that isn't.
    """
    wrong = next((one for one in names_in(step.text) if not isinstance(scope.name(one), Register)), None)
    if wrong is None:
        return True
    known = sorted(set(scope.names(Register)))
    subject = unknown(wrong, known)
    help_ = subject.question or (f"there are {', '.join(known)}" if known else "declare it: REGISTER N 0..9")
    findings.add("Y0441", f"{{{wrong}}} is no register", statement.span(value.place), help_, subject=subject)
    return False


def _keeps_to_groups(
    statement: Statement, form: ActionForm, values: tuple[ActionValue, ...], findings: Collector
) -> bool:
    """Check the groups of bits in a command: only a SET of an output may name a group, and only with a number
    that the group can hold.

    Returns:
        True if this holds; otherwise False, with a finding.
    """
    groups = [one for one in values if isinstance(one, Signal) and is_group(one.variable)]
    for one in groups:
        if form.slots != (Slot.OUTPUT, Slot.STATE):
            message = (
                f"{one.name} is a group of {len(one.bits)} bits, and {statement.name.name} takes a single bit"
            )
            help_ = (
                f"declare this bit under a name of its own; {shown_variable(one.variable)} is a number, "
                "which SET, WHEN and CASE can use"
            )
            findings.add("Y0471", message, statement.whole_span, help_)
            return False
        number = next(value for value in values if isinstance(value, float))
        if fault := group_fault(one, number):
            findings.add("Y0470", fault, statement.whole_span, "correct the number, or declare more bits")
            return False
    return True


def read_when(statement: Statement, scope: Scope, findings: Collector) -> When | None:
    """Read the condition of a WHEN, WHILE or UNTIL line; None with findings if it has an error."""
    refuse_parts(statement, NOT_FOR_BLOCKS, findings)
    values, spec = values_of(statement), word_specs()[statement.name.name]
    origin = origin_of(statement, spec.name, findings)
    if statement.expression is not None:
        try:
            condition = condition_of(statement.expression, scope)
        except EvaluationError as error:
            findings.add_error(error, statement.span(error.place))
            return None
        return When(origin, condition)
    if len(values) != len(spec.slots):
        _tell_wanted(statement, spec.name, spec.wants, (spec.example,), findings)
        return None
    register = _register_named(values[0], scope)
    signal = None if register else input_named(values[0], scope, statement, findings)
    value = state_value(values[1], scope, statement, findings)
    if value is None or (signal is None and register is None):
        return None
    if register is not None:
        return When(origin, Between("=", RegisterValue(register.name), Constant(value)))
    assert signal is not None  # a value without a register or signal was refused above
    as_steps = _in_steps((value,), values, scope, statement, findings)
    if as_steps is None:
        return None
    (value,) = (one for one in as_steps if isinstance(one, float))
    return When(origin, equals(signal.variable, signal.name, value))


def read_wait_else(
    statement: Statement, scope: Scope, defaults: Defaults, findings: Collector
) -> When | None:
    """Read a line such as WAIT DOOR ON [5] ELSE as a WHEN. The first branch of the WHEN is carried out if the
    condition becomes true within the time; its ELSE is carried out if the time passes first.

    Returns:
        None with findings if the line has an error, or if it lacks its condition or its time.
    """
    *others, last = statement.options
    if others:
        message = f"WAIT doesn't take {others[0].word.name}"
        findings.add("Y0408", message, statement.span(others[0].word.place), "remove it")
        return None
    span = statement.span(last.word.place)
    if last.argument is not None:
        findings.add(
            "Y0412",
            "the line must end after the ELSE of a WAIT",
            span,
            "write the commands in lines of their own, and END after them",
        )
        return None
    plain = replace(statement, options=())
    silent = Collector(findings.source)
    silent.place = findings.place
    if plain.expression is not None:
        steps: tuple[Action | None, ...] = (read_wait(plain, scope, defaults, silent),)
    else:
        steps = read_action(plain, actions()["WAIT"], scope, defaults, silent) or ()
    findings.found += [one for one in silent.found if one.code != "Y1003"]
    step = steps[0] if steps else None
    match step:
        case WaitInput(input=signal, value=value, timeout=float(seconds)):
            condition: Condition = equals(signal.variable, signal.name, value)
        case WaitUntil(condition=condition, timeout=float(seconds)):
            pass
        case None:
            return None
        case _:
            message = "the ELSE of this WAIT is never carried out: it needs a condition and a time limit"
            findings.add("Y0451", message, span, "for example WAIT DOOR ON [5] (s) ELSE")
            return None
    return When(step.origin, condition, within=seconds)


def read_wait(
    statement: Statement, scope: Scope, defaults: Defaults, findings: Collector
) -> WaitInput | WaitUntil | None:
    """Read a line such as WAIT DOOR = ON AND JOB > 2 [5]; None with findings if it has an error."""
    assert statement.expression is not None
    before = len(findings.found)
    refuse_parts(statement, ("a moving frame", "a base frame", "options"), findings)
    try:
        condition = condition_of(statement.expression, scope)
    except EvaluationError as error:
        findings.add_error(error, statement.span(error.place))
        return None
    if not inputs_of(condition) and not any(_is_outside(one, scope) for one in registers_of(condition)):
        message = "this condition can't change during the WAIT: it has no input and no register with OUTSIDE"
        help_ = "use WHEN for registers; WAIT needs an input, or a REGISTER ... OUTSIDE"
        findings.add("Y0440", message, statement.span(statement.expression.place), help_)
        return None
    seconds = _seconds(statement, ActionForm(time="may"), scope, defaults, findings)
    if any(found.is_error for found in findings.found[before:]):
        return None
    if seconds is None:
        message = "this WAIT has no time limit: it never ends if the condition never holds"
        help_ = f"add a time limit: WAIT {in_words(condition)} [5] (s)"
        findings.add("Y1003", message, statement.head_span, help_)
    origin = origin_of(statement, "WAIT", findings)
    compared = simple(condition)
    if compared is not None:
        one, wanted = compared
        return WaitInput(origin, Signal(one.name, one.variable), wanted, seconds)
    return WaitUntil(origin, condition, seconds)


def _changes(name: str) -> str:
    return f"declare an output, or a register: REGISTER {name} 0..9"


def _is_outside(name: str, scope: Scope) -> bool:
    found = scope.name(name)
    return isinstance(found, Register) and found.outside


def read_assignment(statement: Statement, scope: Scope, findings: Collector) -> Assign | None:
    """Read an assignment such as SET COUNT = COUNT + 1, SET GO = COUNT or SET GO COUNT; None with findings if
    it has an error.
    """
    before = len(findings.found)
    refuse_parts(statement, NOT_FOR_BLOCKS, findings)
    word, *others = values_of(statement)
    assert isinstance(word, Word)
    found, span = scope.name(word.name), statement.span(word.place)
    if found is None:
        known = sorted(set(scope.names(Register, Output)))
        subject = unknown(word.text, known)
        help_ = subject.question or (
            f"there are {', '.join(known)}" if known else "declare it: REGISTER N 0..9"
        )
        findings.add("Y0210", f"no register or output is named {word.text}", span, help_, subject=subject)
    elif not isinstance(found, Register | Output):
        findings.add(
            "Y0209",
            f"{word.text} is {KINDS[type(found)]}, not a register or an output",
            span,
            _changes(word.text),
        )
    try:
        if statement.expression is not None:
            value = number_of(statement.expression, scope)
        elif (register := _register_named(others[0], scope)) is not None:
            value = RegisterValue(register.name)
        else:
            number = state_value(others[0], scope, statement, findings)
            if number is None:
                return None
            value = Constant(number)
        if not inputs_of(value) and not registers_of(value) and isinstance(found, Register | Output):
            number = evaluated(value, {}, {})
            if isinstance(found, Output):
                help_ = (
                    f"SET {word.text} "
                    f"{'ON' if number == 1.0 else 'OFF' if number == 0.0 else f'{number:.9g}'} has no "
                    "equals sign"
                )
                findings.add("Y0209", f"{word.text} is an output, not a register", span, help_)
            else:
                _check_range(number, found, statement, findings)
        elif isinstance(found, Output) and found.step is not None:
            message = (
                f"{word.text} is analogue: it can't be set to a value that is known only when the program "
                "runs"
            )
            findings.add("Y0472", message, span, f"write a number after SET {word.text}")
    except EvaluationError as error:
        findings.add_error(error, statement.span(error.place))
        return None
    except DecisionError as error:
        assert statement.expression is not None  # only an expression raises this error
        findings.add("Y0410", str(error), statement.span(statement.expression.place))
        return None
    if not isinstance(found, Register | Output) or any(one.is_error for one in findings.found[before:]):
        return None
    target = found.name if isinstance(found, Register) else found.signal
    return Assign(origin_of(statement, "SET", findings), target, value)


def assigns(statement: Statement, scope: Scope) -> bool:
    """Return True if a SET has an equals sign or names a register, so that it is read as an assignment.

    Examples without an equals sign are SET GO COUNT and SET FLAG ON.
    """
    values = values_of(statement)
    if statement.expression is not None:
        return True
    return len(values) == 2 and any(_register_named(one, scope) is not None for one in values)


def _register_named(value: Value, scope: Scope) -> Register | None:
    found = scope.name(value.name) if isinstance(value, Word) else None
    return found if isinstance(found, Register) else None


def _check_range(number: float, register: Register, statement: Statement, findings: Collector) -> None:
    if number.is_integer() and register.low <= number <= register.high:
        return
    place = statement.expression.place if statement.expression else values_of(statement)[1].place
    message = (
        f"{register.name} is an integer from {register.low} to {register.high}, and can't be {number:.15g}"
    )
    findings.add("Y0431", message, statement.span(place), "correct the value, or the range of the register")


def _tell_wanted(
    statement: Statement, word: str, wants: str, examples: tuple[str, ...], findings: Collector
) -> None:
    help_ = f"for example {', or '.join(examples)}"
    findings.add("Y0401", f"{word} takes {wants}", statement.whole_span, help_)


def _may_be(slot: Slot, value: Value) -> bool:
    return slot is not Slot.TEXT or isinstance(value, Text)


def _value(
    slot: Slot, value: Value, scope: Scope, statement: Statement, findings: Collector
) -> ActionValue | None:
    match slot:
        case Slot.INPUT:
            return input_named(value, scope, statement, findings)
        case Slot.OUTPUT:
            return output_named(value, scope, statement, findings)
        case Slot.STATE:
            return state_value(value, scope, statement, findings)
        case Slot.TOOL:
            return tool_named(value, scope, statement, findings)
        case Slot.TAUGHT:
            return taught_name(value, scope, statement, findings)
        case Slot.TEXT:
            return value.text.strip('"')
        case Slot.REACTION:
            raise AssertionError(slot)  # only ON has a reaction, and ON is a declaration, not an action
        case Slot.REGISTER:
            if (found := _register_named(value, scope)) is not None:
                return found.name
            known = sorted(set(scope.names(Register)))
            subject = unknown(value.text, known)
            help_ = subject.question or (
                f"there are {', '.join(known)}" if known else "declare it: REGISTER N 0..9"
            )
            findings.add(
                "Y0210",
                f"no register is named {value.text}",
                statement.span(value.place),
                help_,
                subject=subject,
            )
            return None


def _seconds(
    statement: Statement, form: ActionForm, scope: Scope, defaults: Defaults, findings: Collector
) -> float | None:
    """Return the time in square brackets of a command [s].

    Returns:
        None without brackets; a finding is added if the command needs a time, or if the time has an error.
    """
    units = resolve_units(statement, statement.units, findings)
    time, word = statement.time, statement.name.name
    if time is None and form.time == "must":
        findings.add(
            "Y0406",
            f"{word} has no time",
            statement.head_span,
            f"for example {word} [2] (s)",
            subject=LeftOut("how long it waits"),
        )
    if time is None or units is None:
        return None
    span = statement.span(time.place)
    if len(time.items) != 1 or not isinstance(item := time.items[0], Number | Computed):
        findings.add("Y0407", f"{word} needs a time", span, "for example [2]")
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
        message = f"[{found}]: the time of a wait must be above 0 and at most {LONGEST_WAIT:g} s"
        findings.add(
            "Y0407",
            message,
            span,
            "write a time such as [0.5] (s), or remove the WAIT"
            if not seconds > 0.0
            else "write several waits, or wait for an input: WAIT DOOR ON",
        )
        return None
    return seconds
