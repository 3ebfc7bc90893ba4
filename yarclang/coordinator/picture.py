"""What is known of a robot by what was told: for doors that show it. No I/O."""

from __future__ import annotations

from yarclang.coordinator.messages import events
from yarclang.coordinator.messages.message import Joints
from yarclang.coordinator.messages.replies import Status


class Picture:
    """What a robot does, as of the last event.

    Args:
        status: what was told at first.

    Attributes:
        state: what the robot does.
        owner: who may move it; empty: nobody does.
        under_way: what is carried out; empty: nothing is.
        paused: whether it stands between two commands that are carried out one by one.
        override: percent of the programmed speed.
        joints: actual positions [deg or mm]; None: not known yet.
        progress: how far the program is, while it is under way.
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
        """Take note of an event."""
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
