"""Notices about inputs and outputs: outputs that are set, waits for inputs, and changes of simulated inputs.
They are plain values; times are those of the host's clock [s].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True, slots=True)
class OutputSet:
    """Notice that the program has set an output. It is sent once the controller has executed the line with
    the assignment, up to 50 ms later.
    """

    time: float
    name: str
    variable: str
    value: float


@dataclass(frozen=True, slots=True)
class WaitBegan:
    """Notice that the robot stands at a WAIT, at `place` in the program. The WAIT ends when the input's
    value, which is `value` now, is `wanted`.
    """

    time: float
    place: str
    name: str
    variable: str
    wanted: float
    value: float


@dataclass(frozen=True, slots=True)
class WaitEnded:
    """Notice that a WAIT is over, after `waited` [s]. `met` is True if the input has the wanted value; it is
    False if the time limit of the WAIT is over.
    """

    time: float
    place: str
    name: str
    variable: str
    value: float
    waited: float
    met: bool


@dataclass(frozen=True, slots=True)
class InputChanged:
    """Notice that an input of a simulated robot has changed. `cause` is script, sensor or hand."""

    time: float
    name: str
    variable: str
    value: float
    cause: str


Signal: TypeAlias = OutputSet | WaitBegan | WaitEnded | InputChanged


def state_text(value: float) -> str:
    """Return the value of an input or output in words: ON, OFF or the number."""
    return {0.0: "OFF", 1.0: "ON"}.get(value, f"{value:.15g}")


def signal_text(signal: Signal) -> str:
    """Return a notice about a signal in words.

    The start of a wait gives an empty text, since the notice at its end contains everything.
    """
    match signal:
        case OutputSet(name=name, value=value):
            return f"SET {name} {state_text(value)}"
        case WaitEnded(place=place, name=name, variable=variable, value=value, waited=waited, met=met):
            after = f" after {waited:.1f} s" if waited else ""
            if not variable:  # a condition has no variable
                return f"{place} WAIT: {name} {'holds' if met else 'still does not hold'}{after}"
            return f"{place} WAIT: {name} is {'' if met else 'still '}{state_text(value)}{after}"
        case InputChanged(name=name, value=value, cause=cause):
            return f"input {name} is {state_text(value)} ({cause})"
        case _:
            return ""
