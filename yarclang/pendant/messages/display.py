"""Messages that pages receive without a request."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message, Question
from yarclang.runtime.state import State


class AlarmBar(Message):
    """The most important alarm: the newest one that nobody has acknowledged. If all are acknowledged, it is
    the newest one whose fault is still present.
    """

    number: int
    """Number of the alarm; 0: there is none."""
    code: str
    """Code of the finding; empty: the alarm has none."""
    text: str
    holds: bool
    open: int
    """Number of alarms whose fault is present or that aren't acknowledged."""
    version: int
    """Number that changes whenever an alarm changes."""


NO_ALARM = AlarmBar(number=0, code="", text="", holds=False, open=0, version=0)


class Display(Message):
    """Data that is always on the screen, sent at most 20 times a second and only after a change."""

    event: Literal["display"] = "display"
    connected: bool
    state: State
    why: str
    asks: Question | None
    """Question of a HOLD to the operator; null: there is no question."""
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
    """True if the robot is at rest between two commands of a program that is executed step by step."""
    joints: tuple[float | None, ...]
    """Joint positions, in the order of the robot's joints [deg or mm]."""
    flange: tuple[float, ...] | None
    """Matrix (4, 4) base_from_flange, row by row, lengths in m."""
    links: tuple[float, ...]
    """Displacement of each joint's bodies from their poses at zero joint positions: x y z [m] and the
    quaternion x y z w. Empty: not known.
    """
    scene: str
    """Version of the present scene (/api/scene); empty: nobody has requested a scene yet."""
    touching: tuple[str, ...]
    """Bodies that are closer to another body than their margin allows."""
    stopped_by: tuple[str, ...]
    """Bodies and zones that limited the last live motion."""
    enabled: bool | None
    """True if all motors are closed-loop; null: not known."""
    homed: bool | None
    guard: bool | None
    """True if the guard PLC was tested and works."""
    alarm: AlarmBar
    audit: str
    """Reason why the audit trail can't be written. In this case only a stop can be ordered. Empty: it can be
    written.
    """


class Beat(Message):
    """A heartbeat on a page's connection for jogs. The page sends the last heartbeat back in each message; an
    old one doesn't move the robot.
    """

    beat: int


class Notice(Message):
    """A message that a page shows to the user. `ask` is the id of a session that asks for control of the
    robot.
    """

    event: Literal["notice"] = "notice"
    text: str
    warning: bool = False
    ask: str = ""
