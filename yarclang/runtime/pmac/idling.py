"""Watching a robot at rest with nothing loaded, until something is ordered. No I/O."""

from __future__ import annotations

from collections.abc import Callable

from yarclang.robot.model import Robot
from yarclang.runtime.actions import Script, Trouble, Wait
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.rest import motor_statuses
from yarclang.runtime.pmac.watching import look_at_motors, sample
from yarclang.runtime.state import Event, State

STATUS_EACH = 0.1
"""Time between two reads of the status words [s]."""


def idle(operation: Operation, robot: Robot, is_wanted: Callable[[], bool]) -> Script[None]:
    """Report the robot's position until `is_wanted` returns True.

    A motor that can't move is a fault. It is reported once; afterwards the motors are only watched. Orders
    have no effect here, and are discarded, but each new order ends the present wait.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot.
        is_wanted: function that returns True if the session has something else to do.

    Raises:
        Lost: the connection is no longer usable.
    """
    status = positions = operation.now
    while not is_wanted():
        operation.orders.clear()
        now = operation.now
        if now >= status:
            status = now + STATUS_EACH
            if operation.state is State.FAULT:
                yield from motor_statuses(operation, robot)
                continue
            try:
                yield from look_at_motors(operation, robot)
            except Trouble as trouble:
                operation.go(Event.FAULT, trouble.what, trouble.code, trouble.remedy)
                if trouble.remedy:
                    operation.remark(trouble.remedy, warning=True)
        elif now >= positions:
            positions = max(positions + operation.positions_each, now)
            operation.notices.append((yield from sample(operation, robot, 0.0)))
        else:
            yield Wait(min(status, positions))
