"""What a run looks at while it moves: motors, the program, positions. Nothing of it is stored by an open rotary. No I/O."""

from __future__ import annotations

from yarclang.robot.model import Robot
from yarclang.runtime.actions import Lost, Script, Trouble
from yarclang.runtime.pmac.feedback import MotorStatus, ReportError, counts_in, groups_of, in_order
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.rest import motor_statuses, system_words
from yarclang.runtime.sample import Sample


def look_at_motors(operation: Operation, robot: Robot) -> Script[tuple[MotorStatus, ...]]:
    """Their words.

    Raises:
        Trouble: one of them can't move.
    """
    motors = yield from motor_statuses(operation, robot)
    raise_trouble(robot, motors)
    return motors


RESET_REMEDY = "find out why; look at the robot, home it, and run `yarc doctor`"


def were_reset(motors: tuple[MotorStatus, ...]) -> bool:
    """Whether no motor is closed-loop or homed, as behind a reset: positions mean nothing then."""
    return all(motor.has("open loop") and not motor.has("home complete") for motor in motors)


def raise_trouble(robot: Robot, motors: tuple[MotorStatus, ...]) -> None:
    """Raise what keeps a motor from moving.

    A fault of one motor makes the controller kill others: what is told is the fault, not a loop that it has opened.

    Raises:
        Trouble: a reset, which opens all loops; else the first motor's with a fault, else the first's that is open-loop.
    """
    if were_reset(motors):
        raise Trouble("the controller was reset: no motor is closed-loop or homed", RESET_REMEDY, "Y1602")
    pairs = list(zip(robot.controller.motors, motors, strict=True))
    for number, motor in sorted(pairs, key=lambda pair: not pair[1].faulted):
        if what := motor.trouble:
            remedy = f"find out why, then close its loop: `#{number}J/`"
            raise Trouble(f"motor {number}: {what}", remedy, "Y1602")
    for number, motor in pairs:
        if not motor.has("home complete"):
            what = f"motor {number}: it isn't homed any more: its position means nothing"
            raise Trouble(what, "find out who has used this controller, and home it", "Y1602")


def look_whether_astray(operation: Operation, robot: Robot, off: tuple[float, int]) -> Script[None]:
    """Raise if the controller commands the motors off the way of its lines; a motor that was stopped by a fault or a limit is told instead.

    Args:
        operation: the run.
        robot: whose motors.
        off: how far [counts], and the row of the motor that is furthest.

    Raises:
        Trouble: it does.
    """
    counts, row = off
    if counts:
        yield from look_at_motors(operation, robot)
        raise Trouble(
            f"the controller commands motor {robot.controller.motors[row]} {counts:.0f} counts off the path that was proved",
            "a line has been changed on its way, or somebody else uses this controller: run `yarc doctor`",
            "Y1605",
        )


def look_at_program(operation: Operation, robot: Robot) -> Script[None]:
    """Where nothing moves: does it run?

    Raises:
        Trouble: it doesn't, or has met an error.
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
            "the controller doesn't run the program any more: somebody else has stopped it",
            "find out who else uses this controller",
            "Y1605",
        )


def sample(
    operation: Operation, robot: Robot, program_time: float, clock: float | None = None
) -> Script[Sample]:
    """Where the robot is, by ^P and ^F.

    Args:
        operation: the run.
        robot: whose motors.
        program_time: how far the program is [s], with the ways of a WHEN one after the other.
        clock: likewise, with both ways at once.

    Raises:
        Lost: a report isn't one.
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
