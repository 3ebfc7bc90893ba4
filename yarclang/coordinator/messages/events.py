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
    """The robot's state has changed, with the reason; after a failure also with the code of the finding and
    the remedy. `asks` is the question of a HOLD, which continues only with an answer.
    """

    event: Literal["state"] = "state"
    state: State
    why: str
    code: str | None = None
    help: str | None = None
    asks: Question | None = None


class ValuesAsked(BaseEvent):
    """The program accepts values from outside now (`fill`). Null: it no longer accepts any, because they were
    given or the wait is over.
    """

    event: Literal["values_wanted"] = "values_wanted"
    wanted: ValuesWanted | None


class Position(BaseEvent):
    """Actual position of the robot, sent 50 times a second, and the time of the program."""

    event: Literal["position"] = "position"
    joints: Joints
    done_s: float


class ProgressMade(BaseEvent):
    """Progress of the program: passed time [s], remaining time at the present override [s], and the command
    that is being executed with its line.

    The times are those of motions and dwells, without waits. Where the program branches, the time of the
    longer branch counts.
    """

    event: Literal["progress"] = "progress"
    done_s: float
    left_s: float
    command: str
    line: int


class Found(BaseEvent):
    """Findings about a text that a client has sent."""

    event: Literal["findings"] = "findings"
    client: str
    findings: tuple[Finding, ...]


class Told(BaseEvent):
    """A message for the users."""

    event: Literal["message"] = "message"
    text: str
    warning: bool = False
    stopped_by: tuple[str, ...] = ()
    """Bodies and zones that limit a live motion; empty for all other messages."""
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

    `duration_s` is the time of motions and dwells along the longest branches. `waits` is the largest possible
    number of waits for an input or the operator.
    """

    event: Literal["began"] = "began"
    name: str
    duration_s: float
    waits: int
    client: str


class PartBegan(BaseEvent):
    """A part of the run begins: the motion to the start, the program or the rest of it, one of its commands,
    or another pass.

    `offset_s` is the time of the program at which the part begins [s].
    """

    event: Literal["part"] = "part"
    name: str
    to_the_start: bool
    offset_s: float
    duration_s: float
    number: int
    """Number of the step or pass, from 1."""
    of: int | None
    """Total number of steps or passes; null: unlimited."""
    leads_out: bool = False
    """True: the part is the retreat after a watched input has held a motion (back on the path, then out). The
    retreat isn't in the program.
    """


class Paused(BaseEvent):
    """The robot waits until somebody orders the next command. `title` is the command, `number` its number,
    and `of` the number of all commands.
    """

    event: Literal["paused"] = "paused"
    title: str
    number: int
    of: int


class Finished(BaseEvent):
    """The run or motion has ended; `well` is true if it was complete. `joints` is null if the position isn't
    known; `line` is the program line of a fault.
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
    """The robot stands at a WAIT, at `place` in the program, until the input has the value `wanted`. Its
    present value is `value`.
    """

    event: Literal["wait_began"] = "wait_began"
    place: str
    name: str
    variable: str
    wanted: float
    value: float


class WaitEnded(BaseEvent):
    """A WAIT has ended after `waited_s`. `met` is true if the input has the wanted value, false if the time
    limit of the WAIT has passed.
    """

    event: Literal["wait_ended"] = "wait_ended"
    place: str
    name: str
    variable: str
    value: float
    waited_s: float
    met: bool


class InputChanged(BaseEvent):
    """An input of a simulated robot has changed: by its script, by a sensor of the cell, or by a user."""

    event: Literal["input_changed"] = "input_changed"
    name: str
    variable: str
    value: float
    cause: Literal["script", "sensor", "hand"]


class SceneChanged(BaseEvent):
    """The bodies, zones or parts around the robot may have changed. The order `scene` returns them."""

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
"""Types of events of which only the newest one waits for a subscriber."""
