"""The actions of a coordinator's client, grouped by purpose. Each group can be used alone.

Only the robot's owner may move the robot or change the session; other clients get `NotOwner`. A mistake in
the text of a user is returned as a finding. If an action isn't possible now, `Trouble` is raised with the
reason and a remedy.
"""

from __future__ import annotations

from yarclang.coordinator.client.files import Files
from yarclang.coordinator.client.live import LiveMotion
from yarclang.coordinator.client.motion import Motion
from yarclang.coordinator.client.parts import Parts
from yarclang.coordinator.client.session import Session
from yarclang.coordinator.client.signals import Signals
from yarclang.coordinator.shared import SharedRobot
from yarclang.robot.model import Robot


class Client:
    """A client of the coordinator. Its actions are grouped in the attributes from `session` to `files`.

    Args:
        coordinator: the robot's coordinator.
        name: name of the client that others see.

    Attributes:
        name: name of the client that others see.
        robot: robot of the coordinator.
        session: ownership, declarations, events.
        motion: offers, programs, stops, the override, the robot's position.
        live: motions whose end isn't known in advance.
        signals: inputs and outputs.
        parts: places of the cell's parts.
        files: programs in files.
    """

    def __init__(self, coordinator: SharedRobot, name: str) -> None:
        self.name = name
        self.robot: Robot = coordinator.robot
        self.session = Session(coordinator, name)
        self.motion = Motion(coordinator, name)
        self.live = LiveMotion(coordinator, name)
        self.signals = Signals(coordinator, name)
        self.parts = Parts(coordinator, name)
        self.files = Files(coordinator, name)
