"""The controller's own home search (HM) of one motor, supervised by this computer and by a PLC in the
controller. No I/O.

A search isn't proved. It continues in the controller even if this computer fails, and no hold stops it. A PLC
therefore stops the search if it has received nothing from this computer for the watchdog time of a run. The
PLC is tested before each search.
"""

from __future__ import annotations

import math

import numpy as np

from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import HOMING, HOMING_PLC, motor_variable, watchdog
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Script, Trouble, Wait
from yarclang.runtime.notices import Abort
from yarclang.runtime.pmac.operation import Operation, Refused
from yarclang.runtime.pmac.rest import come_to_rest, motor_statuses
from yarclang.runtime.pmac.servicing import check_rest, is_ended
from yarclang.runtime.pmac.supervision import wound_up
from yarclang.runtime.pmac.watching import sample
from yarclang.runtime.scripts import HomeSearch
from yarclang.runtime.state import Event

LONGEST = 300.0
"""Longest duration of a home search [s]."""

_UNBOUNDED = 120.0
"""Longest duration of a home search of a joint without limits [s]."""

_RESERVE, _MORE = 1.5, 5.0
_TRIAL, _BITES = 0.06, 0.5
_EACH = 0.02
_BEGINS = 0.1
"""Time after the start of a search from which a motor at rest counts as having ended its search [s]. Earlier,
the motor may be at rest because its search hasn't begun.
"""

_RESTS = 5.0


def searches(operation: Operation, robot: Robot) -> Script[tuple[HomeSearch, ...]]:
    """Ask for the speeds of home searches, and return the expected effect of each motor's search. Nothing
    moves.
    """
    motors = robot.controller.motors
    rates = yield from operation.numbers("".join(motor_variable(one, 23) for one in motors), len(motors))
    words = yield from motor_statuses(operation, robot)
    return tuple(
        _search(robot, row, rate, closed=not words[row].has("open loop")) for row, rate in enumerate(rates)
    )


def _search(robot: Robot, row: int, rate: float, *, closed: bool) -> HomeSearch:
    """Return the expected effect of a motor's home search: its speed, direction and longest duration.

    Args:
        robot: the robot.
        row: row of the motor in the robot's order.
        rate: Ixx23, the speed of the search [counts/ms].
        closed: True if the motor's loop is closed.
    """
    motor, actuation = robot.controller.motors[row], robot.actuation
    coupling = actuation.coupling
    moved = np.abs(np.linalg.inv(coupling)[:, row]) > 1e-9
    follows = np.abs(coupling[row]) > 1e-9
    column = row if follows[row] else int(np.argmax(follows))
    speed = rate * 1e3 / float(actuation.gear[row] * coupling[row, column])
    unit = float(robot.axis_units[column])
    way = float(robot.limits.upper[column] - robot.limits.lower[column]) / unit
    bound = _RESERVE * way / abs(speed) + _MORE if speed and math.isfinite(way) else _UNBOUNDED
    fastest = float(robot.limits.velocity[column]) / unit
    name = motor_variable(motor, 23)
    refused = ""
    if moved.sum() > 1 or follows.sum() > 1:
        among = moved | follows
        names = ", ".join(joint for joint, one in zip(robot.joint_names, among, strict=True) if one)
        refused = (
            f"motor {motor} is coupled: {names} are driven together, so a home search of one motor "
            "doesn't move a single joint. Home it with the tools of the machine's manufacturer"
        )
    elif not speed:
        refused = f"{name}, the speed of the home search, is 0: the motor wouldn't move"
    elif abs(speed) > fastest:
        refused = (
            f"{name} asks for {abs(speed):.3g} {robot.axis_unit_names[column]}/s, more than the joint's "
            f"limit of {fastest:.3g}: "
            "set a slower one"
        )
    return HomeSearch(
        motor,
        robot.joint_names[column],
        robot.axis_unit_names[column],
        speed,
        min(bound, LONGEST),
        refused,
        closed,
    )


def home(operation: Operation, robot: Robot, motor: int) -> Script[None]:
    """Let a motor search its home, until the home is found or a person orders the end of the search.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot.
        motor: number of the motor.

    Raises:
        Trouble: the search was not started, or has ended without finding the home. The motor is at rest.
        Lost: the connection is no longer usable; the controller's PLC ends the search.
    """
    yield from check_rest(operation, robot)
    homes = {one.motor: one for one in (yield from searches(operation, robot))}
    if motor not in homes:
        raise Trouble(f"the robot has no motor {motor}", "name one of its motors", "Y1601")
    search = homes[motor]
    if search.refused:
        raise Trouble(search.refused, "", "Y1612")
    # Refuse if a loop is open: an abort, the last resort during a search, would close the loops of all
    # motors.
    if opened := [str(number) for number, one in homes.items() if not one.closed]:
        raise Trouble(f"motor {', '.join(opened)} is open-loop", "enable all motors first", "Y1612")
    yield from _check_free(operation)
    operation.go(Event.FAULT, f"motor {motor} isn't homed")
    trouble: Trouble | None = None
    try:
        yield from _load(operation, robot, motor)
        yield from _searched(operation, robot, search)
    except Trouble as caught:
        trouble = caught
        if operation.searches:
            yield from _stop(operation, robot, motor)
    yield from _unload(operation)
    if trouble is not None:
        raise trouble


def _guard(robot: Robot, motor: int) -> tuple[str, ...]:
    """Return the statements of the PLC that stops a search if this computer falls silent."""
    timer = watchdog(turbo_pmac(robot).coordinate_system)
    return (f"IF({HOMING}=1)", f"IF({timer}<0)", f"{HOMING}=2", f'CMD"#{motor}J/"', "ENDIF", "ENDIF")


def _check_free(operation: Operation) -> Script[None]:
    """Check that the PLC number for stopping home searches isn't used by another program. The PLC that an
    earlier, failed session has left under this number is allowed.
    """
    try:
        listing = yield from operation.ask(f"LIST PLC {HOMING_PLC}")
    except Refused:
        listing = ()
    text = "".join(listing).upper().removesuffix("RETURN").removesuffix("RET").strip()
    if text and HOMING not in text:
        what = f"PLC {HOMING_PLC}, needed to stop the search if this computer fails, has a foreign program"
        raise Trouble(what, "move that program to another PLC: it would be overwritten", "Y1612")


def _load(operation: Operation, robot: Robot, motor: int) -> Script[None]:
    """Load the PLC that stops a home search, and test that it acts when its timer has run down. During the
    test the motor is at rest, so nothing is stopped.
    """
    for line in (
        f"{HOMING}=0",
        f"OPEN PLC {HOMING_PLC} CLEAR",
        *_guard(robot, motor),
        "CLOSE",
        f"ENABLE PLC {HOMING_PLC}",
    ):
        yield from operation.ask(line)
    yield from operation.ask(f"{wound_up(turbo_pmac(robot), _TRIAL)} {HOMING}=1")
    # The PLC must set the flag to 2, but not before the timer can have run down.
    since, flag = operation.now, 1.0
    while flag == 1.0 and operation.now - since < _BITES:
        yield Wait(operation.now + _EACH)
        (flag,) = yield from operation.numbers(HOMING, 1)
    if flag != 2.0 or operation.now - since < 0.9 * _TRIAL:
        raise Trouble(
            "the controller wouldn't stop the search if this computer failed: its PLCs don't run properly",
            "set I5=3 as in `yarc settings`, and check the controller's load",
            "Y1612",
        )
    yield from operation.ask(f"{HOMING}=0")


def _unload(operation: Operation) -> Script[None]:
    for line in (
        f"{HOMING}=0",
        "CLOSE",
        f"DISABLE PLC {HOMING_PLC}",
        f"OPEN PLC {HOMING_PLC} CLEAR",
        "CLOSE",
    ):
        yield from operation.ask(line)


def _searched(operation: Operation, robot: Robot, search: HomeSearch) -> Script[None]:
    motor, row = search.motor, robot.controller.motors.index(search.motor)
    wound = wound_up(turbo_pmac(robot), operation.silence)
    if is_ended(operation):
        raise Trouble("the button was released before the start; nothing moved", "", "")
    # From here on, the PLC watches this computer: HM must follow within the time of the timer.
    yield from operation.ask(f"{wound} {HOMING}=1")
    if is_ended(operation):
        raise Trouble("the button was released before the start; nothing moved", "", "")
    since = positions_due = operation.now
    operation.searches = True
    yield from operation.ask(f"#{motor}HM")
    while True:
        if is_ended(operation):
            raise Trouble(
                f"motor {motor} was stopped during its home search: it isn't homed", "home it again", ""
            )
        (flag,) = yield from operation.numbers(f"{wound} {HOMING}", 1)
        if flag != 1.0:
            problem = (
                f"the controller has stopped motor {motor} during its home search: it had received "
                "nothing for "
                f"{operation.silence:.2g} s"
            )
            raise Trouble(
                problem, "find out what slows the link or this computer, then home it again", "Y1606"
            )
        status = (yield from motor_statuses(operation, robot))[row]
        if told := status.trouble:
            raise Trouble(f"motor {motor}, home search: {told}", "find out why, then home it again", "Y1602")
        spent = operation.now - since
        if spent > _BEGINS and status.at_rest:
            break
        if spent > search.longest:
            problem = f"motor {motor} hasn't found its home within {search.longest:.0f} s"
            raise Trouble(problem, "check its home flag, Ixx23 and Ixx26", "Y1602")
        if operation.now >= positions_due:
            positions_due = operation.now + operation.positions_each
            operation.notices.append((yield from sample(operation, robot, 0.0)))
        yield Wait(operation.now + _EACH)
    operation.searches = False
    if not status.has("home complete"):
        problem = f"motor {motor} has ended its home search without finding its home"
        raise Trouble(
            problem, "check its home flag, and whether another client uses this controller", "Y1602"
        )


def _stop(operation: Operation, robot: Robot, motor: int) -> Script[None]:
    """Stop the home search, and wait for rest. If a fault has opened the motor's loop, do nothing: J/ or an
    abort would close the loop again.
    """
    status = (yield from motor_statuses(operation, robot))[robot.controller.motors.index(motor)]
    if status.has("open loop"):
        operation.searches = False
        return
    try:
        if Abort() in operation.orders:
            yield from operation.abort()
        else:
            yield from operation.ask(f"#{motor}J/")
        yield from come_to_rest(operation, robot, _RESTS)
    except Trouble:
        yield from operation.abort()
        yield from come_to_rest(operation, robot, _RESTS)
    operation.searches = False


def end_search(operation: Operation) -> Script[None]:
    """End a home search after reconnecting. The PLC has already ended the search, unless the connection was
    back at once.
    """
    yield from operation.abort()
    operation.searches = False
