"""The line at the bottom of the terminal: what the robot does, and where it is."""

from __future__ import annotations

import numpy as np

from yarclang.coordinator.describing import joints_of
from yarclang.coordinator.picture import Picture
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Robot
from yarclang.runtime.state import State
from yarclang.units import MM

_NOT_READY = (State.DISCONNECTED, State.FAULT)


class Toolbar:
    """Made anew whenever it is drawn, from what was told of the robot.

    Args:
        robot: that is shown.
        picture: what it does.
    """

    def __init__(self, robot: Robot, picture: Picture) -> None:
        self._robot = robot
        self._picture = picture

    def text(self, width: int) -> str:
        """Two lines: state, progress, whether it is ready, override; and tool and joints. As far as they fit into `width` columns."""
        picture = self._picture
        state, progress = picture.state, picture.progress
        parts = [f"{self._robot.name} {state.value}"]
        if picture.under_way and progress is not None:
            name = progress.command or picture.under_way
            parts.append(f"{name} {progress.done_s:.1f} s, {progress.left_s:.1f} s to go")
        parts.append("not ready" if state in _NOT_READY else "homed, enabled")
        parts.append(f"{picture.override:g} %")
        return f"{_joined(parts, width)}\n{_joined(self._places(), width)}"

    def _places(self) -> list[str]:
        robot = self._robot
        if self._picture.joints is None:
            return []
        joints = joints_of(robot, self._picture.joints)
        values = np.round(joints / robot.axis_units, 2) + 0.0
        tool = "TCP" if "TCP" in robot.flange_from_frame else "FLANGE"
        place = tool_poses(robot.chain, joints[None], robot.flange_from_frame[tool])[0, :3, 3] / MM
        shown = [f"{{{tool}}} {' '.join(f'{value:.2f}' for value in place.round(2) + 0.0)} mm"]
        return shown + [f"{name} {value:.2f}" for name, value in zip(robot.joint_names, values, strict=True)]


def _joined(parts: list[str], width: int) -> str:
    """As many of the parts as fit: half a number would be another number."""
    line = ""
    for part in parts:
        longer = f"{line} | {part}" if line else f" {part}"
        if len(longer) > width:
            break
        line = longer
    return line
