"""Messages about the processes behind the pages: changed files that require a restart, and the end of the
pendant's process.
"""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message


class WaitingFile(Message):
    """A file that has changed since the pendant read it, and the consequence."""

    file: str
    what: str


class ControllerShown(Message):
    """The controller, and the processes between the controller and the pages. `served` is true if a process
    of `yarc serve` owns the robot. A restart then restarts only the pendant.
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
    """Request to restart or shut down the process. `stop`: if the robot is moving, first bring it to rest on
    its path.
    """

    stop: bool = False
