"""Barriers as controller text: places where a program waits for an input or the operator, or where its
branches divide and join.

A rotary buffer can't have branches. In its text, a STOP ends the execution at a barrier; the runtime, which
feeds the buffer, evaluates the barrier, decides what comes next, and sends R. In a program buffer, the
controller evaluates the barrier itself (spline-recipe 9). After a STOP in a program buffer, an R would
continue with the next line. The text therefore has loops that stop again as long as the condition isn't
satisfied.
"""

from __future__ import annotations

from yarclang.pmac.program import Barrier, Target
from yarclang.pmac.variables import WAITING, system_variable

_LONGEST_TEXT = 80
"""Maximum length of a text that is sent [characters]."""


def barrier_lines(barrier: Barrier, target: Target, system: int) -> tuple[str, ...]:
    """Return the controller lines of a barrier. The robot is at rest there.

    Args:
        barrier: the barrier.
        target: kind of the text, for a rotary buffer or for a program buffer.
        system: number of the coordinate system.
    """
    if target == "rotary":
        return ("STOP",)
    match barrier.kind:
        case "wait":
            return tuple(_wait(barrier, system))
        case "hold":
            return (f'SEND"YARC: {printable(barrier.name) or barrier.label}"', "STOP")
        case "when":
            return (f"IF({barrier.condition})",)
        case "else":
            return ("ELSE",)
        case "end":
            return ("ENDIF",)
        case "set":
            raise ValueError("registers are held by the streaming host, which a program buffer doesn't have")
        case "say":
            raise ValueError(
                "a message to the operator is shown by the runtime, without which a program buffer runs"
            )
        case "loop" | "next" | "exit" | "endloop":
            raise ValueError("a loop is repeated by the streaming host, which a program buffer doesn't have")
        case "stop" | "abort":
            raise ValueError("in a program buffer an R would continue after a STOP")


def _wait(barrier: Barrier, system: int) -> list[str]:
    """Return the lines that wait for an input.

    The timer variable Isx11 counts down by itself, once per servo cycle (TSRM 177).
    """
    missing = f"{barrier.variable}!={_value(barrier)}"
    if barrier.timeout is None:
        return [f"WHILE({missing})WAIT"]
    # A servo cycle takes I10 / 8388608 ms (TSRM 43). At the timeout the program stops; the command R restarts
    # the wait.
    timer = system_variable(system, 11)
    return [
        f"{WAITING}=1",
        f"WHILE({WAITING}=1)",
        f"{timer}=INT({_number(barrier.timeout * 1e3)}*8388608/I10)",
        f"WHILE({missing} AND {timer}>0)WAIT",
        f"{WAITING}=0",
        f"IF({missing})",
        f"{WAITING}=1",
        f'SEND"YARC: {printable(barrier.name)} IS NOT {_value(barrier)} AFTER {_number(barrier.timeout)} S"',
        "STOP",
        "ENDIF",
        "ENDWHILE",
    ]


def _value(barrier: Barrier) -> str:
    return _number(barrier.value)


def _number(value: float) -> str:
    return f"{value:.9f}".rstrip("0").rstrip(".")


def printable(text: str) -> str:
    """Return a text in ASCII, on one line, without quotes."""
    kept = "".join(one if one.isprintable() and one.isascii() and one != '"' else "?" for one in text)
    return " ".join(kept.split())[:_LONGEST_TEXT]
