"""The base class of all parts of a client."""

from __future__ import annotations

from yarclang.coordinator.shared import SharedRobot


class Part:
    """A part of a client.

    Args:
        coordinator: the robot's coordinator.
        name: name of the client.
    """

    def __init__(self, coordinator: SharedRobot, name: str) -> None:
        self._coordinator = coordinator
        self._name = name
