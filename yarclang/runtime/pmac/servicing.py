"""Service of a robot at rest, without a job: closing and opening loops, sending and saving settings. No I/O.

After each of these actions, a complete inspection decides if a motion is possible; until then the run is in
state Fault.
"""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import motor_variable
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Lost, Script, Trouble, Wait
from yarclang.runtime.notices import Abort, Fail, Hold, Stop
from yarclang.runtime.pmac.messages import Answer, Ask, Busy
from yarclang.runtime.pmac.operation import PATIENCE, Operation, Refused
from yarclang.runtime.pmac.rest import motor_statuses, system_words
from yarclang.runtime.pmac.watching import sample
from yarclang.runtime.scripts import Sent
from yarclang.runtime.state import Event

_WITHIN = 1.0
"""Longest time for closing or opening a loop [s]."""

_SETTLES = 0.1
"""Time that a motor has to come to rest after its loop was closed [s]."""

_POLL = 0.02

STAYS = 0.2
"""Largest motion and largest following error that a motor may have after its loop was closed, as motion of a
joint [deg or mm].
"""

_SAVES = 30.0
"""Longest time that a controller may be busy with SAVE [s]."""

_ENDS = (Hold, Stop, Abort, Fail)


def is_ended(operation: Operation) -> bool:
    """Return True if someone has ordered the end of the current action."""
    return any(isinstance(order, _ENDS) for order in operation.orders)


def check_rest(operation: Operation, robot: Robot) -> Script[None]:
    """Check that nothing moves, and that no program was left unfinished.

    Raises:
        Trouble: something moves, or there is an unfinished program.
    """
    motors = yield from motor_statuses(operation, robot)
    for number, motor in zip(robot.controller.motors, motors, strict=True):
        if not motor.at_rest:
            raise Trouble(f"motor {number} moves", "wait until it rests, or stop it", "Y1612")
    words = yield from system_words(operation, robot)
    if words.running:
        what = "a program is unfinished on the controller: held, or waiting for lines"
        raise Trouble(what, "end it at the robot's position with `yarc stop --to ...`", "Y1612")


def enable(operation: Operation, robot: Robot) -> Script[str]:
    """Close the open loops of the motors, one after the other, and check that each motor stays where it is.

    Returns:
        The problem in words; empty if all loops are closed. After the first motor with a problem, no further
        loop is closed.

    Raises:
        Trouble: the robot isn't at rest.
    """
    yield from check_rest(operation, robot)
    for row, motor in enumerate(robot.controller.motors):
        if is_ended(operation):
            return f"stopped before motor {motor}: its loop remains open"
        if told := (yield from _close(operation, robot, row)):
            return f"motor {motor}: {told}"
    return ""


def _close(operation: Operation, robot: Robot, row: int) -> Script[str]:
    number = robot.controller.motors[row]
    status = (yield from motor_statuses(operation, robot))[row]
    if not status.has("open loop") and not status.faulted:
        return ""
    if status.has("amplifier fault"):
        return "its amplifier reports a fault: check the drive, then try again"
    if not status.has("activated"):
        return f"it isn't activated: {motor_variable(number, 0)} is 0"
    before = (yield from _places(operation, robot))[row]
    try:
        yield from operation.ask(f"#{number}J/")
    except Refused as refused:
        return str(refused)
    closed = yield from _become(operation, robot, row, is_open=False)
    if not closed:
        return (
            f"its loop isn't closed {_WITHIN:g} s after the request: check the drive and its enabling circuit"
        )
    yield Wait(operation.now + _SETTLES)
    heard = yield from sample(operation, robot, 0.0)
    allowed = STAYS * abs(float(robot.actuation.gear[row]))
    moved, lag = abs(heard.actual[row] - before), abs(heard.following[row])
    if max(moved, lag) > allowed:
        return (
            f"it doesn't hold its position: it moved by {moved:.0f} counts with a following error of "
            f"{lag:.0f}, and {allowed:.0f} are allowed; disable the motors, and check its brake, tuning "
            "and encoder"
        )
    return ""


def _places(operation: Operation, robot: Robot) -> Script[Array]:
    return (yield from sample(operation, robot, 0.0)).actual


def _become(operation: Operation, robot: Robot, row: int, *, is_open: bool) -> Script[bool]:
    until = operation.now + _WITHIN
    while True:
        motors = yield from motor_statuses(operation, robot)
        if motors[row].has("open loop") is is_open:
            return True
        if operation.now > until:
            return False
        yield Wait(operation.now + _POLL)


def disable(operation: Operation, robot: Robot) -> Script[str]:
    """Open the loops of all motors, at rest. Afterwards only brakes hold the robot, if it has any.

    Returns:
        The problem in words; empty if all loops are open.

    Raises:
        Trouble: the robot isn't at rest.
    """
    yield from check_rest(operation, robot)
    operation.go(Event.FAULT, "the motors were disabled")
    for row, motor in enumerate(robot.controller.motors):
        try:
            yield from operation.ask(f"#{motor}K")
        except Refused as refused:
            return f"motor {motor}: {refused}"
        if not (yield from _become(operation, robot, row, is_open=True)):
            return f"motor {motor}: its loop isn't open {_WITHIN:g} s after the request"
    return ""


def check_open(operation: Operation, robot: Robot) -> Script[None]:
    """Check that settings may be sent: the robot must be at rest with all loops open.

    If a loop were closed, a change of a scale, a limit or a PLC would move the motor.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot whose settings are sent.

    Raises:
        Trouble: settings may not be sent.
    """
    yield from check_rest(operation, robot)
    motors = yield from motor_statuses(operation, robot)
    numbers, scale = robot.controller.motors, turbo_pmac(robot).ixx08
    closed = [str(n) for n, motor in zip(numbers, motors, strict=True) if not motor.has("open loop")]
    if closed:
        raise Trouble(
            f"settings are sent with all loops open: motor {', '.join(closed)} is closed-loop",
            "secure the arm against falling, then disable the motors",
            "Y1612",
        )
    scales = yield from operation.numbers(
        "".join(motor_variable(number, 8) for number in numbers), len(numbers)
    )
    for number, motor, found in zip(numbers, motors, scales, strict=True):
        if motor.has("home complete") and found != scale:
            raise Trouble(
                f"motor {number} was homed with {motor_variable(number, 8)}={found:g}, but the settings "
                f"have {scale}: its position would change although it counts as homed",
                "reset the controller ($$$), send the settings, then home the motor",
                "Y1612",
            )


def send(operation: Operation, lines: Sequence[str]) -> Script[Sent]:
    """Send settings to the controller line by line, after `check_open` has found no problem.

    Sending ends at the first line that the controller refuses, or when a person orders the end.

    Args:
        operation: state of the run, and access to the controller.
        lines: lines of the settings without comments.

    Raises:
        Lost: the connection is no longer usable.
    """
    operation.go(Event.FAULT, "settings are being sent to the controller")
    for number, line in enumerate(lines):
        problem = ""
        remedy = "the controller has only a part of the settings: find the cause, and send them again"
        if is_ended(operation):
            problem = "stopped by a person"
        else:
            try:
                items = yield from operation.ask(line)
            except Refused as refused:
                problem = str(refused)
            except Trouble as trouble:
                problem = trouble.what
            else:
                if items:
                    problem, remedy = (
                        f"the controller answers {line!r} with {', '.join(items)!r}",
                        "is it a Turbo PMAC?",
                    )
        if problem:
            with contextlib.suppress(Refused, Trouble):
                yield from operation.ask("CLOSE")  # the PLC's buffer may be open, with a part of the PLC
            operation.go(
                Event.FAULT, f"the settings were sent in part, {number} of {len(lines)} lines: {problem}"
            )
            return Sent(number, len(lines), problem, remedy)
    return Sent(len(lines), len(lines))


def save(operation: Operation, robot: Robot) -> Script[None]:
    """Store the settings in the controller, so that they remain after power-off (SAVE).

    Raises:
        Trouble: the robot isn't at rest, or the controller refuses.
        Lost: the connection is no longer usable.
    """
    yield from check_rest(operation, robot)
    event = yield Ask("SAVE")
    match event:
        case Answer(error=None):
            pass
        case Answer(error=int(number)):
            raise Refused("SAVE", number)
        case Busy():
            pass
        case _:
            raise Lost("the controller doesn't answer while it saves")
    operation.patience = _SAVES
    try:
        yield from operation.ask("CID")
    finally:
        operation.patience = PATIENCE
