"""What a coordinator tells those who watch it. `time_s` is that of its session's clock."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Joints, Message
from yarclang.runtime.state import State


class BaseEvent(Message):
    """Something has happened."""

    event: str
    time_s: float


class StateChanged(BaseEvent):
    """The robot's state is another one now, and why."""

    event: Literal["state"] = "state"
    state: State
    why: str


class Position(BaseEvent):
    """Where the robot is, 50 times a second: actual positions, and how far the program is."""

    event: Literal["position"] = "position"
    joints: Joints
    done_s: float


class ProgressMade(BaseEvent):
    """How far the program is: done and to go at the present override, the command that is executed and its line."""

    event: Literal["progress"] = "progress"
    done_s: float
    left_s: float
    command: str
    line: int


class Found(BaseEvent):
    """What was found in a text that a client gave."""

    event: Literal["findings"] = "findings"
    client: str
    findings: tuple[Finding, ...]


class Told(BaseEvent):
    """Something worth knowing, in words."""

    event: Literal["message"] = "message"
    text: str
    warning: bool = False


class OwnerChanged(BaseEvent):
    """Somebody else may move the robot now; null: nobody does."""

    event: Literal["owner"] = "owner"
    owner: str | None


class OverrideChanged(BaseEvent):
    """The pace is another one now, in percent of the programmed speed."""

    event: Literal["override"] = "override"
    percent: float


class Began(BaseEvent):
    """A motion was asked for and is under way to the controller: its name, how long it takes, who asked."""

    event: Literal["began"] = "began"
    name: str
    duration_s: float
    client: str


class PartBegan(BaseEvent):
    """A part of what began is carried out: the way to the start, the program or what is left of it, one of its commands, or one more pass.

    `offset_s` is how far into the program it begins.
    """

    event: Literal["part"] = "part"
    name: str
    to_the_start: bool
    offset_s: float
    duration_s: float
    number: int
    """Which step or pass, from 1."""
    of: int | None
    """Of so many; null: without end."""


class Paused(BaseEvent):
    """The robot stands until somebody wants the next command: `title`, number `number` of so many."""

    event: Literal["paused"] = "paused"
    title: str
    number: int
    of: int


class Finished(BaseEvent):
    """What began has ended, well or not; `joints` is null where nobody knows."""

    event: Literal["finished"] = "finished"
    name: str
    well: bool
    what: str | None
    help: str | None
    code: str | None
    command: str | None
    done_s: float
    joints: Joints | None


class Missed(BaseEvent):
    """So many events came faster than this subscriber took them, and were left out."""

    event: Literal["missed"] = "missed"
    count: int


Event = Annotated[
    StateChanged
    | Position
    | ProgressMade
    | Found
    | Told
    | OwnerChanged
    | OverrideChanged
    | Began
    | PartBegan
    | Paused
    | Finished
    | Missed,
    Field(discriminator="event"),
]

COALESCED = (Position, ProgressMade)
"""Events of which only the newest counts."""
