"""What other terminals ask of a run and what it answers: one JSON object a line, both ways. No I/O.

{"order": "hold"}                        hold, resume, step, stop, abort, status
{"order": "override", "percent": 50}
{"ok": true, "state": "move"}            an order was taken
{"ok": true, "program": "a.yarc", ...}   a status
{"ok": false, "error": "..."}            it wasn't, and why
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any, Final, TypeAlias

from yarclang.robot.model import Robot
from yarclang.runtime.feedback import Sample
from yarclang.runtime.notices import (
    Abort,
    Changed,
    Hold,
    Notice,
    Order,
    Override,
    Progress,
    Resume,
    Stop,
)
from yarclang.runtime.operation import Operation
from yarclang.runtime.state import State

MOST_LINE: Final = 1 << 16
"""Longest line, with its end [bytes]."""


@dataclass(frozen=True, slots=True)
class AskStatus:
    """How is it going? Answered by `Status`."""


@dataclass(frozen=True, slots=True)
class Step:
    """Go on to the next command."""


Request: TypeAlias = Hold | Resume | Stop | Abort | Override | Step | AskStatus


@dataclass(frozen=True, slots=True)
class Taken:
    """An order was taken; in which state it found the run. That it is done by now isn't said."""

    state: State


@dataclass(frozen=True, slots=True)
class Denied:
    """Nothing was done, and why."""

    error: str


@dataclass(frozen=True, slots=True)
class Joint:
    """Where a joint is: its actual position in `unit`, deg or mm; None where it isn't known yet."""

    name: str
    position: float | None
    unit: str


@dataclass(frozen=True, slots=True)
class Command:
    """What is executed, and its line in the program."""

    title: str
    line: int


@dataclass(frozen=True, slots=True)
class Status:
    """How a run is going.

    Attributes:
        program: its name.
        robot: likewise.
        controller: its address, `host:port`.
        state: what it does, and `why` if there is more to say.
        command: what is executed, if anything is.
        done: how far the program is [s].
        left: what is to go at the present override [s].
        override: percent of the programmed speed.
        joints: where the robot is.
        waiting: orders that the run hasn't looked at yet.
        pid: of its process.
        since: when it began, ISO 8601.
    """

    program: str
    robot: str
    controller: str
    state: State
    why: str
    command: Command | None
    done: float
    left: float
    override: float
    joints: tuple[Joint, ...]
    waiting: int
    pid: int
    since: str


Reply: TypeAlias = Taken | Status | Denied

_WORDS: dict[str, Request] = {
    "hold": Hold(),
    "resume": Resume(),
    "step": Step(),
    "stop": Stop(),
    "abort": Abort(),
    "status": AskStatus(),
}
_OVERRIDE = "override"
_SHOWN = 40
_ENDED = (State.STOP, State.FAULT)

TOO_LONG: Final = Denied(f"a line is longer than {MOST_LINE // 1024} KiB")
"""The answer to one; what comes behind it can't be read either."""


def read_request(line: bytes) -> Request | Denied:
    """What a line asks; whatever it holds, nothing is raised."""
    content = _object_in(line)
    if isinstance(content, Denied):
        return content
    word = content.pop("order", None)
    if word == _OVERRIDE:
        percent = content.pop("percent", None)
        if isinstance(percent, bool) or not isinstance(percent, int | float) or not 1 <= percent <= 100:
            return Denied('override needs "percent", a number from 1 to 100')
        request: Request = Override(float(percent))
    elif isinstance(word, str) and word in _WORDS:
        request = _WORDS[word]
    else:
        known = ", ".join((*_WORDS, _OVERRIDE))
        return Denied(f'"order" is {_shown(word)}; it may be {known}')
    if content:
        return Denied(f"{word} takes no {_shown(next(iter(content)))}")
    return request


def write_request(request: Request) -> bytes:
    """The line that asks it."""
    if isinstance(request, Override):
        return _line({"order": _OVERRIDE, "percent": request.percent})
    return _line({"order": name_of(request)})


def name_of(request: Request) -> str:
    """The word for it: hold, resume and so on."""
    if isinstance(request, Override):
        return _OVERRIDE
    return next(word for word, known in _WORDS.items() if known == request)


def read_reply(line: bytes) -> Reply:
    """What a line answers; a line that no run would send is `Denied`, too."""
    content = _object_in(line)
    if isinstance(content, Denied):
        return Denied(f"the run's answer isn't understood: {content.error}")
    try:
        if content["ok"] is not True:
            return Denied(str(content["error"]))
        if "program" not in content:
            return Taken(State(content["state"]))
        return _status_in(content)
    except (KeyError, TypeError, ValueError, OverflowError):
        return Denied("the run's answer isn't understood: is it another version of yarc?")


def _status_in(content: dict[str, Any]) -> Status:
    command = content["command"]
    return Status(
        program=str(content["program"]),
        robot=str(content["robot"]),
        controller=str(content["controller"]),
        state=State(content["state"]),
        why=str(content["why"]),
        command=Command(str(command["title"]), int(command["line"])) if command else None,
        done=float(content["done"]),
        left=float(content["left"]),
        override=float(content["override"]),
        joints=tuple(
            Joint(
                str(one["name"]),
                None if one["position"] is None else float(one["position"]),
                str(one["unit"]),
            )
            for one in content["joints"]
        ),
        waiting=int(content["waiting"]),
        pid=int(content["pid"]),
        since=str(content["since"]),
    )


def write_reply(reply: Reply) -> bytes:
    """The line that answers so."""
    match reply:
        case Denied(error=error):
            return _line({"ok": False, "error": error})
        case Taken(state=state):
            return _line({"ok": True, "state": state.value})
        case Status():
            return _line({"ok": True, **as_json(reply)})


def as_json(status: Status) -> dict[str, Any]:
    """A status as plain data."""
    return {**asdict(status), "state": status.state.value}


def fulfilled(request: Request, status: Status) -> bool:
    """Whether what was ordered is so by now, or can't be any more as nothing moves."""
    if isinstance(request, Hold) and status.state in _ENDED:
        return True  # a run that hasn't begun looks at its orders later
    if status.waiting:
        return False
    match request:
        case Hold():
            return status.state is State.HOLD
        case Resume() | Step():
            return status.state is not State.HOLD
        case Stop() | Abort():
            return status.state in _ENDED
        case Override(percent=percent):
            return abs(status.override - percent) < 1e-3 or status.state in _ENDED
        case AskStatus():
            return True


def order_in(request: Request, operation: Operation) -> Order | Denied:
    """The order that a request stands for, as the run is now; a request for a status stands for none."""
    match request:
        case Resume() | Step() if operation.state is State.MOVE and Hold() not in operation.orders:
            return Denied("it isn't held: there is nothing to resume")
        case Step():
            return Resume()
        case AskStatus():
            return Denied("a status isn't an order")
        case _:
            return request


@dataclass(frozen=True, slots=True, eq=False)
class About:
    """What a run is about: the name of its program, and whom it moves."""

    program: str
    robot: Robot


class Watch:
    """Listens to a run (`session.listen(watch.hear)`) and knows how it is going."""

    def __init__(self) -> None:
        self._why = ""
        self._progress = Progress(0.0, 0.0, 0.0, "", 0)
        self._sample: Sample | None = None

    def hear(self, notice: Notice) -> None:
        """Remember what a notice says."""
        match notice:
            case Changed(why=why):
                self._why = why
            case Progress():
                self._progress = notice
            case Sample():
                self._sample = notice

    def status(self, operation: Operation, about: About, controller: str, pid: int, since: str) -> Status:
        """What is known now."""
        robot, progress, sample = about.robot, self._progress, self._sample
        places = [None] * robot.size if sample is None else sample.joints(robot) / robot.axis_units
        return Status(
            program=about.program,
            robot=robot.name,
            controller=controller,
            state=operation.state,
            why=self._why,
            command=Command(progress.command, progress.source_line) if progress.command else None,
            done=round(progress.done, 3),
            left=round(progress.left, 3),
            override=round(operation.override * 100.0, 6),
            joints=tuple(
                Joint(name, None if place is None else round(float(place), 6), unit)
                for name, place, unit in zip(robot.joint_names, places, robot.axis_unit_names, strict=True)
            ),
            waiting=len(operation.orders),
            pid=pid,
            since=since,
        )


def _object_in(line: bytes) -> dict[str, Any] | Denied:
    if len(line) > MOST_LINE:
        return TOO_LONG
    try:
        content = json.loads(line)
    except (ValueError, RecursionError):
        return Denied(f"{_shown(line.decode(errors='replace').strip())} isn't JSON")
    if not isinstance(content, dict):
        return Denied(f"{_shown(content)} isn't a JSON object")
    return content


def _line(content: dict[str, Any]) -> bytes:
    return json.dumps(content).encode() + b"\n"


def _shown(value: object) -> str:
    """A value for people, cut where it is long."""
    match value:
        case str():
            return json.dumps(value if len(value) <= _SHOWN else value[:_SHOWN] + "...")
        case list():
            return "a list"
        case dict():
            return "an object"
        case _:
            return json.dumps(value)[:_SHOWN]
