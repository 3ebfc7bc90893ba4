"""The actions of a coordinator's client, grouped by purpose. Each part may be used alone.

Anything that moves the robot or changes the session is for the robot's owner; others get `NotOwner`. A
mistake in a user's text is a finding. Something that can't be done now is a `Trouble` with the fact, its
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
    """One client.

    Args:
        coordinator: the robot's coordinator.
        name: name of the client for others.

    Attributes:
        name: name of the client for others.
        robot: robot of the coordinator.
        session: ownership, declarations, events.
        motion: offers, programs, stops, the override, the robot's position.
        live: motions whose end is not known in advance.
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
