"""The line at the bottom of the terminal: what the robot does, and where it is."""

from __future__ import annotations

import numpy as np

from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.events import Event, ProgressMade
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.runtime.state import State
from yarclang.units import MM

_NOT_READY = (State.DISCONNECTED, State.FAULT)


class Toolbar:
    """Made anew whenever it is drawn, from what the coordinator knows.

    Args:
        coordinator: that owns the robot.
    """

    def __init__(self, coordinator: Coordinator) -> None:
        self._coordinator = coordinator
        self._progress: ProgressMade | None = None

    def hear(self, event: Event) -> None:
        """Keep how far the robot is."""
        if isinstance(event, ProgressMade):
            self._progress = event

    def text(self, width: int) -> str:
        """Two lines: state, progress, whether it is ready, override; and tool and joints. As far as they fit into `width` columns."""
        coordinator = self._coordinator
        state = coordinator.state
        parts = [f"{coordinator.robot.name} {state.value}"]
        if coordinator.under_way and self._progress is not None:
            name = self._progress.command or coordinator.under_way
            parts.append(f"{name} {self._progress.done:.1f} s, {self._progress.left:.1f} s to go")
        parts.append("not ready" if state in _NOT_READY else "homed, enabled")
        parts.append(f"{coordinator.override:g} %")
        return f"{_joined(parts, width)}\n{_joined(self._places(), width)}"

    def _places(self) -> list[str]:
        coordinator = self._coordinator
        joints, robot = coordinator.position, coordinator.robot
        if joints is None:
            return []
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
