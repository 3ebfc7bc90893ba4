"""Inputs and outputs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from yarclang.diagnostics import Result
from yarclang.runtime.actions import Script, Trouble

if TYPE_CHECKING:
    from yarclang.coordinator.coordinator import Coordinator

_STATES = {"ON": 1.0, "OFF": 0.0}


class Signals:
    """The part of a client that reads inputs and sets outputs.

    Args:
        coordinator: of the robot.
        name: of the client.
    """

    def __init__(self, coordinator: Coordinator, name: str) -> None:
        self._coordinator = coordinator
        self._name = name

    async def read(self, name: str) -> Result[float]:
        """Return the value of an input or output that the session declares.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        signal = self._coordinator.names.signal(name)
        if signal.value is None:
            return Result(None, signal.diagnostics)
        return Result(await self._ask_number(signal.value.variable))

    async def set(self, name: str, value: float | str) -> Result[float]:
        """Give an output that the session declares a value, at once: a number, `ON` or `OFF`.

        Returns:
            What the controller says that it is then.

        Raises:
            NotOwner: this client only watches.
            Trouble: the value is none; the robot is under way (then outputs are the program's), or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to set an output")
        number = _number(value)
        output = coordinator.names.output(name)
        if output.value is None:
            return Result(None, output.diagnostics)
        variable = output.value.variable
        operation = coordinator.engine.operation
        await coordinator.engine.ask(lambda: operation.ask(f"{variable}={number:.9g}"))
        return Result(await self._ask_number(variable))

    async def _ask_number(self, variable: str) -> float:
        operation = self._coordinator.engine.operation

        def asked() -> Script[tuple[float, ...]]:
            return operation.numbers(variable, 1)

        (value,) = await self._coordinator.engine.ask(asked)
        return value


def _number(value: float | str) -> float:
    if isinstance(value, str) and value.upper() in _STATES:
        return _STATES[value.upper()]
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise Trouble(f"{value} is no value of an output", "it may be ON, OFF or a number", "Y1601")
    return number
