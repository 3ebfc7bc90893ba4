"""The judge's reader of texts for a Turbo PMAC, with the checks of a text that need no program."""

from __future__ import annotations

from collections.abc import Iterator, Set

import numpy as np

from yarclang.certify.kinematics.motors import from_counts, joints_per_count
from yarclang.certify.pmac.assignments import check_assignments
from yarclang.certify.pmac.guard import check_guard
from yarclang.certify.pmac.own import TM_STEPS_PER_MS, Guard, own_of
from yarclang.certify.pmac.read import read
from yarclang.certify.read.reader import Fault, Reader, StartPlace
from yarclang.certify.read.text import ControllerText, Unreadable
from yarclang.memory import Memory
from yarclang.pmac.controller import TurboPmac, turbo_pmac
from yarclang.robot.controller import Controller
from yarclang.robot.model import Array, Robot
from yarclang.units import MS

GUARD_SHARE = 0.05
"""Largest acceleration that an inexact start of a stored program may add, as a fraction of the acceleration
limit.
"""

MOST_PUTS = 64
"""Largest number of outputs that are set with one move. The manuals don't state how many the controller
stores until the move begins.
"""


def _read(text: str, controller: Controller, memory: Memory) -> ControllerText | Unreadable:
    assert isinstance(controller, TurboPmac)
    return read(text, controller, memory)


def _start(content: ControllerText, robot: Robot) -> StartPlace:
    if (printed := content.start.printed) is not None:
        exact: Array = 0.5 * 10.0**-content.decimals * robot.axis_units
        return StartPlace(printed * robot.axis_units, exact, is_printed=True)
    guard = _guard_of(content)
    # Position registers are in 1/(32 Ixx08) count. The printed values are off by at most half a step of
    # the last digit.
    q = from_counts(robot, guard.place / (32.0 * turbo_pmac(robot).ixx08))
    return StartPlace(q, 0.5 * _per_step(robot) @ guard.step, is_printed=False)


def _guard_of(content: ControllerText) -> Guard:
    guard = own_of(content).guard
    assert guard is not None  # a text has either a printed start or a guard
    return guard


def _per_step(robot: Robot) -> Array:
    """Return the absolute value of each joint's motion (row) per step of each motor's position register
    (column), (n, n).

    The values are in rad or m. A step of the register is 1/(32 Ixx08) count, with the motor's I-variable
    Ixx08.
    """
    steps: Array = np.abs(joints_per_count(robot)) / (32.0 * turbo_pmac(robot).ixx08)
    return steps


def _faults(content: ControllerText, robot: Robot, outputs: Set[str] | None) -> Iterator[Fault]:
    yield from _start_faults(content, robot)
    yield from (Fault("Y1191", reason) for reason in check_assignments(content, robot, outputs))
    yield from (Fault("Y1190", reason) for reason in check_guard(content, robot))
    yield from _puts_faults(content)
    smallest, largest = robot.controller.smallest_segment, robot.controller.largest_segment
    for run in content.runs:
        if run.segment_ms * MS < smallest * (1.0 - 1e-9):
            yield Fault(
                "Y1152",
                f"TM{run.segment_ms:.12g} in line {run.tm_line} is below {smallest / MS:.4f} ms, three "
                "real-time interrupts of the controller",
            )
        if run.segment_ms > largest / MS + 1.0 / TM_STEPS_PER_MS:
            yield Fault(
                "Y1152",
                f"TM{run.segment_ms:.12g} in line {run.tm_line} is above {largest / MS:.6g} ms, the robot's "
                "longest segment time (controller.largest_tm)",
            )


def _puts_faults(content: ControllerText) -> Iterator[Fault]:
    """Check that no move has more outputs than the controller may store until the move begins."""
    for run in content.runs:
        if not run.puts:
            continue
        moves, counts = np.unique(
            np.searchsorted(run.lines, [put.line for put in run.puts]), return_counts=True
        )
        for move in moves[counts > MOST_PUTS]:
            yield Fault(
                "Y1165", f"more than {MOST_PUTS} outputs are set with the move in line {run.lines[move]}"
            )


def _start_faults(content: ControllerText, robot: Robot) -> Iterator[Fault]:
    """Check that the guard of a program buffer lets the program begin only very near its start.

    A start that is off by x adds an acceleration of x / TM^2.
    """
    if not content.runs or content.start.printed is not None:
        return
    width = _guard_of(content).width
    share = _per_step(robot) @ width / (content.runs[0].segment_ms * MS) ** 2 / robot.limits.acceleration
    joint = int(np.argmax(share))
    if share[joint] > GUARD_SHARE * (1.0 + 1e-9):
        yield Fault(
            "Y1154",
            f"the program's guard lets {robot.joint_names[joint]} start so far away that this adds "
            f"{share[joint]:.1%} of its acceleration limit; {GUARD_SHARE:.0%} are allowed (line "
            f"{content.start.line})",
            at_start=True,
        )


READER = Reader(_read, _start, _faults)
