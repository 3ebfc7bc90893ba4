"""What a coordinator tells those who watch it. Plain values; `time` is that of the session's clock [s]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from yarclang.diagnostics import Diagnostic
from yarclang.robot.model import Array, Robot
from yarclang.runtime.outcome import Ended
from yarclang.runtime.state import State


@dataclass(frozen=True, slots=True)
class StateChanged:
    """The robot's state is another one now, and why."""

    time: float
    state: State
    why: str


@dataclass(frozen=True, slots=True, eq=False)
class Position:
    """Where the robot is: `joints` (n,) actual positions [rad or m]; `done` is how far the program is [s]."""

    time: float
    joints: Array
    done: float


@dataclass(frozen=True, slots=True)
class ProgressMade:
    """How far the program is: seconds done and to go at the present override, the command that is executed and its line."""

    time: float
    done: float
    left: float
    command: str
    line: int


@dataclass(frozen=True, slots=True)
class Found:
    """What was found in a text that somebody gave: `text` is that text, `client` who gave it."""

    time: float
    client: str
    text: str
    findings: tuple[Diagnostic, ...]


@dataclass(frozen=True, slots=True)
class Message:
    """Something worth knowing, in words."""

    time: float
    text: str
    warning: bool = False


@dataclass(frozen=True, slots=True)
class OwnerChanged:
    """Somebody else may move the robot now; empty: nobody does."""

    time: float
    owner: str


@dataclass(frozen=True, slots=True)
class Began:
    """A motion was asked for and is under way to the controller: its name, how long it takes [s], who asked."""

    time: float
    name: str
    duration: float
    client: str


@dataclass(frozen=True, slots=True, eq=False)
class Finished:
    """What began has ended, well or not."""

    time: float
    name: str
    ended: Ended


@dataclass(frozen=True, slots=True)
class Missed:
    """So many events came faster than this subscriber took them, and were left out."""

    time: float
    count: int


Event: TypeAlias = (
    StateChanged | Position | ProgressMade | Found | Message | OwnerChanged | Began | Finished | Missed
)

COALESCED = (Position, ProgressMade)
"""Events of which only the newest counts."""

_NAMES: dict[type, str] = {
    StateChanged: "state",
    Position: "position",
    ProgressMade: "progress",
    Found: "findings",
    Message: "message",
    OwnerChanged: "owner",
    Began: "began",
    Finished: "finished",
    Missed: "missed",
}


def name_of(event: Event) -> str:
    """The word for its kind: state, position, progress, findings, message, owner, began, finished, missed."""
    return _NAMES[type(event)]


def event_json(event: Event, robot: Robot, since: float = 0.0) -> dict[str, Any]:
    """An event as plain data; docs/coordinator.md has the schema.

    Args:
        event: any.
        robot: whose joints they are: positions are in its axis units (deg or mm).
        since: when the clock of the answer began [s].
    """
    content: dict[str, Any] = {"event": name_of(event), "time_s": round(event.time - since, 4)}
    match event:
        case StateChanged():
            content |= {"state": event.state.value, "why": event.why}
        case Position():
            content |= {"joints": _joints(event.joints, robot), "done_s": round(event.done, 4)}
        case ProgressMade():
            content |= {
                "done_s": round(event.done, 4),
                "left_s": round(event.left, 4),
                "command": event.command,
                "line": event.line,
            }
        case Found():
            from yarclang.report.finding import finding_json  # brings in click

            content |= {"client": event.client, "findings": [finding_json(one) for one in event.findings]}
        case Message():
            content |= {"text": event.text, "warning": event.warning}
        case OwnerChanged():
            content |= {"owner": event.owner or None}
        case Began():
            content |= {"name": event.name, "duration_s": round(event.duration, 4), "client": event.client}
        case Finished():
            content |= {"name": event.name, **ended_json(event.ended, robot)}
        case Missed():
            content |= {"count": event.count}
    return content


def ended_json(ended: Ended, robot: Robot) -> dict[str, Any]:
    """How something has ended, as plain data; `joints` is None where nobody knows."""
    return {
        "well": ended.well,
        "what": ended.what or None,
        "help": ended.remedy or None,
        "code": ended.code or None,
        "command": ended.command or None,
        "done_s": round(ended.done, 4),
        "joints": None if ended.joints is None else _joints(ended.joints, robot),
    }


def _joints(joints: Array, robot: Robot) -> dict[str, float]:
    """By name, in deg or mm."""
    return {
        name: round(float(value), 6)
        for name, value in zip(robot.joint_names, joints / robot.axis_units, strict=True)
    }
