"""Checks of the motors, the program and the positions while the robot moves. They use only questions that an
open rotary buffer doesn't store. No I/O.
"""

from __future__ import annotations

from yarclang.robot.model import Robot
from yarclang.runtime.actions import Lost, Script, Trouble
from yarclang.runtime.pmac.feedback import MotorStatus, ReportError, counts_in, groups_of, in_order
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.rest import motor_statuses, system_words
from yarclang.runtime.sample import Sample


def look_at_motors(operation: Operation, robot: Robot) -> Script[tuple[MotorStatus, ...]]:
    """Return the status words of the motors.

    Raises:
        Trouble: one of them can't move.
    """
    motors = yield from motor_statuses(operation, robot)
    raise_trouble(robot, motors)
    return motors


RESET_REMEDY = "find the cause, inspect the robot, home it, and run `yarc doctor`"


def were_reset(motors: tuple[MotorStatus, ...]) -> bool:
    """Return True if no motor is closed-loop or homed, as after a reset of the controller. Positions are
    then invalid.
    """
    return all(motor.has("open loop") and not motor.has("home complete") for motor in motors)


def raise_trouble(robot: Robot, motors: tuple[MotorStatus, ...]) -> None:
    """Raise the fault that keeps a motor from moving, if there is one.

    If a motor has a fault, the controller also opens the loops of other motors. The motor with the fault is
    therefore reported first, and a motor with an open loop only if no motor has a fault.

    Raises:
        Trouble: a motor can't move. The reason is the first of these that applies: a reset, which opens all
            loops; a motor with a fault; a motor with an open loop; a motor that isn't homed.
    """
    if were_reset(motors):
        raise Trouble("the controller was reset: no motor is closed-loop or homed", RESET_REMEDY, "Y1602")
    pairs = list(zip(robot.controller.motors, motors, strict=True))
    for number, motor in sorted(pairs, key=lambda pair: not pair[1].faulted):
        if problem := motor.trouble:
            remedy = f"find out why, then close its loop: `#{number}J/`"
            raise Trouble(f"motor {number}: {problem}", remedy, "Y1602")
    for number, motor in pairs:
        if not motor.has("home complete"):
            problem = f"motor {number}: it isn't homed any more: its position is meaningless"
            raise Trouble(
                problem, "find the client that has used this controller, and home the motor", "Y1602"
            )


def look_whether_astray(operation: Operation, robot: Robot, off: tuple[float, int]) -> Script[None]:
    """Raise a fault if the motors' commanded positions are off the path of the lines that were sent.

    If a fault or a limit has stopped a motor, that is reported instead.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot whose motors are checked.
        off: largest distance from the path [counts], and the row of its motor.

    Raises:
        Trouble: the motors are off the path.
    """
    counts, row = off
    if counts:
        yield from look_at_motors(operation, robot)
        raise Trouble(
            f"the controller commands motor {robot.controller.motors[row]} {counts:.0f} counts off the "
            "proved path",
            "a line was changed on its way, or another client uses this controller: run `yarc doctor`",
            "Y1605",
        )


def look_at_program(operation: Operation, robot: Robot) -> Script[None]:
    """Check, while nothing moves, that the program hasn't ended.

    Raises:
        Trouble: the program doesn't run, or has met an error.
    """
    system = yield from system_words(operation, robot)
    if system.run_time_error:
        raise Trouble(
            "the controller couldn't calculate a move in time",
            "compile with longer segments (--tm)",
            "Y1605",
        )
    if not system.running:
        raise Trouble(
            "the controller doesn't run the program any more: another client has stopped it",
            "find other clients of this controller",
            "Y1605",
        )


def sample(
    operation: Operation, robot: Robot, program_time: float, clock: float | None = None
) -> Script[Sample]:
    """Ask for the robot's position, by ^P and ^F, and return it as a sample.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot whose motors are asked.
        program_time: progress of the program [s], counting both branches of each WHEN, one after the other.
        clock: progress of the program [s], counting only the longer branch of each WHEN passed before.

    Raises:
        Lost: a report can't be parsed.
    """
    motors = robot.controller.motors
    actual: dict[int, float] = {}
    following: dict[int, float] = {}
    groups = groups_of(motors)
    for group in groups:
        if len(groups) > 1:
            yield from operation.ask(f"##{group}")
        places = yield from operation.report("\x10")
        errors = yield from operation.report("\x06")
        try:
            actual |= counts_in(places, group, motors)
            following |= counts_in(errors, group, motors)
        except ReportError as error:
            raise Lost(str(error)) from None
    return Sample(operation.now, program_time, in_order(actual, motors), in_order(following, motors), clock)
