"""Messages about the state of a robot's motors, connection and buffer, and about the robot's frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from yarclang.coordinator.describing import joints_by_name
from yarclang.coordinator.messages import replies
from yarclang.robot.actuation import from_counts
from yarclang.runtime.state import State

if TYPE_CHECKING:
    from yarclang.coordinator.coordinator import Coordinator


def health_of(coordinator: Coordinator) -> replies.Health:
    """Return the last reported state of motors, connection and buffer, without asking the controller."""
    robot, operation = coordinator.robot, coordinator.engine.operation
    sample = coordinator.sample
    errors: list[float | None] = [None] * robot.size
    following = None
    if sample is not None:
        errors = sample.following.tolist()
        following = joints_by_name(
            robot, from_counts(robot, sample.commanded) - from_counts(robot, sample.actual)
        )
    return replies.Health(
        motors=tuple(
            replies.MotorHealth(
                number=number,
                closed_loop=motor.closed_loop,
                homed=motor.homed,
                trouble=motor.trouble,
                flags=motor.flags,
                following=error,
            )
            for number, motor, error in zip(
                robot.controller.motors[: len(operation.motors)], operation.motors, errors, strict=False
            )
        ),
        following=following,
        reply_s=round(operation.latest, 6),
        slowest_s=round(operation.slowest, 6),
        silence_s=round(operation.silence, 3),
        ahead=operation.ahead,
        guard=_is_guarded(coordinator),
        link=coordinator.engine.lost,
    )


def _is_guarded(coordinator: Coordinator) -> bool:
    """Return True if the guard PLC was tested and works. The guard PLC is the controller's own program that
    holds the robot if this computer falls silent. It is tested only if everything else is in order.
    """
    inspection = coordinator.inspection
    if inspection is None or inspection.errors or coordinator.engine.lost:
        return False
    return coordinator.state is not State.DISCONNECTED


def frames_of(coordinator: Coordinator) -> replies.Frames:
    """Return the named frames of the session and their poses as a message."""
    return replies.Frames(
        frames=tuple(
            replies.NamedFrame(
                name=f"{{{name}}}",
                on_flange=frame.on_flange,
                pose=tuple(map(tuple, np.asarray(frame.transform).tolist())),
            )
            for name, frame in coordinator.names.frames().items()
        )
    )
