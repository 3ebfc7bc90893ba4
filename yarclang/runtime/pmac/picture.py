"""The state of a controller, as shown to people, whoever uses the controller. No I/O."""

from __future__ import annotations

from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import ARMED
from yarclang.robot.actuation import from_counts
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Lost, Script
from yarclang.runtime.pmac.feedback import MotorStatus, ReportError, counts_in, groups_of, in_order
from yarclang.runtime.pmac.operation import Operation, Refused
from yarclang.runtime.pmac.rest import motor_statuses, system_words
from yarclang.runtime.scripts import JointPlace, Picture

_GUARD = {
    0.0: "not armed",
    1.0: "armed: it holds when the rotary buffer runs low",
    2.0: "it has held the motion: the rotary buffer had run low",
}


def picture(operation: Operation, robot: Robot) -> Script[Picture]:
    """Return the controller's state. A killed run may have left its rotary buffer open; only questions that
    an open buffer doesn't store are therefore asked.
    """
    kind = yield from operation.one("TYPE")
    identity = yield from operation.one("CID")
    firmware = yield from operation.one("VERSION")
    system = yield from system_words(operation, robot)
    motors = yield from motor_statuses(operation, robot)
    number = turbo_pmac(robot).coordinate_system
    (override,) = yield from operation.numbers(f"&{number}%", 1)
    (guard,) = yield from operation.numbers(ARMED, 1)
    if not system.running:
        program = f"none runs in coordinate system {number}"
    elif all(motor.at_rest for motor in motors):
        program = "one is unfinished: held, or waiting for lines; end it with `yarc stop --to ...`"
    else:
        program = "one runs"
    words = {
        motor: _motor_words(status) for motor, status in zip(robot.controller.motors, motors, strict=True)
    }
    places = yield from _places(operation, robot)
    guarding = f"{_GUARD.get(guard, 'an undefined value')} ({ARMED} is {guard:g})"
    return Picture(
        f"{kind} (CID {identity})", firmware, program, round(override, 3), guard, guarding, words, places
    )


def _places(operation: Operation, robot: Robot) -> Script[tuple[JointPlace, ...]]:
    """Return the commanded joint positions, by ^P and ^F, and the actual ones as the controller computes
    them. The position register M161 isn't asked for, because an open buffer would store this question.
    """
    motors = robot.controller.motors
    counts: dict[int, float] = {}
    for group in groups_of(motors):
        yield from operation.ask(f"##{group}")
        try:
            actual = counts_in((yield from operation.report("\x10")), group, motors)
            following = counts_in((yield from operation.report("\x06")), group, motors)
        except ReportError as error:
            raise Lost(str(error)) from None
        counts |= {motor: actual[motor] + following[motor] for motor in actual}
    commanded = from_counts(robot, in_order(counts, motors)) / robot.axis_units
    reckoned: tuple[float | None, ...]
    try:
        reckoned = yield from operation.numbers("".join(turbo_pmac(robot).feedback), robot.size)
    except Refused:
        reckoned = (None,) * robot.size
    return tuple(
        JointPlace(name, unit, round(float(one), 6), None if other is None else round(other, 6))
        for name, unit, one, other in zip(
            robot.joint_names, robot.axis_unit_names, commanded, reckoned, strict=True
        )
    )


def _motor_words(status: MotorStatus) -> str:
    """Return a motor's status in words."""
    if trouble := status.trouble:
        return trouble
    words = ["closed-loop", "homed" if status.has("home complete") else "not homed"]
    words.append("at rest" if status.at_rest else "moves")
    if status.has("warning following error"):
        words.append("its following error is beyond Ixx12")
    return ", ".join(words)
