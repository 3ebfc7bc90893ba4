"""What pages are told without asking."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message, Question
from yarclang.runtime.state import State


class AlarmBar(Message):
    """The foremost alarm: the newest that nobody has acknowledged, else the newest that holds."""

    number: int
    """0: there is none."""
    code: str
    """Of the finding; empty: it is none."""
    text: str
    holds: bool
    open: int
    """How many alarms hold or nobody has acknowledged."""
    version: int
    """Number that changes with any alarm."""


NO_ALARM = AlarmBar(number=0, code="", text="", holds=False, open=0, version=0)


class Display(Message):
    """What is always on the screen: at most 20 times a second, and only if something has changed.

    Attributes:
        connected: False if the coordinator can't be reached: nothing else is current then.
    """

    event: Literal["display"] = "display"
    connected: bool
    state: State
    why: str
    asks: Question | None
    """What a HOLD of the program asks the operator for; None: nothing."""
    mode: str
    """What is going on, in a word: `idle`, `program`, `jog`, `held`, `fault`, `disconnected`."""
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
    """For each joint, what the joints up to it do to what they move: x y z [m] and the quaternion x y z w, from where all joints are at zero. Empty: not known."""
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
    """Why the audit trail can't be written: nothing can be ordered but a stop; empty: it can."""


class Beat(Message):
    """A heartbeat of a jog's connection: what is wanted is only done if it names one of the last few."""

    beat: int


class Notice(Message):
    """Something that a page shows to the person: `ask` is the session that asks for control of the robot."""

    event: Literal["notice"] = "notice"
    text: str
    warning: bool = False
    ask: str = ""
