"""Machines as the controllers of robots stand ready."""

from __future__ import annotations

from yarclang.robot.actuation import to_counts
from yarclang.robot.model import Robot
from yarclang.simulator.machine import Machine
from yarclang.simulator.motion.pieces import Array
from yarclang.simulator.recorder import Recorder


def commissioned(robot: Robot, settings: str, *, record: Recorder | None = None) -> Machine:
    """A machine as a robot's controller stands ready: settings loaded and saved, PLCs enabled, motors activated,
    closed-loop and homed, at the robot's HOME.

    Args:
        robot: whose controller it is.
        settings: what `yarc settings` prints.
        record: keeps the motions.

    Raises:
        ValueError: where the machine refuses a line of the settings.
    """
    machine = Machine(record=record)
    for motor in robot.controller.motors:
        machine.command(f"I{motor}00=1")
    for number, line in enumerate(settings.splitlines(), 1):
        reply = machine.command(line)
        if reply.error is not None:
            raise ValueError(f"line {number} of the settings, {line!r}: ERR{reply.error:03d}")
    machine.save()
    stand(machine, robot, robot.home)
    return machine


def stand(machine: Machine, robot: Robot, q: Array) -> None:
    """Put the motors of a machine, closed-loop and homed, where the joints are at `q` (n,) [rad or m]."""
    for motor, counts in zip(robot.controller.motors, to_counts(robot, q), strict=True):
        found = machine.motors[motor]
        found.hold(machine.now)
        found.stand = float(counts)
        found.closed = found.enabled = found.homed = True
        machine.changed([found])
    for system in machine.systems.values():
        system.pmatch()
