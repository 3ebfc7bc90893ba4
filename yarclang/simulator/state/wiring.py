"""Registers and variables that show what the machine does (facts 5.4, 5.5, 7), and the timers that count down."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

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
from yarclang.simulator.state.status import (
    motor_word_1,
    motor_word_2,
    system_word_1,
    system_word_2,
    system_word_3,
)

if TYPE_CHECKING:
    from yarclang.simulator.machine import Machine

LONGEST_TIMER = 8_388_607.0
LEAST_TIMER = -8_388_608.0


class Timers:
    """Isx11 and Isx12 count down, one each servo cycle, through 0 to the least of 24 bits (TSRM 176): what is kept is when they get to 0."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.ends: dict[int, float] = {}

    def read(self, index: int) -> float:
        """What is left, in servo cycles."""
        if (end := self.ends.get(index)) is None:
            return 0.0
        left = math.ceil((end - self.machine.now) / self.machine.servo_period - 1e-9)
        return float(max(left, LEAST_TIMER))

    def start(self, index: int, value: float) -> None:
        """Count down from `value`."""
        self.ends[index] = self.machine.now + min(value, LONGEST_TIMER) * self.machine.servo_period


def wire(machine: Machine) -> Timers:
    """Connect the registers of all motors and coordinate systems; the timers."""
    timers = Timers(machine)
    for motor in machine.motors.values():
        _wire_motor(machine, motor)
    for system in machine.systems.values():
        _wire_system(machine, system)
        for number in (11, 12):
            index = 5000 + 100 * system.number + number
            machine.variables.timers[index] = _timer(timers, index)
    return timers


def _timer(timers: Timers, index: int) -> tuple[Callable[[], float], Callable[[float], None]]:
    return lambda: timers.read(index), lambda value: timers.start(index, value)


def _wire_motor(machine: Machine, motor: Motor) -> None:
    """Status words, and positions in 1/(Ixx08 32) count."""
    wired = machine.variables.memory.wired
    step = MOTOR_STEP * (motor.number - 1)

    def position(counts: float) -> float:
        return float(round(counts * motor.unit))

    wired["X", MOTOR_STATUS_1 + step] = lambda wanted: motor_word_1(
        motor, machine.system_of(motor), machine.now, wanted
    )
    wired["Y", MOTOR_STATUS_2 + step] = lambda wanted: motor_word_2(
        motor, machine.system_of(motor), machine.now, wanted
    )
    wired["D", COMMANDED + step] = lambda _: position(motor.place(machine.now)[0])
    wired["D", ACTUAL + step] = lambda _: position(motor.actual(machine.now))
    wired["D", TARGET + step] = lambda _: position(
        motor.profile.target if motor.profile is not None else motor.place(machine.now)[0]
    )


def _wire_system(machine: Machine, system: CoordinateSystem) -> None:
    wired = machine.variables.memory.wired
    step = SYSTEM_STEP * (system.number - 1)

    wired["X", SYSTEM_STATUS_1 + step] = lambda _: system_word_1(system)
    wired["Y", SYSTEM_STATUS_2 + step] = lambda wanted: system_word_2(system, machine.now, wanted)
    wired["Y", SYSTEM_STATUS_1 + step] = lambda _: system_word_3(system)
