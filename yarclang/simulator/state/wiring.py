"""Registers and variables that show the controller's state (facts 5.4, 5.5, 7), and timers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

from yarclang.pmac.status import (
    ACTUAL,
    COMMANDED,
    MOTOR_STATUS_1,
    MOTOR_STATUS_2,
    MOTOR_STEP,
    SYSTEM_STATUS_1,
    SYSTEM_STATUS_2,
    SYSTEM_STEP,
    TARGET,
)
from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.motion.system import CoordinateSystem
from yarclang.simulator.state import status
from yarclang.simulator.state.registers import Variables
from yarclang.simulator.state.status import (
    motor_word_1,
    motor_word_2,
    system_word_1,
    system_word_2,
    system_word_3,
)

LONGEST_TIMER = 8_388_607.0
LEAST_TIMER = -8_388_608.0


class Shown(status.Controller, Protocol):
    """The parts of the controller that registers and answers show."""

    variables: Variables

    @property
    def servo_period(self) -> float:
        """Time between servo interrupts [s]."""
        ...


class Timers:
    """The timers Isx11 and Isx12, stored as the times at which they reach 0.

    They are decremented in each servo cycle, also below 0, down to the smallest value of 24 bits (TSRM 176).
    """

    def __init__(self, controller: Shown) -> None:
        self._controller = controller
        self._ends: dict[int, float] = {}

    def clear(self) -> None:
        """Stop all timers, as at power-up."""
        self._ends.clear()

    def read(self, index: int) -> float:
        """Return the value of a timer [servo cycles]."""
        if (end := self._ends.get(index)) is None:
            return 0.0
        left = math.ceil((end - self._controller.now) / self._controller.servo_period - 1e-9)
        return float(max(left, LEAST_TIMER))

    def start(self, index: int, value: float) -> None:
        """Let a timer count down from a value [servo cycles]."""
        self._ends[index] = self._controller.now + min(value, LONGEST_TIMER) * self._controller.servo_period


def wire(controller: Shown) -> Timers:
    """Connect the registers of all motors and coordinate systems, and return the timers."""
    timers = Timers(controller)
    for motor in controller.motors.values():
        _wire_motor(controller, motor)
    for system in controller.systems.values():
        _wire_system(controller, system)
        for number in (11, 12):
            index = 5000 + 100 * system.number + number
            controller.variables.timers[index] = _timer(timers, index)
    return timers


def _timer(timers: Timers, index: int) -> tuple[Callable[[], float], Callable[[float], None]]:
    return lambda: timers.read(index), lambda value: timers.start(index, value)


def _wire_motor(controller: Shown, motor: Motor) -> None:
    """Connect the status words of a motor, and its positions in units of 1/(Ixx08 * 32) count."""
    wired = controller.variables.memory.wired
    step = MOTOR_STEP * (motor.number - 1)

    def position(counts: float) -> float:
        return float(round(counts * motor.unit))

    wired["X", MOTOR_STATUS_1 + step] = lambda wanted: motor_word_1(
        motor, controller.system_of(motor), controller.now, wanted
    )
    wired["Y", MOTOR_STATUS_2 + step] = lambda wanted: motor_word_2(
        motor, controller.system_of(motor), controller.now, wanted
    )
    wired["D", COMMANDED + step] = lambda _: position(motor.place(controller.now)[0])
    wired["D", ACTUAL + step] = lambda _: position(motor.actual(controller.now))
    wired["D", TARGET + step] = lambda _: position(
        motor.profile.target if motor.profile is not None else motor.place(controller.now)[0]
    )


def _wire_system(controller: Shown, system: CoordinateSystem) -> None:
    wired = controller.variables.memory.wired
    step = SYSTEM_STEP * (system.number - 1)

    wired["X", SYSTEM_STATUS_1 + step] = lambda _: system_word_1(system)
    wired["Y", SYSTEM_STATUS_2 + step] = lambda wanted: system_word_2(system, controller.now, wanted)
    wired["Y", SYSTEM_STATUS_1 + step] = lambda _: system_word_3(system)
