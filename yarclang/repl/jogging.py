"""Compute jogs from pressed keys: axis, direction and speed. This depends neither on the terminal nor on the
robot.

A terminal reports that a key is pressed, and pressed again, but never that it is released. Therefore each
press moves the robot for the time `HELD`, and the repetition of a pressed key keeps the robot moving. Between
two presses the live motion stays open, with rest as its target.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from yarclang.coordinator.messages import wants
from yarclang.robot.joint_names import joint_labels, joint_number, listed_joints
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.units import DEG, MM

HELD = 0.2
"""Duration of the motion for one press [s]."""

_LEAVING = ("enter", "escape", "q", "c-d")
_FASTER, _SLOWER = ("up", "down")
_STEP = 1.25
_SLOWEST = 0.01
"""Slowest speed of a jog, as a share of the fastest speed."""

AXES = "xyzabc"
"""Axes of a tool: x, y, z are translations, and a, b, c are rotations about these axes."""

_FAST_TURN = 30.0 * DEG
"""Largest angular speed of a jog about an axis [rad/s]."""

_START = 0.1
"""Speed with which a jog begins, as a share of the fastest speed. The user can change it."""


@dataclass(frozen=True, slots=True)
class Axis:
    """A joint, or an axis of the tool frame, that a key moves.

    Attributes:
        kind: `joint` for a joint of the robot; `base` or `tool` for an axis of the tool frame, in the
            directions of {B} or of the tool itself.
        number: number of the joint, or place in `AXES`, from 0.
    """

    kind: Literal["joint", "base", "tool"]
    number: int


class Jogging:
    """The current jog: the last key, and the motion that it requests.

    Args:
        robot: the robot.
        axis: the first axis.
        sign: direction for keys without a sign.
        moving: the moving frame, in braces.

    Attributes:
        axis: the current axis.
        share: speed as a share of the fastest.
        ended: True if the user wants to end the jog.
    """

    def __init__(self, robot: Robot, axis: Axis, sign: int = 1, moving: str = "{TCP}") -> None:
        self.robot = robot
        self.axis = axis
        self.share = _START
        self.moving = moving
        self.ended = False
        self._sign = sign
        self._since = -np.inf

    def press(self, key: str, now: float) -> None:
        """Handle a key. Keys without a meaning stop the robot.

        Args:
            key: name of the key.
            now: time [s].
        """
        self._since = -np.inf
        if key in ("+", "-", " ", "right", "left"):
            self._sign = {"+": 1, "right": 1, "-": -1, "left": -1}.get(key, self._sign)
            self._since = now
        elif key in _LEAVING:
            self.ended = True
        elif key == _FASTER:
            self.share = min(self.share * _STEP, 1.0)
        elif key == _SLOWER:
            self.share = max(self.share / _STEP, _SLOWEST)
        elif key.isdigit() and 1 <= int(key) <= self.robot.size:
            self.axis = Axis("joint", int(key) - 1)
        elif key in AXES:
            self.axis = Axis("tool" if self.axis.kind == "tool" else "base", AXES.index(key))
        elif key == "t" and self.axis.kind != "joint":
            self.axis = Axis("base" if self.axis.kind == "tool" else "tool", self.axis.number)

    def moves(self, now: float) -> bool:
        """Return True if a key counts as pressed at a time [s]."""
        return now - self._since < HELD

    def want(self, now: float) -> wants.MoveJoints | wants.MoveTool:
        """Return the live motion that the pressed keys request at a time [s]."""
        speed = self._sign * self.share * self._fastest if self.moves(now) else 0.0
        if self.axis.kind == "joint":
            number = self.axis.number
            unit = float(self.robot.axis_units[number])
            return wants.MoveJoints(velocity={self.robot.joint_names[number]: speed / unit})
        twist = [0.0] * 6
        twist[self.axis.number] = speed / (MM if self.axis.number < 3 else DEG)
        return wants.MoveTool(twist=tuple(twist), axes="tool" if self.axis.kind == "tool" else "base")

    @property
    def _fastest(self) -> float:
        """Return the fastest speed of the axis [rad/s or m/s]."""
        if self.axis.kind == "joint":
            return float(self.robot.limits.velocity[self.axis.number])
        return self.robot.jog_speed if self.axis.number < 3 else _FAST_TURN

    @property
    def text(self) -> str:
        """Return the jogged axis, the speed and the keys as text."""
        speed = self.share * self._fastest
        if self.axis.kind == "joint":
            unit = self.robot.axis_unit_names[self.axis.number]
            name = joint_labels(self.robot.joint_names)[self.axis.number]
            shown = f"{speed / float(self.robot.axis_units[self.axis.number]):.3g} {unit}/s"
        else:
            frame = self.moving if self.axis.kind == "tool" else "{B}"
            name = f"{self.moving} {AXES[self.axis.number]} of {frame}"
            shown = f"{speed / MM:.3g} mm/s" if self.axis.number < 3 else f"{speed / DEG:.3g} deg/s"
        return (
            f"jog {name} at {shown}: hold + or -; 1-{min(self.robot.size, 9)} joint, {AXES} axis, t "
            f"tool/base, up/down speed, Enter ends"
        )


def axis_of(robot: Robot, words: list[str]) -> tuple[Axis, int, str]:
    """Return axis, sign and moving frame from words such as `J3 +`, `{TCP} +x` or `{TCP} -b tool`.

    Raises:
        Trouble: the words have another form.
    """
    what = words[0].upper() if words else ""
    rest = words[1:]
    number = joint_number(robot.joint_names, what)
    if number is not None and len(rest) <= 1 and all(word in ("+", "-") for word in rest):
        return Axis("joint", number), -1 if rest == ["-"] else 1, "{TCP}"
    if what.startswith("{") and what.endswith("}") and len(rest) <= 2:
        along = rest[0].lower() if rest else "x"
        kind: Literal["base", "tool"] = "tool" if rest[1:] == ["tool"] else "base"
        sign, letter = (-1 if along.startswith("-") else 1), along.lstrip("+-")
        if letter in AXES and len(letter) == 1 and rest[1:] in ([], ["tool"], ["base"]):
            return Axis(kind, AXES.index(letter)), sign, what
    raise Trouble(
        ".jog takes a joint, as J3 +, or a frame and an axis, as {TCP} +x",
        f"the joints are {listed_joints(robot.joint_names)}",
    )
