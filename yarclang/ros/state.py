"""Messages of the state link (the connection on which ROS clients receive the robot's state), made from the
coordinator's reports. No I/O, no clock.
"""

from __future__ import annotations

import numpy as np

from yarclang.coordinator.describing import joints_of
from yarclang.coordinator.messages import events, replies
from yarclang.robot.model import Array, Robot
from yarclang.ros.refusal import Refusal
from yarclang.ros.simple_message import SLOTS, Comm, JointPosition, Message, RobotStatus
from yarclang.runtime.state import State

STANDS = 0.002
"""Share of a joint's velocity limit below which the joint counts as resting. A position that alternates
between two counts isn't a motion.
"""

_UNKNOWN, _NO, _YES = -1, 0, 1
_MANUAL, _AUTOMATIC = 1, 2


class Feedback:
    """State of a robot for the clients on the state link.

    Args:
        robot: the robot.
        name: name of the coordinator's client that runs the goals.
        status: status that the coordinator has reported first.
    """

    def __init__(self, robot: Robot, name: str, status: replies.Status) -> None:
        self._robot = robot
        self._name = name
        self._state = status.state
        self._owner = status.owner or ""
        self._code, self._why = "", status.why
        self._health: replies.Health | None = None
        self._joints: Array | None = None
        self._heard = 0.0
        self._moves = False

    @property
    def state(self) -> State:
        """Last known state of the robot."""
        return self._state

    def hear(self, event: events.BaseEvent) -> None:
        """Update the state from an event of the coordinator."""
        match event:
            case events.StateChanged():
                self._state, self._code, self._why = event.state, event.code or "", event.why
            case events.OwnerChanged():
                self._owner = event.owner or ""
            case events.Position():
                self._place(joints_of(self._robot, event.joints), event.time_s)

    def health(self, health: replies.Health) -> None:
        """Update the state from a report on the motors."""
        self._health = health

    def trouble(self) -> Refusal | None:
        """Return the reason why the robot can't move, regardless of goals; None if it can."""
        if self._state is State.FAULT:
            return Refusal(self._code or "Y1612", self._why)
        if self._state is State.DISCONNECTED:
            return Refusal(self._code or "Y1606", self._why)
        return None

    def position(self) -> Message | None:
        """Return the joints' positions in the order of robot.toml; None if they are unknown."""
        if self._joints is None or self._state is State.DISCONNECTED:
            return None
        slots = (*self._joints.tolist(), *(0.0,) * (SLOTS - self._robot.size))
        return Message(Comm.TOPIC, JointPosition(slots))

    def status(self, refusal: Refusal | None) -> Message:
        """Return the status of the robot.

        Args:
            refusal: reason why the last goal has failed; None if it hasn't.
        """
        wrong = self.trouble() or refusal
        body = RobotStatus(
            drives_powered=self._powered(),
            e_stopped=_UNKNOWN,
            error_code=_NO if wrong is None else wrong.number,
            in_error=_NO if wrong is None else _YES,
            in_motion=self._in_motion(),
            mode=_AUTOMATIC if self._owner in ("", self._name) else _MANUAL,
            motion_possible=self._possible(),
        )
        return Message(Comm.TOPIC, body)

    def _place(self, joints: Array, time: float) -> None:
        """Store the joint positions (n,) [rad or m] at a time of the session [s], and decide if a joint
        moves, from its change since the previous positions.
        """
        before, passed = self._joints, time - self._heard
        if before is not None and passed > 0.0:
            speed = np.abs(joints - before) / passed
            self._moves = bool((speed > STANDS * self._robot.limits.velocity).any())
        self._joints, self._heard = joints, time

    def _powered(self) -> int:
        health = self._health
        if health is None or not health.motors or self._state is State.DISCONNECTED:
            return _UNKNOWN
        return _YES if all(one.closed_loop for one in health.motors) else _NO

    def _in_motion(self) -> int:
        """Return 1 while the controller runs a program or a joint moves, 0 if not, -1 if it isn't known. A
        joint also moves while the robot comes to rest in a hold.
        """
        if self._state is State.MOVE:
            return _YES
        if self._state is State.DISCONNECTED or self._joints is None:
            return _UNKNOWN
        return _YES if self._moves else _NO

    def _possible(self) -> int:
        if self._state in (State.FAULT, State.DISCONNECTED) or self._owner not in ("", self._name):
            return _NO
        return _NO if self._powered() == _NO else _YES
