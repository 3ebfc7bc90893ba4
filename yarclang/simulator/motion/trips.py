"""Trips: stops of motors because of limits, following errors and amplifier faults. Other motors may stop
too.
"""

from __future__ import annotations

from typing import Protocol

from yarclang.simulator.motion import drive
from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.motion.system import CoordinateSystem

_NO_SWITCHES = 0x20000
"""Bit 17 of Ixx24: limit switches are ignored."""


class Surroundings(drive.Surroundings, Protocol):
    """The parts of the controller that a trip needs: the other motors and the coordinate systems, which may
    have to stop too.
    """

    motors: dict[int, Motor]
    systems: dict[int, CoordinateSystem]

    def system_of(self, motor: Motor) -> CoordinateSystem | None:
        """Return the coordinate system in which a motor is defined."""
        ...


def tripped(outside: Surroundings, motor: Motor, cause: str) -> None:
    """Stop a motor that has tripped. If the cause is "limit", the motor's coordinate system aborts; for any
    other cause the motor is killed.
    """
    system = outside.system_of(motor)
    motor.trip = None
    if cause != "limit":
        motor.fatal_error = True
        kill(outside, motor)
        return
    if system is not None and system.busy:
        system.limit_stop = True
        system.abort()
    else:
        motor.abort(outside.now)
    motor.limit_stop = True
    outside.changed([motor])


def kill(outside: Surroundings, motor: Motor) -> None:
    """Kill a motor (open its loop) after a fault.

    Ixx24 bits 22 and 21 select the other motors to kill: 0 all, 1 those of its coordinate system, otherwise
    none (assumed).
    """
    extent = int(motor.tuning(24)) >> 21 & 3
    system = outside.system_of(motor)
    if system is not None:
        system.abort()
    others: list[Motor] = []
    if extent == 0:
        others = [other for other in outside.motors.values() if other.activated]
        for each in outside.systems.values():
            if each is not system and each.busy:
                each.abort()
    elif extent == 1 and system is not None:
        others = system.motors
    for other in {id(m): m for m in (motor, *others)}.values():
        other.kill(outside.now)
        outside.changed([other])


def switch(motor: Motor, side: int, on: bool) -> None:
    """Set the state of a limit switch of a motor; `side` is +1 or -1."""
    motor.switches[1 if side > 0 else -1] = on and not int(motor.tuning(24)) & _NO_SWITCHES


def look(outside: Surroundings, motor: Motor) -> None:
    """After a change of limits or switches, check if a motor trips now, and compute again if it will trip
    later in its motion.
    """
    if motor.closed and (cause := motor.tripped(*motor.place(outside.now))):
        tripped(outside, motor, cause)
        return
    motor.look_again()
    system = outside.system_of(motor)
    if system is not None:
        system.drive.look_again()
