"""Messages that pages receive without asking."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message, Question
from yarclang.runtime.state import State


class AlarmBar(Message):
    """The foremost alarm: the newest that nobody has acknowledged, else the newest that holds."""

    number: int
    """0: there is none."""
    code: str
    """Code of the finding; empty: the alarm has none."""
    text: str
    holds: bool
    open: int
    """Number of alarms that hold or aren't acknowledged."""
    version: int
    """Number that changes with any alarm."""


NO_ALARM = AlarmBar(number=0, code="", text="", holds=False, open=0, version=0)


class Display(Message):
    """Data that is always on the screen: sent at most 20 times a second, and only after a change.

    Attributes:
        connected: False if the coordinator can't be reached: nothing else is current then.
    """

    event: Literal["display"] = "display"
    connected: bool
    state: State
    why: str
    asks: Question | None
    """Question of a HOLD to the operator; None: there is no question."""
    mode: str
    """Present activity: `idle`, `program`, `jog`, `held`, `fault`, `disconnected`."""
    owner: str | None
    under_way: str
    command: str
    line: int
    done_s: float
    left_s: float
    override: float
    paused: bool
    """True if the robot stands between two commands that are carried out one by one."""
    joints: tuple[float | None, ...]
    """In the order of the robot's joints [deg or mm]."""
    flange: tuple[float, ...] | None
    """(4, 4) base_from_flange, row by row [m]."""
    links: tuple[float, ...]
    """For each joint, the displacement of the bodies that move with it from their places with all joints at
    zero: x y z [m] and the quaternion x y z w. Empty: not known.
    """
    scene: str
    """The version of /api/scene that holds now; empty: nobody has asked for it yet."""
    touching: tuple[str, ...]
    """Bodies that are nearer to another one than their margin allows."""
    stopped_by: tuple[str, ...]
    """Bodies and zones that kept the last live motion from going on."""
    enabled: bool | None
    """True if all motors are closed-loop; None: not known."""
    homed: bool | None
    guard: bool | None
    """True if the guard PLC was tried and found at work."""
    alarm: AlarmBar
    audit: str
    """Reason why the audit trail can't be written, so that only a stop can be ordered; empty: it can be
    written.
    """


class Beat(Message):
    """A heartbeat of a jog's connection: a target is only followed if it names one of the last few
    heartbeats.
    """

    beat: int


class Notice(Message):
    """Something that a page shows to the person: `ask` is the session that asks for control of the robot."""

    event: Literal["notice"] = "notice"
    text: str
    warning: bool = False
    ask: str = ""
