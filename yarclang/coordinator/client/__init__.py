"""What one client of a coordinator may do, in parts by what they are for. Each part may be used alone.

What moves the robot, or changes the session, is for its owner: else `NotOwner`. What a user does wrong in a text is a finding; what can't be done now is a
`Trouble`, which says what, why and what to do.
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
        coordinator: of the robot.
        name: what others know the client by.

    Attributes:
        name: likewise.
        robot: that the coordinator owns.
        session: who may move the robot, what holds, what is told.
        motion: offers, programs, stops, the pace, where the robot stands.
        live: motions that nobody knows to their end.
        signals: inputs and outputs.
        parts: where the parts of the cell are.
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
