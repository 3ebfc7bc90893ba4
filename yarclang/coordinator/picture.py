"""The state of a robot, collected from events, for programs that display it. No I/O."""

from __future__ import annotations

from yarclang.coordinator.messages import events
from yarclang.coordinator.messages.message import Joints
from yarclang.coordinator.messages.replies import Status


class Picture:
    """The state of a robot according to the events so far.

    Args:
        status: state of the robot before the first event.

    Attributes:
        state: state of the robot.
        owner: client that may move the robot; empty if there is none.
        under_way: action in progress; empty: none.
        paused: True if the robot stands between two commands that are carried out one by one.
        override: percent of the programmed speed.
        joints: actual joint positions [deg or mm]; None: not known yet.
        progress: progress of the program in progress.
    """

    def __init__(self, status: Status) -> None:
        self.state = status.state
        self.owner = status.owner or ""
        self.under_way = ""
        self.paused = False
        self.override = status.override
        known = {one.name: one.position for one in status.joints if one.position is not None}
        self.joints: Joints | None = known if len(known) == len(status.joints) else None
        self.progress: events.ProgressMade | None = None

    def hear(self, event: events.BaseEvent) -> None:
        """Update the state from an event."""
        match event:
            case events.StateChanged():
                self.state = event.state
            case events.OwnerChanged():
                self.owner = event.owner or ""
            case events.OverrideChanged():
                self.override = event.percent
            case events.Position():
                self.joints = event.joints
            case events.ProgressMade():
                self.progress = event
            case events.Began():
                self.under_way, self.paused, self.progress = event.name, False, None
            case events.PartBegan():
                self.paused = False
            case events.Paused():
                self.paused = True
            case events.Finished():
                self.under_way, self.paused = "", False
