"""What another process says to steer the robot, and what it is answered: one JSON object a line, both ways. No I/O.

{"token": "..."}                                        the first line over TCP: the caller may steer
{"joints": [0, 10, 10, 0, 40, 0]}                       be there, in deg (mm); with "rate", moving so fast, per s
{"pose": [0, 900, 1400, 0, 0, 0]}                       the tool shall be there in {B}: mm, and roll pitch yaw in deg
{"velocity": {"J3": 5}}                                 joints move so fast, in deg/s (mm/s)
{"twist": [0, 0, -50, 0, 0, 0], "axes": "tool"}         the tool moves so, in mm/s and deg/s, along axes of "base" or "tool"
{"finish": true}                                        come to rest
{"ok": true, "lag_s": 0.35, "behind": {...}, "why": ""} it is wanted now
{"ok": false, "error": "..."}                           it isn't, and why

A line that is no JSON object ends the connection: the caller speaks something else, and what follows may only look like an order.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from yarclang.coordinator.live.steering import JointVelocity, Master, Target, Twist
from yarclang.robot.kinematics.inverse import follow, reached_within
from yarclang.robot.model import Array, Robot
from yarclang.transforms import rpy_rotation
from yarclang.units import DEG, MM

MOST_LINE = 1 << 14
"""Longest line [bytes]."""

_SMOOTH = 0.3
"""How much of a new velocity of the master's counts."""

_LONGEST_GAP = 0.2
"""Messages that are farther apart say nothing about a velocity [s]."""

_JUMP = 0.5
"""Poses whose joints are farther from the last than this [rad or m] aren't one way any more."""

_HTTP = re.compile(rb"[A-Z]+ \S+ HTTP/")
"""The first line of what a browser sends."""

_LARGEST = 1e9
"""Largest magnitude of a number [mm, deg or per s]: beyond, the kinematics would overflow."""

_KINDS = ("joints", "pose", "velocity", "twist", "finish")


@dataclass(frozen=True, slots=True)
class Finish:
    """Come to rest."""


@dataclass(frozen=True, slots=True)
class Denied:
    """Refusal of what a line wants, and the reason. If it `ends` the connection, nothing else is read from it."""

    error: str
    ends: bool = False


TOO_LONG = Denied(f"a line is longer than {MOST_LINE // 1024} KiB", ends=True)
"""The answer to such a line: what follows can't be read."""


class Reader:
    """Makes targets of messages. A master's velocity is told by it, or estimated of what it said before.

    Args:
        robot: that is steered.
        tool: (4, 4) flange_from_tool, of poses.
        start: (n,) where it stands [rad or m].
    """

    def __init__(self, robot: Robot, tool: Array, start: Array) -> None:
        self._robot = robot
        self._tool = tool
        self._last = start
        self._heard: float | None = None
        self._rate = np.zeros(robot.size)

    def read(self, line: bytes, now: float) -> Target | Finish | Denied:
        """Return what a line wants, at a time [s]; whatever it holds, nothing is raised."""
        content = _object_in(line)
        if isinstance(content, Denied):
            return content
        kinds = [kind for kind in _KINDS if kind in content]
        if len(kinds) != 1:
            return Denied(f"one of {', '.join(_KINDS)} is wanted, not {len(kinds)}")
        kind = kinds[0]
        extra = set(content) - {kind, {"joints": "rate", "twist": "axes"}.get(kind, kind)}
        if extra:
            return Denied(f"{kind} takes no {sorted(extra)[0]!r}")
        match kind:
            case "joints":
                return self._joints(content, now)
            case "pose":
                return self._pose(content["pose"], now)
            case "velocity":
                return self._velocity(content["velocity"])
            case "twist":
                return self._twist(content)
            case _:
                return Finish() if content["finish"] is True else Denied("finish is true, or isn't said")

    def _joints(self, content: dict[str, Any], now: float) -> Target | Denied:
        units = self._robot.axis_units
        q = _numbers(content["joints"], len(units))
        rate = _numbers(content["rate"], len(units)) if "rate" in content else None
        if q is None or ("rate" in content and rate is None):
            return Denied(
                f"{len(units)} finite numbers are wanted, one a joint ({' '.join(self._robot.joint_names)})"
            )
        return self._master(q * units, None if rate is None else rate * units, now)

    def _pose(self, given: Any, now: float) -> Target | Denied:
        values = _numbers(given, 6)
        if values is None:
            return Denied("a pose is six finite numbers: x y z in mm, roll pitch yaw in deg")
        pose = np.eye(4)
        pose[:3, :3] = rpy_rotation(values[3:] * DEG)
        pose[:3, 3] = values[:3] * MM
        chain = self._robot.chain
        q, off, turned = follow(chain, (pose @ np.linalg.inv(self._tool))[None], self._last[None])
        miss = max(float(off[0]), float(turned[0]))
        if miss > reached_within(chain):
            return Denied(f"the pose is out of reach by {off[0] / MM:.1f} mm, {turned[0] / DEG:.2f} deg")
        if np.abs(q[0] - self._last).max() > _JUMP:
            return Denied("the pose is too far from the one before: another configuration, or a jump")
        return self._master(q[0], None, now)

    def _master(self, q: Array, rate: Array | None, now: float) -> Target | Denied:
        limits = self._robot.limits
        past = np.maximum(q - limits.upper, limits.lower - q)
        if (past > 0.0).any():
            joint = int(np.argmax(past))
            return Denied(f"{self._robot.joint_names[joint]} would be out of its limits")
        if rate is None:
            gap = None if self._heard is None else now - self._heard
            if gap is None or not 0.0 < gap < _LONGEST_GAP:
                self._rate = np.zeros(len(q))
            else:
                self._rate = (1.0 - _SMOOTH) * self._rate + _SMOOTH * (q - self._last) / gap
            rate = self._rate
        self._heard, self._last = now, q
        return Master(q, rate)

    def _velocity(self, given: Any) -> Target | Denied:
        names = {name.upper(): number for number, name in enumerate(self._robot.joint_names)}
        if not isinstance(given, dict) or not given:
            return Denied('velocity is an object: {"J3": 5}')
        velocity = np.zeros(self._robot.size)
        if len({name.upper() for name in given}) < len(given):
            return Denied("a joint is named twice")
        for name, value in given.items():
            number = _numbers([value], 1)
            if name.upper() not in names or number is None:
                return Denied(
                    f"{name!r} isn't a joint with a finite number; there are {', '.join(self._robot.joint_names)}"
                )
            velocity[names[name.upper()]] = number[0]
        return JointVelocity(velocity * self._robot.axis_units)

    def _twist(self, content: dict[str, Any]) -> Target | Denied:
        values = _numbers(content["twist"], 6)
        axes = content.get("axes", "base")
        if values is None:
            return Denied("a twist is six finite numbers: mm/s along x y z, deg/s about x y z")
        if axes not in ("base", "tool"):
            return Denied('axes are "base" or "tool"')
        return Twist(values[:3] * MM, values[3:] * DEG, axes)


def read_token(line: bytes) -> str | Denied:
    """Return the token of a line; whatever it holds, nothing is raised."""
    content = _object_in(line)
    if isinstance(content, Denied):
        return content
    token = content.get("token")
    if len(content) != 1 or not isinstance(token, str):
        return Denied(
            'the first line must be {"token": "..."}, with the token that yarc follow gives', ends=True
        )
    return token


def write_welcome() -> bytes:
    """Return the answer to the right token."""
    return _line({"ok": True})


def write_taken(robot: Robot, lag: float, behind: Array | None, why: str) -> bytes:
    """The answer to what is wanted now.

    Args:
        robot: that is steered.
        lag: what lies in the controller's buffer [s].
        behind: (n,) how far what is streamed is behind a master [rad or m].
        why: why it isn't done as it is wanted.
    """
    apart = None
    if behind is not None:
        values = np.round(behind / robot.axis_units, 4).tolist()
        apart = dict(zip(robot.joint_names, values, strict=True))
    return _line({"ok": True, "lag_s": round(lag, 3), "behind": apart, "why": why})


def write_denied(error: str) -> bytes:
    """The answer to what isn't."""
    return _line({"ok": False, "error": error})


def _object_in(line: bytes) -> dict[str, Any] | Denied:
    """Return a line's JSON object; the refusal of anything else ends the connection."""
    if len(line) > MOST_LINE:
        return TOO_LONG
    if _HTTP.match(line):
        return Denied("this is no web server: a web page can't steer a robot", ends=True)
    try:
        content = json.loads(line)
    except (ValueError, RecursionError):
        return Denied("this isn't JSON", ends=True)
    return content if isinstance(content, dict) else Denied("this isn't a JSON object", ends=True)


def _line(content: dict[str, Any]) -> bytes:
    return json.dumps(content).encode() + b"\n"


def _numbers(given: Any, count: int) -> Array | None:
    """Return so many numbers of at most `_LARGEST`, None for anything else."""
    if not isinstance(given, Sequence) or isinstance(given, str) or len(given) != count:
        return None
    if any(isinstance(one, bool) or not isinstance(one, int | float) for one in given):
        return None
    try:
        values = np.array(given, dtype=np.float64)
    except OverflowError:
        return None
    return values if (np.abs(values) <= _LARGEST).all() else None
