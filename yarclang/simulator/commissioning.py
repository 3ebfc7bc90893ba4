"""Simulated controllers that are set up for a robot."""

from __future__ import annotations

import math

from yarclang.pmac.defaults import MOTOR
from yarclang.robot.actuation import to_counts
from yarclang.robot.model import Robot
from yarclang.simulator.machine import Machine
from yarclang.simulator.motion.motors import LAG
from yarclang.simulator.motion.pieces import Array
from yarclang.simulator.motion.recorder import Recorder

_MARGIN = 2.0
_LARGEST = 8_388_607
"""Largest value of Ixx11 (the limit of a motor's following error), which has 23 bits (TSRM 95)."""


def commissioned(robot: Robot, settings: str, *, record: Recorder | None = None) -> Machine:
    """Return a simulated controller that is ready to move a robot.

    Its settings are loaded and saved, its PLCs are enabled, and its motors are activated, closed-loop and
    homed, at the robot's HOME.

    Args:
        robot: the robot that the controller moves.
        settings: the output of `yarc settings`.
        record: records the motions.

    Raises:
        ValueError: if the controller refuses a line of the settings.
    """
    machine = Machine(record=record)
    for motor, velocity in zip(robot.controller.motors, robot.actuation.velocity, strict=True):
        machine.command(f"I{motor}00=1")
        if (limit := fatal_limit(float(velocity))) > MOTOR[11]:
            machine.command(f"I{motor}11={limit}")
    for number, line in enumerate(settings.splitlines(), 1):
        reply = machine.command(line)
        if reply.error is not None:
            raise ValueError(f"line {number} of the settings, {line!r}: ERR{reply.error:03d}")
    machine.save()
    stand(machine, robot, robot.home)
    return machine


def fatal_limit(velocity: float) -> int:
    """Return a suitable Ixx11 [1/16 count] for a motor: twice its following error at its largest speed, given
    in counts/s.

    The default of 2,000 counts is only 0.2 mm on a linear axis with 10,000 counts/mm. With this limit, the
    following error at an ordinary speed would already be a fault.
    """
    if not math.isfinite(velocity):
        return int(MOTOR[11])
    return min(math.ceil(16.0 * _MARGIN * LAG * velocity), _LARGEST)


def stand(machine: Machine, robot: Robot, q: Array) -> None:
    """Place the motors of a simulated controller at joint values `q` (n,) [rad or m], closed-loop and
    homed.
    """
    for motor, counts in zip(robot.controller.motors, to_counts(robot, q), strict=True):
        found = machine.motors[motor]
        found.hold(machine.now)
        found.stand = float(counts)
        found.closed = found.enabled = found.homed = True
        machine.changed([found])
    for system in machine.systems.values():
        system.pmatch()
