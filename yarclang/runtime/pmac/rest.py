"""Checks that the robot is at rest, and questions for its position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import ARMED, WATCHED, commanded_position, motor_variable
from yarclang.robot.actuation import from_counts
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Lost, Script, Trouble, Wait
from yarclang.runtime.job import Job
from yarclang.runtime.pmac.feedback import (
    MotorStatus,
    ReportError,
    SystemStatus,
    groups_of,
    statuses_in,
    system_status,
)
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.standing import off_the_start

LONGEST = 15.0
"""Longest time to wait for rest [s]. A robot that moves even after this time won't stop by itself."""

_POLL = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Standing:
    """Position of the robot at rest: commanded joint positions (n,) [rad or m], and the status words of
    its motors.
    """

    joints: Array
    motors: tuple[MotorStatus, ...]


def motor_statuses(operation: Operation, robot: Robot) -> Script[tuple[MotorStatus, ...]]:
    """Return the status words of all motors of a robot, in the robot's order. This works even if a buffer is
    open.
    """
    motors = robot.controller.motors
    statuses: dict[int, MotorStatus] = {}
    groups = groups_of(motors)
    for group in groups:
        if len(groups) > 1 or group != 1:
            yield from operation.ask(f"##{group}")
        text = yield from operation.report("\x02")
        try:
            statuses |= statuses_in(text, group, motors)
        except ReportError as error:
            raise Lost(str(error)) from None
    operation.motors = tuple(statuses[motor] for motor in motors)
    return operation.motors


def system_words(operation: Operation, robot: Robot) -> Script[SystemStatus]:
    """Return the status words of the robot's coordinate system."""
    text = yield from operation.one(f"&{turbo_pmac(robot).coordinate_system}??")
    try:
        return system_status(text)
    except ReportError as error:
        raise Lost(str(error)) from None


def come_to_rest(
    operation: Operation, robot: Robot, longest: float = LONGEST
) -> Script[tuple[MotorStatus, ...]]:
    """Wait until no motor has a desired velocity in two consecutive readings, and until every hold must be
    over. Return the motors' status words.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot.
        longest: longest time to wait [s].

    Raises:
        Trouble: a motor moves even after `longest`.
    """
    since = operation.now
    reads_at_rest = 0
    while True:
        motors = yield from motor_statuses(operation, robot)
        counts = all(motor.at_rest for motor in motors) and operation.now >= operation.settled
        reads_at_rest = reads_at_rest + 1 if counts else 0
        if reads_at_rest == 2:
            return motors
        if operation.now - since > longest:
            moving = [
                number
                for number, motor in zip(robot.controller.motors, motors, strict=True)
                if not motor.at_rest
            ]
            raise Trouble(
                f"after {longest:g} s the robot still moves (motor {', '.join(map(str, moving))})",
                "if it shouldn't move, press the emergency stop",
            )
        yield Wait(operation.now + _POLL)


def leave(operation: Operation, robot: Robot) -> Script[None]:
    """Leave the controller in a known state, with the robot at rest.

    Close all buffers, and disarm the guard and the watchdog. End a program that runs, even in a hold or with
    an empty rotary, and end the hold. Discard the remaining lines, and set the override to 100 %. The command
    A ends programs and holds. It would also close the loops of killed motors; it is therefore omitted if a
    loop is open and no program runs.
    """
    system = turbo_pmac(robot).coordinate_system
    operation.ahead = None
    yield from operation.ask("CLOSE ALL")
    yield from operation.ask(f"{ARMED}=0 {WATCHED}=0")
    motors = yield from motor_statuses(operation, robot)
    words = yield from system_words(operation, robot)
    if words.running or not any(motor.has("open loop") for motor in motors):
        yield from operation.ask(f"&{system}A")
    yield from operation.ask(f"&{system}DELETE ROT")
    yield from operation.ask(f"&{system}%100")


def stands_at(operation: Operation, robot: Robot) -> Script[Array]:
    """Return the commanded joint positions (n,) [rad or m], read from the controller's registers (M161 and so
    on). No buffer may be open on our port of the controller.
    """
    motors = robot.controller.motors
    asked = "".join(commanded_position(motor)[0] for motor in motors)
    values = yield from operation.numbers(
        asked + "".join(motor_variable(motor, 8) for motor in motors), 2 * len(motors)
    )
    registers, scales = values[: len(motors)], values[len(motors) :]
    if not all(scale > 0.0 for scale in scales):
        raise Trouble("a motor's position scale Ixx08 is 0", f"download `yarc settings {robot.name}`")
    counts = np.array(registers) / (32.0 * np.array(scales))
    return from_counts(robot, counts)


def away_from_start(
    operation: Operation, job: Job, remedy: str = "give --approach for a slow, certified motion to the start"
) -> Script[None]:
    """Check that the robot stands at the start of a job.

    Args:
        operation: state of the run, and access to the controller.
        job: the job.
        remedy: what people should do if the robot isn't at the start.

    Raises:
        Trouble: a joint is further from the start than the first segment allows.
    """
    joints = yield from stands_at(operation, job.robot)
    if text := off_the_start(job, joints):
        raise Trouble(text, remedy)
