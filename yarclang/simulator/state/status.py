"""Status words of motors, coordinate systems and the controller (TSRM 281-290), computed from their current
state.

Each word is computed separately. The argument `fields` has the bits that the caller needs; a PLC, for
example, needs one bit at each scan. Bits that depend on the positions of the motors take long to compute.
They are computed only if `fields` contains one of them, and are 0 otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

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
from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.motion.system import CoordinateSystem
from yarclang.simulator.network.ports import Port

WHOLE = 0xFFFFFF


class Controller(Protocol):
    """The parts of the controller that status words describe."""

    motors: dict[int, Motor]
    systems: dict[int, CoordinateSystem]
    ports: dict[int, Port]

    @property
    def now(self) -> float:
        """Virtual time [s]."""
        ...

    def system_of(self, motor: Motor) -> CoordinateSystem | None:
        """Return the coordinate system in which a motor is defined."""
        ...


def _bits(word: dict[str, int], *names: str) -> int:
    return sum(1 << word[name] for name in names)


_PLACED = _bits(MOTOR_WORD_1, "negative limit set", "positive limit set", "desired velocity zero")
_MOTOR_FOLLOWS = _bits(MOTOR_WORD_2, "warning following error", "in position")
_SYSTEM_FOLLOWS = _bits(SYSTEM_WORD_2, "warning following error", "in position")


def digits(controller: Controller, marks: int, motor: int, system: int) -> str:
    """Return the answer to ?, ?? or ???: the status words of a motor, a coordinate system or the controller,
    in hexadecimal.

    Args:
        controller: the machine.
        marks: number of question marks.
        motor: number of the motor, for ?.
        system: number of the coordinate system, for ??.
    """
    words: tuple[int, ...]
    if marks == 1:
        found = controller.motors[motor]
        owner = controller.system_of(found)
        words = motor_word_1(found, owner, controller.now), motor_word_2(found, owner, controller.now)
    elif marks == 2:
        one = controller.systems[system]
        words = system_word_1(one), system_word_2(one, controller.now), system_word_3(one)
    else:
        words = global_word(controller.ports.values()), 0
    return "".join(f"{word:06X}" for word in words)


def motor_word_1(motor: Motor, system: CoordinateSystem | None, time: float, fields: int = WHOLE) -> int:
    """Return the first word of `#n?`, at a time [s]."""
    bits = MOTOR_WORD_1
    dwelling = system is not None and system.dwelling
    word = (
        motor.activated << bits["activated"]
        | motor.enabled << bits["amplifier enabled"]
        | (not motor.closed) << bits["open loop"]
        | (motor.driver is not None or dwelling) << bits["move timer active"]
        | dwelling << bits["dwell in progress"]
        | motor.data_error << bits["data block error"]
        | motor.aborting << bits["abort deceleration"]
        | motor.homing << bits["home search in progress"]
    )
    if fields & _PLACED:
        positive, negative = motor.set_limits(time)
        word |= (
            negative << bits["negative limit set"]
            | positive << bits["positive limit set"]
            | (motor.closed and not motor.place(time)[1]) << bits["desired velocity zero"]
        )
    return word


def motor_word_2(motor: Motor, system: CoordinateSystem | None, time: float, fields: int = WHOLE) -> int:
    """Return the second word of `#n?`, at a time [s]."""
    bits = MOTOR_WORD_2
    word = (
        motor.limit_stop << bits["stopped on limit"]
        | motor.homed << bits["home complete"]
        | motor.amplifier_fault << bits["amplifier fault"]
        | motor.fatal_error << bits["fatal following error"]
    )
    if fields & _MOTOR_FOLLOWS:
        warned, in_position = _following([motor], time)
        word |= warned << bits["warning following error"] | in_position << bits["in position"]
    if system is not None:
        axis = system.definitions[motor.number].terms[0][0]
        word |= 1 << bits["assigned"] | (system.number - 1) << 20 | AXIS_CODES.get(axis, 0) << 16
    return word


def system_word_1(system: CoordinateSystem) -> int:
    """Return the first word of `&n??`."""
    bits, moves = SYSTEM_WORD_1, system.calculation.moves
    continuous = system.running and not system.single_step
    word = (
        continuous << bits["continuous motion request"]
        | (not moves.feed) << bits["move by time"]
        | continuous << bits["continuous motion"]
        | system.single_step << bits["single step"]
        | system.running << bits["running"]
    )
    for axis, bit in INCREMENTAL_BITS.items():
        word |= (axis in moves.vector) << (bit + 1) | (axis in moves.incremental) << bit
    return word


def system_word_2(system: CoordinateSystem, time: float, fields: int = WHOLE) -> int:
    """Return the second word of `&n??`, at a time [s]."""
    bits, motors, rotary = SYSTEM_WORD_2, system.motors, system.calculation.rotary
    mode = MODE_BITS.get(system.calculation.moves.mode, 0)
    word = (
        (mode & 4) << 2
        | mode & 3
        | system.ahead.run_time_error << bits["run-time error"]
        | bool(system.ahead.steps) << bits["move in stack"]
        | any(motor.amplifier_fault for motor in motors) << bits["amplifier fault"]
        | any(motor.fatal_error for motor in motors) << bits["fatal following error"]
        | (rotary is not None and rotary.full) << bits["rotary full"]
        | system.dwelling << bits["dwell buffered"]
    )
    if fields & _SYSTEM_FOLLOWS:
        warned, in_position = _following(motors, time)
        word |= warned << bits["warning following error"]
        word |= (bool(motors) and in_position) << bits["in position"]
    return word


def system_word_3(system: CoordinateSystem) -> int:
    """Return the third word of `&n??`."""
    bits = SYSTEM_WORD_3
    return (
        system.resume_error << bits["resume error"] | system.limit_stop << bits["desired position limit stop"]
    )


def global_word(ports: Iterable[Port]) -> int:
    """Return the first word of `???`. Bits 16 to 20 show the open buffers (assumed)."""
    kinds = {port.open for port in ports}
    return ("rotary" in kinds) << 16 | ("prog" in kinds) << 17 | ("plc" in kinds) << 18


def _following(motors: Iterable[Motor], time: float) -> tuple[bool, bool]:
    """Return two flags: True if any motor has a following error beyond Ixx12; and True if all motors are in
    position.

    A motor in position is closed-loop, doesn't move, and has a following error within Ixx28. Ixx12 and Ixx28
    are in 1/16 count.
    """
    warned, in_position = False, True
    for motor in motors:
        error = abs(motor.following_error(time))
        warned = warned or 0.0 < motor.tuning(12) / 16.0 < error
        in_position = (
            in_position
            and motor.closed
            and not motor.jogging
            and motor.driver is None
            and error <= motor.tuning(28) / 16.0
        )
    return warned, in_position
