"""Position of the robot at rest, for data that is stored, such as taught positions. The motors must be
referenced and must hold the position under closed-loop control.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from yarclang.coordinator.messages import orders
from yarclang.pendant.watched import Watched
from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble


async def stands(watched: Watched, motors: Collection[int] | None = None) -> Array:
    """Check that the robot is at rest, and return its joint positions (n,) [rad or m].

    Args:
        watched: shared client of the coordinator, which knows the robot's state.
        motors: numbers of the motors that must be referenced; None for all motors.

    Raises:
        Trouble: the robot moves, isn't referenced, isn't enabled, or isn't connected.
    """
    attached = watched.attached
    _check_rest(watched)
    health = await attached.ask(orders.AskHealth())
    needed = [one for one in health.motors if motors is None or one.number in motors]
    if lost := [one.number for one in needed if not one.homed]:
        raise Trouble(
            f"{_motors(lost)} not homed: the robot's position is unknown",
            "home the robot first", "homed",
        )  # fmt: skip
    if loose := [one.number for one in needed if not one.closed_loop]:
        raise Trouble(
            f"{_motors(loose)} not enabled: the arm may have moved from its commanded position",
            "enable the motors first", "enabled",
        )  # fmt: skip
    found = np.array((await attached.ask(orders.AskPlace())).exact)
    _check_rest(watched)
    return found


def _motors(numbers: list[int]) -> str:
    return (
        f"motor{'s' * (len(numbers) > 1)} {', '.join(map(str, numbers))} "
        f"{'are' if len(numbers) > 1 else 'is'}"
    )


def _check_rest(watched: Watched) -> None:
    if watched.showing.under_way:
        what = f"the robot is moving: {watched.showing.under_way}"
        raise Trouble(what, "wait until it is at rest", "moving")
