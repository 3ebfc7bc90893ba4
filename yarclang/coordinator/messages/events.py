"""Events that a coordinator sends to subscribers. `time_s` is the time on its session's clock."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Joints, Message, Question, ValuesWanted
from yarclang.runtime.state import State


class BaseEvent(Message):
    """Base class of events."""

    event: str
    time_s: float


class StateChanged(BaseEvent):
    """The robot's state has changed, with the reason; after a failure also the code of the finding and the
    remedy. `asks`: the question of a HOLD, which goes on only with an answer.
    """

    event: Literal["state"] = "state"
    state: State
    why: str
    code: str | None = None
    help: str | None = None
    asks: Question | None = None


class ValuesAsked(BaseEvent):
    """The program accepts values from outside now (`fill`). Null: it accepts no more, since they were given
    or the wait is over.
    """

    event: Literal["values_wanted"] = "values_wanted"
    wanted: ValuesWanted | None


class Position(BaseEvent):
    """Actual positions of the robot, 50 times a second, and the time of the program."""

    event: Literal["position"] = "position"
    joints: Joints
    done_s: float


class ProgressMade(BaseEvent):
    """Progress of the program: known seconds done, seconds left at the present override, the command that is
    executed and its line.

    Motions and dwells count; where ways part, along the longer one.
    """

    event: Literal["progress"] = "progress"
    done_s: float
    left_s: float
    command: str
    line: int


class Found(BaseEvent):
    """Findings in a text from a client."""

    event: Literal["findings"] = "findings"
    client: str
    findings: tuple[Finding, ...]


class Told(BaseEvent):
    """A message for people."""

    event: Literal["message"] = "message"
    text: str
    warning: bool = False
    stopped_by: tuple[str, ...] = ()
    """The bodies and zones that stop a live motion, if the text says why it is stopped."""
    code: str | None = None
    """Code of the finding, if there is one."""


class OwnerChanged(BaseEvent):
    """The owner of the robot has changed; null: no owner."""

    event: Literal["owner"] = "owner"
    owner: str | None


class OverrideChanged(BaseEvent):
    """The override has changed, in percent of the programmed speed."""

    event: Literal["override"] = "override"
    percent: float


class Began(BaseEvent):
    """A motion was ordered and is being sent to the controller: its name, its duration, and the client that
    ordered it.

    `duration_s` is the known time along the longest ways, `waits` how often it waits for an input or the
    operator, at most.
    """

    event: Literal["began"] = "began"
    name: str
    duration_s: float
    waits: int
    client: str


class PartBegan(BaseEvent):
    """A part of the run begins: the way to the start, the program or its rest, one of its commands, or one
    more pass.

    `offset_s` is how far into the program it begins.
    """

    event: Literal["part"] = "part"
    name: str
    to_the_start: bool
    offset_s: float
    duration_s: float
    number: int
    """Number of the step or pass, from 1."""
    of: int | None
    """Total number; null: without end."""
    leads_out: bool = False
    """True: it isn't of the program; it leads back and out after a watched input has held a motion."""


class Paused(BaseEvent):
    """The robot waits for a request before the next command: `title`, number `number` of `of`."""

    event: Literal["paused"] = "paused"
    title: str
    number: int
    of: int


class Finished(BaseEvent):
    """The run or motion has ended, well or not. `joints` is null if the position isn't known; `line` is the
    program line of a fault.
    """

    event: Literal["finished"] = "finished"
    name: str
    well: bool
    what: str | None
    help: str | None
    code: str | None
    command: str | None
    done_s: float
    joints: Joints | None
    line: int | None = None


class OutputSet(BaseEvent):
    """The program has set an output: its name, the controller's variable, and the value (1 is ON, 0 OFF)."""

    event: Literal["output_set"] = "output_set"
    name: str
    variable: str
    value: float


class WaitBegan(BaseEvent):
    """The robot stands at a WAIT, at `place` in the program: the input must become `wanted`, and is `value`
    now.
    """

    event: Literal["wait_began"] = "wait_began"
    place: str
    name: str
    variable: str
    wanted: float
    value: float


class WaitEnded(BaseEvent):
    """A WAIT has ended after `waited_s`: the input has the wanted value, or (`met` is false) the time of the
    WAIT is over.
    """

    event: Literal["wait_ended"] = "wait_ended"
    place: str
    name: str
    variable: str
    value: float
    waited_s: float
    met: bool


class InputChanged(BaseEvent):
    """An input of a simulated robot has changed, by its script, by a sensor of the cell, or by hand."""

    event: Literal["input_changed"] = "input_changed"
    name: str
    variable: str
    value: float
    cause: Literal["script", "sensor", "hand"]


class SceneChanged(BaseEvent):
    """The bodies, zones or parts around the robot may have changed: ask for `scene`."""

    event: Literal["scene_changed"] = "scene_changed"


class Missed(BaseEvent):
    """Number of events that were dropped because this subscriber was too slow."""

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
    | OutputSet
    | WaitBegan
    | WaitEnded
    | InputChanged
    | SceneChanged
    | Missed,
    Field(discriminator="event"),
]

COALESCED = (Position, ProgressMade, SceneChanged)
"""Events of which only the newest counts."""
