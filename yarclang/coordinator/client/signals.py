"""A client's actions on inputs and outputs."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable
from functools import partial

from yarclang.coordinator.client.part import Part
from yarclang.decisions import bits_of, is_group, largest_of, shown_variable
from yarclang.diagnostics import Diagnostic, Result
from yarclang.runtime.actions import Trouble
from yarclang.simulated_cell.script import input_variable

_STATES = {"ON": 1.0, "OFF": 0.0}

_FIXED = "the inputs of a real controller are set by the connected devices (Y1619)"
_AT_ONCE = 16
"""Largest number of variables that are read in one request. A request must fit into a line of 255 characters.
"""


class Signals(Part):
    """Group of a client's actions: read and set inputs and outputs."""

    async def read(self, name: str) -> Result[float]:
        """Return the value of an input or output that the session declares.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        signal = self._coordinator.names.signal(name)
        if signal.value is None:
            return Result(None, signal.diagnostics)
        bits = [await self._ask_number(bit) for bit in bits_of(signal.value.variable)]
        return Result(
            bits[0] if len(bits) == 1 else sum(value * (1 << place) for place, value in enumerate(bits))
        )

    async def set(self, name: str, value: float | str) -> Result[float]:
        """Set an output that the session declares, at once.

        Args:
            name: name of the output.
            value: a number, `ON` or `OFF`.

        Returns:
            The value that the controller reports afterwards.

        Raises:
            NotOwner: this client only watches.
            Trouble: the value is invalid; the robot is moving, so that only the program may set outputs; or
                there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to set an output")
        number = _number(value)
        output = coordinator.names.output(name)
        if output.value is None:
            return Result(None, output.diagnostics)
        group = output.value.variable
        each = _of_bits(group, number)
        operation = coordinator.engine.operation
        made = coordinator.names.cell().value
        cell = None if made is None else made.cell
        pattern = 0.0
        for place, (variable, wanted) in enumerate(each):
            moves = cell is not None and bool(cell.parts) and variable in (*cell.grips, *cell.removals)
            position = await coordinator.stands() if moves else None
            write = partial(coordinator.engine.scripts.write, operation, variable, wanted)
            await coordinator.engine.ask(write)
            value = await self._ask_number(variable)
            if position is not None:
                coordinator.carrying.kept.set(cell, variable, value, position)
            pattern += value * (1 << place)
        return Result(pattern)

    def set_input(self, name: str, value: float | str) -> Result[float]:
        """Set an input of a simulated robot, also while a program runs.

        Args:
            name: name of an input of the session or of a program that was run, or a variable of the
                controller.
            value: a number, `ON` or `OFF`.

        Raises:
            NotOwner: another client owns the robot and doesn't share it.
            Trouble: the value is invalid; the robot isn't simulated in this process; or there is no input
                with this name.
        """
        coordinator = self._coordinator
        if coordinator.owner:
            coordinator.check_pace(self._name, "to set an input")
        number = _number(value)
        surroundings = coordinator.surroundings
        if surroundings is None:
            raise Trouble(
                f"{name[:40]} is an input of a real controller: only the connected devices set it",
                "set inputs of a robot that `yarc run`, `serve` or `repl` simulates",
                "Y1619",
            )
        known = surroundings.known
        if (declared := coordinator.names.input(name).value) is not None:
            variable: str | Diagnostic = declared.variable
        else:
            variable = input_variable(name, known)
        if isinstance(variable, Diagnostic):
            raise Trouble(variable.clause, variable.help, variable.code)
        for bit, value_of_bit in _of_bits(variable, number):
            surroundings.set(bit, value_of_bit)
        return Result(number)

    @property
    def fixed(self) -> str:
        """Return the reason why a user can't set inputs; empty if a user can."""
        return "" if self._coordinator.surroundings is not None else _FIXED

    async def values(self, variables: Iterable[str]) -> dict[str, float | None]:
        """Return the values of controller variables. Values of a real controller are None while the robot
        is moving.
        """
        levels: dict[str, float | None] = dict.fromkeys(variables)
        on_controller = [one for one in levels if one]  # a faulty declaration has no variable
        surroundings = self._coordinator.surroundings
        if surroundings is not None:
            return levels | {one: surroundings.value(one) for one in on_controller}
        engine = self._coordinator.engine
        for first in range(0, len(on_controller), _AT_ONCE):
            some = on_controller[first : first + _AT_ONCE]
            with contextlib.suppress(Trouble):
                values = await engine.ask(partial(engine.scripts.read, engine.operation, some))
                levels.update(zip(some, values, strict=True))
        return levels

    async def _ask_number(self, variable: str) -> float:
        engine = self._coordinator.engine
        (value,) = await engine.ask(lambda: engine.scripts.read(engine.operation, (variable,)))
        return value


def _of_bits(variable: str, number: float) -> tuple[tuple[str, float], ...]:
    """Return the controller variables to set for a signal, with their values: one variable, or one for each
    bit of a group.

    Raises:
        Trouble: the group can't have this value.
    """
    if not is_group(variable):
        return ((variable, number),)
    bits = bits_of(variable)
    if not number.is_integer() or not 0 <= number <= largest_of(variable):
        raise Trouble(
            f"the group {shown_variable(variable)} is an integer from 0 to {largest_of(variable)}, not "
            f"{number:.15g}",
            "check the number",
            "Y0470",
        )
    return tuple((bit, float(int(number) >> place & 1)) for place, bit in enumerate(bits))


def _number(value: float | str) -> float:
    if isinstance(value, str) and value.upper() in _STATES:
        return _STATES[value.upper()]
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise Trouble(f"{value} isn't a value of an output", "it must be ON, OFF or a number", "Y1601")
    return number
