"""Status words of motors, coordinate systems and the controller (TSRM 281-290), from what they do now."""

from __future__ import annotations

from yarclang.pmac.status import (
    AXIS_CODES,
    INCREMENTAL_BITS,
    MODE_BITS,
    MOTOR_WORD_1,
    MOTOR_WORD_2,
    SYSTEM_WORD_1,
    SYSTEM_WORD_2,
    SYSTEM_WORD_3,
)
from yarclang.simulator.motors import Motor
from yarclang.simulator.system import CoordinateSystem


def packed(bits: dict[str, int], names: dict[str, bool]) -> int:
    """The word with the bits of the names that hold."""
    return sum(1 << bits[name] for name, holds in names.items() if holds)


def in_position(motor: Motor, time: float) -> bool:
    """Closed loop, desired velocity zero, no move under way, following error within Ixx28 (1/16 count)."""
    return (
        motor.closed
        and not motor.jogging
        and motor.driver is None
        and abs(motor.following_error(time)) <= motor.tuning(28) / 16.0
    )


def warned(motor: Motor, time: float) -> bool:
    """Whether the following error is beyond Ixx12 (1/16 count)."""
    return 0.0 < motor.tuning(12) / 16.0 < abs(motor.following_error(time))


def motor_words(motor: Motor, system: CoordinateSystem | None, time: float) -> tuple[int, int]:
    """Both words of `#n?`."""
    positive, negative = motor.set_limits(time)
    dwelling = system is not None and system.dwell_until is not None
    first = packed(
        MOTOR_WORD_1,
        {
            "activated": motor.activated,
            "negative limit set": negative,
            "positive limit set": positive,
            "amplifier enabled": motor.enabled,
            "open loop": not motor.closed,
            "move timer active": motor.driver is not None or dwelling,
            "dwell in progress": dwelling,
            "data block error": motor.data_error,
            "desired velocity zero": motor.closed and not motor.place(time)[1],
            "abort deceleration": motor.aborting,
            "home search in progress": motor.homing,
        },
    )
    second = packed(
        MOTOR_WORD_2,
        {
            "assigned": system is not None,
            "stopped on limit": motor.limit_stop,
            "home complete": motor.homed,
            "amplifier fault": motor.amplifier_fault,
            "fatal following error": motor.fatal_error,
            "warning following error": warned(motor, time),
            "in position": in_position(motor, time),
        },
    )
    if system is not None:
        terms = system.definitions[motor.number].terms
        second |= (system.number - 1) << 20 | AXIS_CODES.get(terms[0][0], 0) << 16
    return first, second


def system_words(system: CoordinateSystem, time: float) -> tuple[int, int, int]:
    """The three words of `&n??`."""
    calculation = system.calculation
    motors = system.motors
    first = packed(
        SYSTEM_WORD_1,
        {
            "continuous motion request": system.running and not system.single_step,
            "move by time": not calculation.feed,
            "continuous motion": system.running and not system.single_step,
            "single step": system.single_step,
            "running": system.running,
        },
    )
    for axis, bit in INCREMENTAL_BITS.items():
        first |= (axis in calculation.vector) << (bit + 1) | (axis in calculation.incremental) << bit
    rotary = calculation.rotary
    second = packed(
        SYSTEM_WORD_2,
        {
            "run-time error": system.run_time_error,
            "move in stack": bool(system.steps),
            "amplifier fault": any(motor.amplifier_fault for motor in motors),
            "fatal following error": any(motor.fatal_error for motor in motors),
            "warning following error": any(warned(motor, time) for motor in motors),
            "in position": bool(motors) and all(in_position(motor, time) for motor in motors),
            "rotary full": rotary is not None and rotary.full,
            "dwell buffered": system.dwell_until is not None,
        },
    )
    mode = MODE_BITS.get(calculation.mode, 0)
    second |= (mode & 4) << 2 | mode & 3
    third = packed(
        SYSTEM_WORD_3,
        {"resume error": system.resume_error, "desired position limit stop": system.limit_stop},
    )
    return first, second, third
