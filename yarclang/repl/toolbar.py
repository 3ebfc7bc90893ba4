"""The two lines at the bottom of the terminal: the robot's state and position."""

from __future__ import annotations

from yarclang.coordinator.describing import joints_of
from yarclang.coordinator.picture import Picture
from yarclang.robot.joint_names import short_labels
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.runtime.state import State
from yarclang.units import MM

_NOT_READY = (State.DISCONNECTED, State.FAULT)


class Toolbar:
    """The status lines at the bottom of the terminal, which are computed each time they are drawn.

    Args:
        robot: the robot.
        picture: the robot's state.
    """

    def __init__(self, robot: Robot, picture: Picture) -> None:
        self._robot = robot
        self._picture = picture

    def text(self, width: int) -> str:
        """Return two lines of at most `width` columns: state, progress, readiness and override; tool and
        joints.

        Fields that don't fit are shortened.
        """
        return f"{_fitting(self._states(), width)}\n{_fitting(self._places(), width)}"

    def _states(self) -> list[list[str]]:
        """Return the fields of the first line (state and progress), first in full and then in shorter and
        shorter forms.
        """
        picture = self._picture
        state, progress = picture.state, picture.progress
        ready = "not ready" if state in _NOT_READY else "homed, enabled"
        pace = f"{picture.override:g} %"
        begin = f"{self._robot.name} {state.value}"
        if not picture.under_way or progress is None:
            return [[begin, ready, pace], [begin, pace], [state.value, pace]]
        name = progress.command or picture.under_way
        times = f"{progress.done_s:.1f} s, {progress.left_s:.1f} s to go"
        index = name.split(maxsplit=1)[0]
        return [
            [begin, f"{name} {times}", ready, pace],
            [begin, f"{name} {times}", pace],
            [begin, f"{index} {times}", pace],
            [state.value, times, pace],
        ]

    def _places(self) -> list[list[str]]:
        """Return the fields of the second line (tool position and joints), first in full and then in shorter
        and shorter forms.
        """
        robot = self._robot
        if self._picture.joints is None:
            return [[]]
        joints = joints_of(robot, self._picture.joints)
        tool = "TCP" if "TCP" in robot.flange_from_frame else "FLANGE"
        place = tool_poses(robot.chain, joints[None], robot.flange_from_frame[tool])[0, :3, 3] / MM
        names, values = short_labels(robot.joint_names), joints / robot.axis_units
        named = [f"{name} {_number(value, 2)}" for name, value in zip(names, values, strict=True)]
        short = [
            [f"{{{tool}}} {_numbers(place, tools)} mm", f"{names[0]}-{names[-1]} {_numbers(values, digits)}"]
            for tools, digits in ((2, 2), (1, 2), (1, 1), (0, 1), (0, 0))
        ]
        return [[f"{{{tool}}} {_numbers(place, 2)} mm", *named], *short]


def _numbers(values: Array, digits: int) -> str:
    return " ".join(_number(value, digits) for value in values)


def _number(value: float, digits: int) -> str:
    return f"{round(float(value), digits) + 0.0:.{digits}f}"


def _fitting(choices: list[list[str]], width: int) -> str:
    """Return the first of several forms of a line that fits the width.

    If none fits, return as many fields of the last form as fit. Numbers aren't cut, since half a number would
    be a wrong number.
    """
    for parts in choices:
        line = f" {' | '.join(parts)}" if parts else ""
        if len(line) <= width:
            return line
    line = ""
    for part in choices[-1]:
        longer = f"{line} | {part}" if line else f" {part}"
        if len(longer) > width:
            break
        line = longer
    return line
