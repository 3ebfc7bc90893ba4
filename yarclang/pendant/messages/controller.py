"""Messages about the controller's side of the system: what waits for a restart, and the end of the pendant's
process.
"""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message


class WaitingFile(Message):
    """A file that was changed since the pendant has read it, and the consequence."""

    file: str
    what: str


class ControllerShown(Message):
    """The controller and the processes between it and the pages; `served` is true if `yarc serve` owns the
    robot, and only the pendant is restarted then.
    """

    robot: str
    controller: str
    simulated: bool
    served: bool
    since: str
    """Start time of the process that owns the robot, ISO 8601."""
    waiting: tuple[WaitingFile, ...]
    """Files that wait for a restart."""


class EndProcess(Message):
    """Restart or shut down; `stop`: first bring a motion to rest on its path."""

    stop: bool = False
