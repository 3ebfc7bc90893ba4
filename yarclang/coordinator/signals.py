"""Conversion of changes of inputs and outputs to events of the coordinator."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

from yarclang.cell.model import Cell
from yarclang.coordinator.messages import events
from yarclang.coordinator.values import Values
from yarclang.hir import Program
from yarclang.runtime.actions import Trouble
from yarclang.runtime.session import Session
from yarclang.runtime.signals import InputChanged, OutputSet, Signal, WaitBegan, WaitEnded
from yarclang.simulated_cell.camera import Given
from yarclang.simulated_cell.inputs import Set
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulated_cell.script import known_in

_DIGITS = 4

_EVENTS: dict[type, Any] = {
    OutputSet: events.OutputSet,
    WaitBegan: events.WaitBegan,
    WaitEnded: events.WaitEnded,
    InputChanged: events.InputChanged,
}


def signal_event(signal: Signal) -> events.BaseEvent:
    """Return a signal of a run as an event."""
    kind = _EVENTS[type(signal)]
    said = {name: getattr(signal, name) for name in signal.__slots__ if name not in ("time", "waited")}
    if isinstance(signal, WaitEnded):
        said["waited_s"] = round(signal.waited, _DIGITS)
    event: events.BaseEvent = kind(time_s=round(signal.time, _DIGITS), **said)
    return event


def hear_inputs(
    surroundings: SimulatedCell, session: Session, later: Callable[[Callable[[Set], None], Set], object]
) -> None:
    """Make a session report each change of an input of a simulated controller.

    Args:
        surroundings: the machines around the robot, which run in another thread.
        session: session that reports the changes.
        later: schedules the call of a function, with one argument, in the session's event loop.
    """

    def tell(event: Set) -> None:
        names = {variable: name for name, variable in surroundings.known.inputs.items()}
        changed = InputChanged(
            session.now(), names.get(event.variable, event.variable), event.variable, event.value, event.cause
        )
        session.operation.notices.append(changed)

    def heard(event: Set) -> None:
        with contextlib.suppress(RuntimeError):  # the event loop has ended
            later(tell, event)

    surroundings.listen(heard)


def receive_values(
    surroundings: SimulatedCell, values: Values, later: Callable[[Callable[[Given], None], Given], object]
) -> None:
    """Make the cameras of a simulated cell send values to the running program, as a client would.

    Args:
        surroundings: the machines around the robot, which run in another thread.
        values: receiver of the values.
        later: schedules the call of a function, with one argument, in the session's event loop.
    """

    def take(values_given: Given) -> None:
        with contextlib.suppress(Trouble):  # the refusal is logged, and cameras don't read it
            values.take(values_given.values, values_given.number, values_given.camera)

    def received(values_given: Given) -> None:
        with contextlib.suppress(RuntimeError):  # the event loop has ended
            later(take, values_given)

    surroundings.receive(received)


def output_names(program: Program | None, cell: Cell | None) -> dict[str, str]:
    """Return the names of the outputs of a program and its cell, by their variables."""
    return {variable: name for name, variable in known_in(program, cell).outputs.items()}
