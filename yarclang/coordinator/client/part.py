"""Base class of the groups of a client's actions."""

from __future__ import annotations

from yarclang.coordinator.shared import SharedRobot


class Part:
    """Base class of a group of a client's actions.

    Args:
        coordinator: the robot's coordinator.
        name: name of the client.
    """

    def __init__(self, coordinator: SharedRobot, name: str) -> None:
        self._coordinator = coordinator
        self._name = name
