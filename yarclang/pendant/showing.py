"""The robot's state for the display that stands on every page, built from the coordinator's messages.
No I/O.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.coordinator.messages import events, replies
from yarclang.coordinator.messages.message import Question
from yarclang.pendant.messages.display import NO_ALARM, AlarmBar, Display
from yarclang.pendant.scene.placements import moved_links, packed
from yarclang.robot.model import Array, Robot
from yarclang.runtime.state import State

JOG = "jog"
"""Name of the pendant's live motions."""


class Showing:
    """The last known state of one robot.

    Args:
        robot: the robot.

    Attributes:
        connected: True if the coordinator is connected.
        alarm: returns the most important alarm, for the status bar.
        scene: version of the three-dimensional scene; empty before the first scene.
        touching: names of bodies that are too near to another body.
        stopped_by: names of bodies and zones that have stopped the last live motion, such as a jog.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.connected = False
        self.alarm: Callable[[], AlarmBar] = lambda: NO_ALARM
        self.scene = ""
        self.touching: tuple[str, ...] = ()
        self.stopped_by: tuple[str, ...] = ()
        self._placed: tuple[tuple[float | None, ...], tuple[float, ...], tuple[float, ...]] | None = None
        self._joints: tuple[float | None, ...] = (None,) * robot.size
        self._status: replies.Status | None = None
        self._health: replies.Health | None = None
        self._state, self._why = State.DISCONNECTED, ""
        self._asks: Question | None = None
        self._owner: str | None = None
        self._under_way = self._command = ""
        self._line = 0
        self._file = ("", "")
        self._done = self._left = 0.0
        self._override = 100.0
        self._paused = False

    @property
    def under_way(self) -> str:
        """Name of the running program or motion; empty if none is running."""
        return self._under_way

    @property
    def joints(self) -> Array | None:
        """Actual joint positions (n,) [rad or m]; None if unknown."""
        if any(one is None for one in self._joints):
            return None
        found: Array = np.array(self._joints, dtype=float) * self.robot.axis_units
        return found

    @property
    def owner(self) -> str | None:
        """The client that may move the robot; None if nobody."""
        return self._owner

    @property
    def state(self) -> State:
        """State of the robot."""
        return self._state

    @property
    def why(self) -> str:
        """Reason for the state; empty if unknown."""
        return self._why

    @property
    def heard_health(self) -> replies.Health | None:
        """Last known health of motors, link and buffer; None before the first message."""
        return self._health

    def runs(self, file: str) -> None:
        """Remember the project file of the program that is run next."""
        self._file = (file.rpartition("/")[2], file)

    def file_of(self, program: str) -> str:
        """Return the file in the project from which a program was loaded; empty if it isn't the last
        program that was run at this pendant.
        """
        name, file = self._file
        return file if program and name == program else ""

    def welcome(self, status: replies.Status) -> None:
        """Store the status that the coordinator sends to a new client."""
        self.connected = True
        self._state, self._why, self._asks = status.state, status.why, status.asks
        self._owner = status.owner
        moves = status.state in (State.MOVE, State.INIT, State.HOLD)
        self._under_way = status.program if moves else ""
        self._command = status.command.title if status.command else ""
        self._line = status.command.line if status.command else 0
        self._done, self._left = status.done, status.left
        self._override = status.override
        self._paused = False
        self._joints = tuple(one.position for one in status.joints)

    def lost(self) -> None:
        """Store that the coordinator is disconnected, and forget the state of the motors."""
        self.connected = False
        self._health = None

    def health(self, health: replies.Health) -> None:
        """Store a message about the motors' health."""
        self._health = health

    def take(self, event: events.BaseEvent) -> None:
        """Update the state from an event of the coordinator."""
        match event:
            case events.StateChanged(state=state, why=why, asks=asks):
                self._state, self._why, self._asks = state, why, asks
            case events.Position(joints=joints):
                self._joints = tuple(joints.get(name) for name in self.robot.joint_names)
            case events.ProgressMade():
                self._done, self._left = event.done_s, event.left_s
                self._command, self._line = event.command, event.line
            case events.OwnerChanged(owner=owner):
                self._owner = owner
            case events.OverrideChanged(percent=percent):
                self._override = percent
            case events.Began(name=name, duration_s=duration):
                self._under_way, self._command, self._line = name, "", 0
                self._done, self._left = 0.0, duration
                self._paused = False
            case events.Finished():
                self._under_way, self._left = "", 0.0
                self._paused = False
            case events.Paused():
                self._paused = True
            case events.PartBegan():
                self._paused = False
            case _:
                pass

    def display(self, audit: str = "") -> Display:
        """Return the message with the present state for the display.

        Args:
            audit: reason why the audit trail can't be written; empty if it can be.
        """
        motors = () if self._health is None else self._health.motors
        flange, links = self._places()
        return Display(
            connected=self.connected,
            state=self._state,
            why=self._why,
            asks=self._asks,
            mode=self._mode,
            owner=self._owner,
            under_way=self._under_way,
            command=self._command,
            line=self._line,
            done_s=round(self._done, 2),
            left_s=round(self._left, 2),
            override=round(self._override, 2),
            paused=self._paused,
            joints=tuple(None if one is None else round(one, 4) for one in self._joints),
            flange=flange or None,
            links=links,
            scene=self.scene,
            touching=self.touching,
            stopped_by=self.stopped_by,
            enabled=all(one.closed_loop for one in motors) if motors else None,
            homed=all(one.homed for one in motors) if motors else None,
            guard=None if self._health is None else self._health.guard,
            alarm=self.alarm(),
            audit=audit,
        )

    @property
    def _mode(self) -> str:
        if not self.connected or self._state is State.DISCONNECTED:
            return "disconnected"
        if self._state is State.FAULT:
            return "fault"
        if self._state is State.HOLD:
            return "held"
        if not self._under_way:
            return "idle"
        return "jog" if self._under_way == JOG else "program"

    def _places(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the pose of the flange in {B}, as the 16 entries of its matrix, row by row, and the
        displacements of the n links as 7 n numbers. Both are for the robot's present position, and cached
        until it changes.
        """
        if self._placed is not None and self._placed[0] == self._joints:
            return self._placed[1:]
        flange: tuple[float, ...] = ()
        links: tuple[float, ...] = ()
        if (q := self.joints) is not None:
            moved = moved_links(self.robot.chain, q[None])[0]
            flange = tuple((moved[-1] @ self.robot.chain.base_from_flange).round(7).ravel().tolist())
            links = tuple(packed(moved).round(6).ravel().tolist())
        self._placed = (self._joints, flange, links)
        return flange, links
