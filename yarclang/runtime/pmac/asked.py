"""Questions to the controller at a barrier of the program, and the values that are computed from the answers.
Each input is read once; groups of inputs are read until two readings agree. No I/O.
"""

from __future__ import annotations

from yarclang.decisions import (
    DecisionError,
    Value,
    bits_of,
    evaluated,
    inputs_of,
    is_group,
    registers_of,
    shown_variable,
)
from yarclang.runtime.actions import Script, Trouble, Wait
from yarclang.runtime.job import Barrier
from yarclang.runtime.pmac.held import Held, title
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.signals import state_text

LOOK = 0.02
"""Time between two reads of an input [s]."""

_UNSTEADY = 1.0
"""Longest time for which the bits of a group may differ from one read to the next [s]."""


def read_inputs(operation: Operation, barrier: Barrier, value: Value) -> Script[dict[str, float]]:
    """Read the inputs on which a value depends: each single input once, and each group of inputs until two
    readings agree.

    Args:
        operation: state of the run, and access to the controller.
        barrier: the barrier at which the robot stands.
        value: the value (such as a condition) whose inputs are read.

    Returns:
        The numbers that were read, by the controller variables of the inputs and the names of groups.
    """
    readings: dict[str, float] = {}
    for one in inputs_of(value):
        if is_group(one.variable):
            readings[one.variable] = yield from _read_group(operation, barrier, one.variable)
        else:
            (readings[one.variable],) = yield from operation.numbers(one.variable, 1)
    return readings


def _read_group(operation: Operation, barrier: Barrier, group: str) -> Script[float]:
    """Read the bits of a group of inputs as one number.

    All bits are asked for in one question, but a PLC may change some of them while the controller answers, or
    change them in different cycles. A number therefore counts only if a second reading, `LOOK` later, gives
    the same number. Orders of people stay in their queue until the number is read: a HOLD then applies to the
    motion that follows.
    """
    bits, since = bits_of(group), operation.now
    before: tuple[float, ...] | None = None
    while True:
        read = yield from operation.numbers("".join(bits), len(bits))
        for bit, value in zip(bits, read, strict=True):
            if value not in (0.0, 1.0):
                raise Trouble(
                    f"{title(barrier)}: {bit} of the group {shown_variable(group)} reads {value:.15g}, "
                    "but a bit must be 0 or 1",
                    f"make {bit} point to a single bit, or declare it as a separate input",
                    "Y1650",
                )
        if read == before:
            return float(sum(int(value) << place for place, value in enumerate(read)))
        if operation.now - since > _UNSTEADY:
            raise Trouble(
                f"{title(barrier)}: the group {shown_variable(group)} keeps changing: no two readings "
                f"within {_UNSTEADY:g} s were equal",
                "make the connected device hold the number until the robot continues",
                "Y1651",
            )
        before = read
        yield Wait(operation.now + LOOK)


def said_of(variable: str, value: float) -> str:
    """Return the value of an input in words."""
    return f"{value:.0f}" if is_group(variable) else state_text(value)


def known_of(condition: Value, held: Held) -> str:
    """Return the values of the registers and inputs with which a condition was evaluated, in words."""
    comparisons = [f"{name} is {held.registers[name]}" for name in registers_of(condition)]
    comparisons += [
        f"{shown_variable(one.variable)} is {said_of(one.variable, held.inputs[one.variable])}"
        for one in inputs_of(condition)
    ]
    return ", ".join(comparisons)


def value_of(barrier: Barrier, value: Value, held: Held) -> float:
    """Compute a value from the inputs and registers that were read last.

    Args:
        barrier: the barrier to which the value belongs.
        value: the expression to be computed.
        held: registers and inputs of the run.

    Raises:
        Trouble: the value can't be computed.
    """
    try:
        return evaluated(value, held.registers, held.inputs)
    except DecisionError as error:
        remedy = "check the inputs and the program's counts, then start the program again"
        raise Trouble(f"{title(barrier)}: {error}", remedy, "Y1630") from None
