"""The state link's messages, from what the coordinator tells of the controller. No I/O, no clock."""

from __future__ import annotations

import numpy as np

from yarclang.coordinator.describing import joints_of
from yarclang.coordinator.messages import events, replies
from yarclang.robot.model import Array, Robot
from yarclang.ros.refusal import Refusal
from yarclang.ros.simple_message import SLOTS, Comm, JointPosition, Message, RobotStatus
from yarclang.runtime.state import State

STANDS = 0.002
"""A joint that is slower than this share of its velocity limit stands: a position that flickers between two counts isn't a motion."""

_UNKNOWN, _NO, _YES = -1, 0, 1
_MANUAL, _AUTOMATIC = 1, 2


class Feedback:
    """One robot as its clients on the state link see it.

    Args:
        robot: whose.
        name: of the client that carries goals out.
        status: as it was told at first.
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
        self._count = 0

    @property
    def state(self) -> State:
        """What the robot does, as it was told last."""
        return self._state

    @property
    def positions(self) -> int:
        """How many positions were heard: a link whose number stays has nothing new to tell."""
        return self._count

    def hear(self, event: events.BaseEvent) -> None:
        """Take what the coordinator tells."""
        match event:
            case events.StateChanged():
                self._state, self._code, self._why = event.state, event.code or "", event.why
            case events.OwnerChanged():
                self._owner = event.owner or ""
            case events.Position():
                self._place(joints_of(self._robot, event.joints), event.time_s)

    def health(self, health: replies.Health) -> None:
        """Take how the motors are."""
        self._health = health

    def trouble(self) -> Refusal | None:
        """Return what keeps the robot from moving, whatever a goal has to do with it; None: nothing does."""
        if self._state is State.FAULT:
            return Refusal(self._code or "Y1612", self._why)
        if self._state is State.DISCONNECTED:
            return Refusal(self._code or "Y1606", self._why)
        return None

    def position(self) -> Message | None:
        """Return where the joints are, in the order of robot.toml; None if nobody knows."""
        if self._joints is None or self._state is State.DISCONNECTED:
            return None
        slots = (*self._joints.tolist(), *(0.0,) * (SLOTS - self._robot.size))
        return Message(Comm.TOPIC, JointPosition(slots))

    def status(self, refusal: Refusal | None) -> Message:
        """Return how the robot is.

        Args:
            refusal: why the last goal has failed; None: it hasn't.
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
        """Take the joints (n,) [rad or m] at a time of the session [s]; whether they move follows from the place before."""
        before, passed = self._joints, time - self._heard
        if before is not None and passed > 0.0:
            speed = np.abs(joints - before) / passed
            self._moves = bool((speed > STANDS * self._robot.limits.velocity).any())
        self._joints, self._heard = joints, time
        self._count += 1

    def _powered(self) -> int:
        health = self._health
        if health is None or not health.motors or self._state is State.DISCONNECTED:
            return _UNKNOWN
        return _YES if all(one.closed_loop for one in health.motors) else _NO

    def _in_motion(self) -> int:
        """While the controller carries a program out the robot is in motion; else the joints tell, as while it comes to rest at a hold."""
        if self._state is State.MOVE:
            return _YES
        if self._state is State.DISCONNECTED or self._joints is None:
            return _UNKNOWN
        return _YES if self._moves else _NO

    def _possible(self) -> int:
        if self._state in (State.FAULT, State.DISCONNECTED) or self._owner not in ("", self._name):
            return _NO
        return _NO if self._powered() == _NO else _YES
