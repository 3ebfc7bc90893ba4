"""Read the number of rounds of a REPEAT."""

from __future__ import annotations

from yarclang.decisions import Register
from yarclang.diagnostics import Collector
from yarclang.semantics.files import values_of
from yarclang.semantics.names.scope import Scope
from yarclang.semantics.values.units import amount, number_fault
from yarclang.syntax.ast import Computed, Number, Statement, Value, Word

MOST_COMMANDS = 1_000_000
"""Largest number of unrolled commands of a program."""

MOST_ROUNDS = 200_000
"""Largest number of rounds of all loops of a program together, including loops without a command."""

AT_MOST = "the loops of a program make at most"
"""Part of a message, which is followed by MOST_ROUNDS and the word "rounds"."""


def counted(head: Statement) -> tuple[Word | None, list[Value]]:
    """Return the name of a REPEAT's counter (None without one), and the values in the line after this
    name.
    """
    values = values_of(head)
    word = values[0] if values and isinstance(values[0], Word) else None
    return word, values[1:] if word else values


def repeats(head: Statement, values: list[Value], scope: Scope, findings: Collector) -> int | None:
    """Return the number of rounds of a REPEAT or LOOP; None with a finding if the number is missing or wrong.

    Args:
        head: the first line of the block.
        values: the values after the counter's name.
        scope: the names in scope at this line.
        findings: receives the finding.
    """
    example = (
        "for example LOOP 288, or LOOP"
        if head.name.name == "LOOP"
        else "for example REPEAT I 4, or REPEAT $ROWS; REPEAT COUNT asks a register when run"
    )
    if len(values) == 1 and isinstance(values[0], Word) and isinstance(scope.name(values[0].name), Register):
        name = values[0].text
        message = f"{name} is known only when the program runs: REPEAT can't count its rounds under a name"
        findings.add("Y0401", message, head.whole_span, f"write REPEAT {name}, without a name before it")
        return None
    if len(values) != 1 or not isinstance(values[0], Number | Computed):
        word = head.name.name
        wants = "a name and a number, or a number" if word == "REPEAT" else "a number of passes, or nothing"
        findings.add("Y0401", f"{word} takes {wants}", head.whole_span, example)
        return None
    span = head.span(values[0].place)
    if (fault := number_fault(values[0])) is not None:
        findings.add(fault[0], fault[1], span, fault[2])
        return None
    found = amount(values[0], scope, head, findings)
    if found is None:
        return None
    whole = round(found.value)
    # Round first: 3 * 0.1 * 10 means 3, although its floating-point value differs.
    if found.unit is not None or whole < 0 or abs(found.value - whole) > 1e-9 * max(1, whole):
        findings.add(
            "Y0414", f"{head.name.name} {found}: the count must be an integer of 0 or more", span, example
        )
        return None
    if whole > MOST_ROUNDS:
        message = f"{head.name.name} {whole:,}: {AT_MOST} {MOST_ROUNDS:,} rounds"
        findings.add("Y1004", message, span, "reduce the count")
        return None
    return whole
