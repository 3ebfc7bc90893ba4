"""Read CASE, which chooses one of several branches by the value of a register or an input."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from yarclang.decisions import (
    LARGEST,
    Between,
    Constant,
    InputValue,
    Register,
    RegisterValue,
    Value,
    is_group,
    largest_of,
)
from yarclang.diagnostics import Collector
from yarclang.semantics.declared.registers import integer_of, range_of
from yarclang.semantics.files import values_of
from yarclang.semantics.names.scope import KINDS, Input, Scope
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.subjects import unknown
from yarclang.syntax.ast import Block, Node, Statement, Word
from yarclang.syntax.ast import Value as Written

MOST_RANGES = 8
"""Largest number of values and ranges after one OF; each needs one or two comparisons at run time."""

MOST_WAYS = 64
"""Largest number of OF lines in a CASE. Each becomes a WHEN in the ELSE of the previous one."""

_EXAMPLE = "for example OF 1, or OF 2..5 8"


@dataclass(slots=True)
class Way:
    """One branch of a CASE.

    Attributes:
        of: the OF line.
        condition: condition of the branch; None for the last branch of a CASE without ELSE, which gets all
            remaining values.
        nodes: the lines of the branch.
    """

    of: Statement
    condition: Value | None
    nodes: list[Node] = field(default_factory=list)


def ways_of(block: Block, scope: Scope, findings: Collector) -> list[Way] | None:
    """Return the branches of a CASE, except its ELSE; None with findings if the CASE has an error."""
    head = block.head
    refuse_parts(head, NOT_FOR_BLOCKS, findings)
    before = len(findings.found)
    selector, register = _selector(head, scope, findings)
    ways: list[Way] = []
    taken: list[tuple[int, int, int]] = []
    for node in block.body:
        if isinstance(node, Statement) and node.name.name == "OF":
            ways.append(Way(node, _condition(node, selector, register, taken, findings)))
        elif ways:
            ways[-1].nodes.append(node)
        else:
            one = node.head if isinstance(node, Block) else node
            findings.add(
                "Y0432",
                "this line is between a CASE and its first OF, and is never carried out",
                one.whole_span,
                _EXAMPLE,
            )
    if not ways:
        findings.add("Y0432", "a CASE needs at least one OF", head.whole_span, _EXAMPLE)
    elif len(ways) > MOST_WAYS:
        message = f"a CASE has at most {MOST_WAYS} OF, but this one has {len(ways)}"
        findings.add("Y0432", message, head.whole_span, "divide it into two CASEs")
    if any(found.is_error for found in findings.found[before:]):
        return None
    missing = _missing(register, taken)
    if block.otherwise is None and missing:
        findings.add(
            "Y0433",
            f"this CASE has no OF for {missing}",
            head.whole_span,
            "add an OF for them, or an ELSE, for example with HOLD",
        )
        return None
    if block.otherwise is None:
        ways[-1].condition = None
    return ways


def _selector(head: Statement, scope: Scope, findings: Collector) -> tuple[Value | None, Register | None]:
    values = values_of(head)
    if len(values) != 1 or not isinstance(word := values[0], Word):
        message = "CASE needs the name of a register or an input"
        findings.add("Y0401", message, head.whole_span, "for example CASE COUNT")
        return None, None
    span = head.span(word.place)
    match scope.name(word.name):
        case Register() as register:
            return RegisterValue(register.name), register
        case Input(signal=signal, step=step) if step is not None:
            message = f"{signal.name} is analogue, and CASE takes integers"
            findings.add(
                "Y0472", message, span, "use WHEN with a comparison, for example WHEN PRESSURE > 4.5"
            )
        case Input(signal=signal):
            # A group of bits has a known range of values, as a register has: a run ends if a bit is neither 0
            # nor 1.
            whole = Register(signal.name, 0, largest_of(signal.variable), 0)
            return InputValue(signal.variable, signal.name), whole if is_group(signal.variable) else None
        case None:
            known = sorted(set(scope.names(Register, Input)))
            subject = unknown(word.text, known)
            help_ = subject.question or "declare it: REGISTER COUNT 0..17, or INPUT JOB M70"
            message = f"no register or input is named {word.text}"
            findings.add("Y0210", message, span, help_, subject=subject)
        case found:
            message = f"{word.text} is {KINDS[type(found)]}, not a register or an input"
            help_ = "for a number that is known when compiled, use IF"
            findings.add("Y0209", message, span, help_)
    return None, None


def _condition(
    of: Statement,
    selector: Value | None,
    register: Register | None,
    taken: list[tuple[int, int, int]],
    findings: Collector,
) -> Value | None:
    refuse_parts(of, NOT_FOR_BLOCKS, findings)
    values = values_of(of)
    if not values or len(values) > MOST_RANGES:
        message = f"OF needs 1 to {MOST_RANGES} integers or ranges"
        findings.add("Y0401", message, of.whole_span, _EXAMPLE)
        return None
    found: Value | None = None
    for value in values:
        bounds = _bounds(of, value, register, taken, findings)
        if bounds is None or selector is None:
            continue
        taken.append((*bounds, of.line))
        one = _within(selector, *bounds)
        found = one if found is None else Between("OR", found, one)
    return found


def _bounds(
    of: Statement,
    value: Written,
    register: Register | None,
    taken: Iterable[tuple[int, int, int]],
    findings: Collector,
) -> tuple[int, int] | None:
    span, number = of.span(value.place), integer_of(value)
    bounds = range_of(value) if number is None else (number, number)
    if bounds is None:
        findings.add("Y0432", f"{value.text} is neither an integer nor a range of integers", span, _EXAMPLE)
        return None
    low, high = bounds
    if max(abs(low), abs(high)) > LARGEST:
        findings.add("Y0432", f"{value.text} is beyond {LARGEST:,}", span, _EXAMPLE)
        return None
    if low > high:
        findings.add("Y0432", f"the range {value.text} is empty: write the lower bound first", span, _EXAMPLE)
        return None
    if register is not None and not register.low <= low <= high <= register.high:
        message = f"{register.name} can't be {value.text}: its range is {register.low} to {register.high}"
        findings.add("Y0432", message, span, "remove the value, or widen the register's range")
        return None
    for first, last, line in taken:
        if first <= high and low <= last:
            message = f"{value.text} is already given by the OF of line {line}"
            findings.add("Y0432", message, span, "remove one of them")
            return None
    return bounds


def _within(selector: Value, low: int, high: int) -> Value:
    if low == high:
        return Between("=", selector, Constant(float(low)))
    least = Between(">=", selector, Constant(float(low)))
    return Between("AND", least, Between("<=", selector, Constant(float(high))))


def _missing(register: Register | None, taken: list[tuple[int, int, int]]) -> str:
    """Return the first values without a branch, in words for a message; empty if every value has a branch."""
    if register is None:
        return "other values of the input"
    next_ = register.low
    for low, high, _ in sorted(taken):
        if low > next_:
            return _range_in_words(register.name, next_, low - 1)
        next_ = high + 1
    return _range_in_words(register.name, next_, register.high) if next_ <= register.high else ""


def _range_in_words(name: str, low: int, high: int) -> str:
    return f"{name} = {low}" if low == high else f"{name} = {low} to {high}"
