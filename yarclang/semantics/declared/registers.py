"""Carry out REGISTER: declare an integer that the program changes at run time."""

from __future__ import annotations

import re

from yarclang.decisions import LARGEST, LONGEST_NAME, Register
from yarclang.diagnostics import Collector
from yarclang.robot.model import Robot
from yarclang.semantics.declared.meanings import may_be_declared
from yarclang.semantics.files import values_of
from yarclang.semantics.names.scope import Scope, Where
from yarclang.semantics.parts import NOT_FOR_BLOCKS, refuse_parts
from yarclang.syntax.ast import Number, Other, Statement, Word

SEARCHES = "SEARCH_"
"""Prefix of the names of registers that become 1 when a search has found its input."""

OFFSETS = "OFFSET_"
"""Prefix of the names of registers that are 1 if the lines of an OFFSET can be carried out."""

COUNTER = "REPEAT_"
"""Prefix of the names of registers that count the passes of a REPEAT."""

RETURNS = "RETURN_"
"""Prefix of the names of registers that are 1 after a loop if a RETURN in this loop leaves the SUB around
it.
"""

_OF_BLOCKS = re.compile(rf"({SEARCHES}|{OFFSETS}|{COUNTER}|{RETURNS})[0-9]+")
_RANGE = re.compile(r"([+-]?[0-9]{1,12})\.\.([+-]?[0-9]{1,12})")
_KEPT, _OUTSIDE = "KEPT", "OUTSIDE"
_EXAMPLE = "for example REGISTER COUNT 0..17"


def declare_register(
    statement: Statement, scope: Scope, robot: Robot, findings: Collector
) -> Register | None:
    """Declare a register, such as REGISTER COUNT 0..17, or REGISTER COUNT 0..17 3 with 3 as its first value.

    KEPT at the end of the line keeps the value from run to run. OUTSIDE lets other programs set the register.

    Returns:
        None with a finding if the line is wrong.
    """
    refuse_parts(statement, NOT_FOR_BLOCKS, findings)
    given = values_of(statement)
    last = given[-1] if len(given) > 2 else None
    behind = last.name if isinstance(last, Word) and last.name in (_KEPT, _OUTSIDE) else ""
    given = given[:-1] if behind else given
    other = given[-1] if behind and len(given) > 2 else None
    if isinstance(other, Word) and other.name in (_KEPT, _OUTSIDE):
        message = "a register can't be both KEPT and OUTSIDE: a value from outside is valid for one wait only"
        findings.add("Y0431", message, statement.span(other.place), "remove one of the two words")
        return None
    word, values = (given[0] if given else None), given[1:]
    bounds = range_of(values[0]) if values else None
    if not isinstance(word, Word) or bounds is None or len(values) > 2:
        message = (
            "REGISTER needs a name and a range; a first value, and KEPT (kept from run to run) or OUTSIDE "
            "(filled by other programs), may follow"
        )
        findings.add("Y0431", message, statement.whole_span, _EXAMPLE)
        return None
    low, high = bounds
    span = statement.span(values[0].place)
    if not -LARGEST <= low < high <= LARGEST:
        message = f"{low}..{high} is no range: write the lower bound first, and no bound beyond {LARGEST:,}"
        findings.add("Y0431", message, span, _EXAMPLE)
        return None
    if len(word.name) > LONGEST_NAME:
        message = f"the name of a register has at most {LONGEST_NAME} characters"
        findings.add("Y0431", message, statement.span(word.place), "shorten it")
        return None
    first = low
    if len(values) == 2:
        found = integer_of(values[1])
        if found is None or not low <= found <= high:
            message = f"{values[1].text} is no integer from {low} to {high}"
            findings.add("Y0431", message, statement.span(values[1].place), _EXAMPLE)
            return None
        first = found
    if not may_be_declared(statement, word, scope, robot, findings):
        return None
    register = Register(word.name, low, high, first, behind == _KEPT, behind == _OUTSIDE)
    scope.declare(word.name, register, Where(findings.source, statement.span(word.place)))
    return register


def is_name_of_block(name: str) -> bool:
    """Return True if a block may have chosen this name for a register of its own."""
    return _OF_BLOCKS.fullmatch(name) is not None


def range_of(value: object) -> tuple[int, int] | None:
    """Return the bounds of a range such as `0..17`; None for any other value."""
    found = _RANGE.fullmatch(value.text) if isinstance(value, Other) else None
    return None if found is None else (int(found[1]), int(found[2]))


def integer_of(value: object) -> int | None:
    """Return a value as an integer. Return None if it isn't an integer, or is outside of the largest range
    that a register can have.
    """
    if not isinstance(value, Number) or not value.value.is_integer() or abs(value.value) > LARGEST:
        return None
    return int(value.value)
