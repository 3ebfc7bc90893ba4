"""What all parts of a client share."""

from __future__ import annotations

from yarclang.coordinator.shared import SharedRobot


class Part:
    """A part of a client.

    Args:
        coordinator: of the robot.
        name: of the client.
    """

    def __init__(self, coordinator: SharedRobot, name: str) -> None:
        self._coordinator = coordinator
        self._name = name
