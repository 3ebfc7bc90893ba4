"""Assignment of computed values to registers and outputs while the robot stands. No I/O."""

from __future__ import annotations

from yarclang.decisions import (
    Register,
    Value,
    bits_of,
    largest_of,
)
from yarclang.runtime.actions import Keep, Script, Trouble
from yarclang.runtime.job import Barrier, Job
from yarclang.runtime.pmac.asked import read_inputs, value_of
from yarclang.runtime.pmac.held import Held, title
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.signals import OutputSet


def assign(operation: Operation, job: Job, barrier: Barrier, held: Held) -> Script[None]:
    """Compute the value of an assignment, and give it to a register or an output. End the run if it is out of
    range.

    Args:
        operation: state of the run, and access to the controller.
        job: the program with its registers.
        barrier: the `set` to carry out.
        held: registers and inputs of the run.
    """
    assert barrier.decided is not None  # a SET without a value was refused when the text was read
    if barrier.output:
        yield from _set_output(operation, barrier, barrier.decided, held)
        return
    register = next(one for one in job.registers if one.name == barrier.register)
    held.inputs = yield from read_inputs(operation, barrier, barrier.decided)
    value = value_of(barrier, barrier.decided, held)
    if not value.is_integer() or not register.low <= value <= register.high:
        raise Trouble(
            f"{title(barrier)} would make {register.name} {value:.15g}, and it is an integer from "
            f"{register.low} to {register.high}",
            "check the inputs and the program's counts, then start the program again",
            "Y1630",
        )
    yield from keep(barrier, register, int(value))
    held.registers[register.name] = int(value)
    if barrier.word == "SET":
        operation.remark(f"{title(barrier)}: {register.name} is {int(value)}")


def keep(barrier: Barrier, register: Register, value: int) -> Script[None]:
    """Store the value of a KEPT register for later runs; other registers aren't stored.

    The robot stands still until the value is on the disk; only then does the assignment count.

    Args:
        barrier: the `set` that is carried out.
        register: the register.
        value: its new value.
    """
    if not register.kept:
        return
    why = yield Keep(register.name, value)
    if why is not None:
        what = f"{title(barrier)} can't store {register.name} = {value}: {why}"
        raise Trouble(what, "check the disk and its permissions, then start the program again", "Y1636")


def _set_output(operation: Operation, barrier: Barrier, value: Value, held: Held) -> Script[None]:
    """Set an output, or all bits of a group, the lowest bit first."""
    held.inputs = yield from read_inputs(operation, barrier, value)
    number, bits = value_of(barrier, value, held), bits_of(barrier.output)
    name = barrier.name.partition(" = ")[0]
    if len(bits) > 1 and not (number.is_integer() and 0 <= number <= largest_of(barrier.output)):
        raise Trouble(
            f"{title(barrier)} would make {name} {number:.15g}, and its {len(bits)} bits hold only "
            f"integers from 0 to {largest_of(barrier.output)}",
            "check the inputs and the program's counts, then start the program again",
            "Y1630",
        )
    for place, bit in enumerate(bits):
        one = number if len(bits) == 1 else float(int(number) >> place & 1)
        yield from operation.ask(f"{bit}={_digits(one)}")
        operation.notices.append(OutputSet(operation.now, operation.outputs.get(bit, bit), bit, one))
    operation.remark(f"{title(barrier)}: {name} is {_digits(number)}")


def _digits(number: float) -> str:
    """Return a number in the controller's notation."""
    return f"{number + 0.0:.9f}".rstrip("0").rstrip(".")
