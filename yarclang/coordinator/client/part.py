"""What all parts of a client share."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from yarclang.coordinator.coordinator import Coordinator


class Part:
    """A part of a client.

    Args:
        coordinator: of the robot.
        name: of the client.
    """

    def __init__(self, coordinator: Coordinator, name: str) -> None:
        self._coordinator = coordinator
        self._name = name
