"""Check of the variables that a text assigns or waits for: only those with a stated purpose are allowed."""

from __future__ import annotations

from collections.abc import Iterator, Set

from yarclang.certify.read.text import Barred, ControllerText, assignments_of
from yarclang.decisions import bits_of, inputs_of
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import signal_variable
from yarclang.robot.model import Robot


def check_assignments(text: ControllerText, robot: Robot, outputs: Set[str] | None) -> Iterator[str]:
    """Yield, for each variable that a text must not assign or wait for, the reason why not.

    Only outputs may be assigned here. The reader accepts other assignments only in lines where they belong:
    the marks of the rotary buffer (I16, I17) and the guard's flag (P8100), which are judged with the guard;
    and P8101, P8102 and a timer, in lines of a program buffer that are fixed to the last character.

    Args:
        text: the controller text, as the judge has read it.
        robot: the robot; the variables in which it reports its positions are not outputs.
        outputs: variables of the program's outputs; None if the program is unknown, to allow any variable
            that an output may have.
    """
    seen: set[str] = set()
    computed = [
        (item.line, variable)
        for item in text.course
        if isinstance(item, Barred) and item.output
        for variable in bits_of(item.output)
    ]
    for line, variable in (*((line, variable) for line, variable, _ in assignments_of(text)), *computed):
        where = "the PLC of safe values" if line is None else f"line {line}"
        if reason := _why_not(variable, robot):
            yield f"{where} sets {variable}, which {reason}"
        elif outputs is not None and variable not in outputs:
            yield f"{where} sets {variable}, which isn't an output of the program"
        elif line is None and variable in seen:
            yield f"{where} sets {variable} twice"
        if line is None:
            seen.add(variable)
    for item in text.course:
        if not isinstance(item, Barred) or item.condition == "-" or item.kind == "hold":
            continue
        if item.decided is None:
            read = [item.condition.partition("=")[0]]
        else:
            read = [bit for one in inputs_of(item.decided) for bit in bits_of(one.variable)]
        for variable in read:
            if reason := _why_not(variable, robot):
                yield f"line {item.line} waits for {variable}, which {reason}"


def _why_not(variable: str, robot: Robot) -> str:
    """Return the reason why a variable cannot be an input or output; empty if it can."""
    found = signal_variable(variable, turbo_pmac(robot).feedback)
    if found.name is None:
        return found.fault
    return "" if found.name == variable else f"is written {found.name}"
