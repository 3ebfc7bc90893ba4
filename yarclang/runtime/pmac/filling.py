"""Registers that other programs fill while the robot stands at a WAIT or a HOLD. No I/O.

While a script runs between two of its questions, this process does nothing else. So no value can arrive
between the decision that a wait is over and the moment from which no more values are accepted.
"""

from __future__ import annotations

from yarclang.decisions import Register, Value, registers_of
from yarclang.runtime.job import Barrier
from yarclang.runtime.notices import Fill, Wanted
from yarclang.runtime.pmac.held import Held, title
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.values import range_text, values_text


def needed_for(condition: Value, held: Held) -> tuple[str, ...]:
    """Return those registers of a condition that other programs fill."""
    return tuple(name for name in registers_of(condition) if name in held.outside)


def begin_anew(held: Held, needed: tuple[str, ...]) -> None:
    """Reset the registers for whose values the program waits: values that were sent for an earlier wait don't
    count for this one.
    """
    for name in needed:
        held.registers[name] = held.outside[name].first


def take_values(operation: Operation, barrier: Barrier, held: Held, needed: tuple[str, ...]) -> None:
    """Accept values of registers from other programs from now on.

    A remark reports that values are accepted. At the same barrier, the remark is repeated only after the
    robot has moved.

    Args:
        operation: state of the run, and access to the controller.
        barrier: the barrier at which the robot stands.
        held: registers of the run.
        needed: registers for which a message must have values.
    """
    operation.asked_for += 1
    place = title(barrier)
    ranges = tuple(_range(one) for one in held.outside.values())
    wanted = Wanted(operation.asked_for, place, ranges, needed)
    text = f"{place} takes values from outside: {range_text(wanted)}"
    if held.said.get(f"{place} outside") != text:
        operation.remark(text)
    held.said[f"{place} outside"] = text
    operation.want(wanted)


def is_given(operation: Operation) -> bool:
    """Return True if a message with values of registers has come that isn't handled yet."""
    return any(isinstance(order, Fill) for order in operation.orders)


def fill(operation: Operation, barrier: Barrier, held: Held, order: Fill) -> None:
    """Put the values of a message into their registers.

    Args:
        operation: state of the run, and access to the controller.
        barrier: the barrier at which the robot stands.
        held: registers of the run.
        order: the message with the values.
    """
    held.registers.update(order.values)
    operation.remark(f"{title(barrier)}: {order.client} gives {values_text(order.values)}")


def close(operation: Operation, barrier: Barrier, held: Held) -> None:
    """Accept no more values from other programs. Values that were accepted before are put into their
    registers.
    """
    operation.want(None)
    for order in [one for one in operation.orders if isinstance(one, Fill)]:
        operation.orders.remove(order)
        fill(operation, barrier, held, order)


def _range(register: Register) -> tuple[str, int, int]:
    return register.name, register.low, register.high
