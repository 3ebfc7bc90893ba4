"""A calibration that goes on: what was touched so far, and what comes of it. The robot is moved in between by whatever moves it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from yarclang.calibration.frame import FrameCalibration, find_frame
from yarclang.calibration.home import OffsetCalibration, find_offsets
from yarclang.calibration.tool import FEWEST_TOUCHES, TipCalibration, find_tip
from yarclang.diagnostics import Diagnostic, Result
from yarclang.robot.actuation import to_counts
from yarclang.robot.kinematics.fk import flange_poses, tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.units import MM


class Touching(ABC):
    """A calibration.

    Attributes:
        name: of what is calibrated.
        joints: (n,) each, where the robot stood at each touch [rad or m].
        findings: what is wrong with the touches so far.
    """

    fewest = 1

    def __init__(self, robot: Robot, name: str) -> None:
        self.robot = robot
        self.name = name
        self.joints: list[Array] = []
        self.findings: tuple[Diagnostic, ...] = ()

    def touch(self, joints: Array) -> str:
        """The robot stands at the next point; says what is known then, and what to do next."""
        self.joints.append(joints)
        return self.told()

    def untouch(self) -> str:
        """Forget the last touch."""
        self.joints.pop()
        return self.told()

    def told(self) -> str:
        """What is known, and what to do next."""
        self.findings = ()
        missing = self.fewest - len(self.joints)
        if missing > 0:
            return f"{len(self.joints)} of {self.fewest}: {self.next_step()}, then .touch"
        text = self.result_text()
        return text or "not yet: see above; touch again, or .untouch the last one"

    @abstractmethod
    def next_step(self) -> str:
        """What to do before the next touch."""

    @abstractmethod
    def result_text(self) -> str:
        """What comes of the touches; empty, with `findings`, where nothing does."""


class TipTouching(Touching):
    """The tip of a tool, by touching one point with it several times."""

    fewest = FEWEST_TOUCHES
    value: TipCalibration | None = None

    def next_step(self) -> str:
        """A first touch, and others turned."""
        if not self.joints:
            return "bring the tool's tip to a fixed, pointed object"
        return "bring it to the same point again, tilted to another side by 20 deg or more"

    def result_text(self) -> str:
        """Where the tip is, and how well that is known."""
        found: Result[TipCalibration] = find_tip(flange_poses(self.robot.chain, np.array(self.joints)))
        self.findings, self.value = found.diagnostics, found.value
        if found.value is None:
            return ""
        tip, spread = found.value.flange_from_tip / MM, found.value.uncertainty / MM
        misses = found.value.misses / MM
        return (
            f"{len(misses)} touches: {{{self.name}}} is at {_numbers(tip)} mm in {{FLANGE}}, to {_numbers(spread)} mm; "
            f"the touches miss each other by {misses.mean():.3f} mm, touch {found.value.worst + 1} most, by {misses.max():.3f} mm\n"
            "  .done writes it; .touch adds another one"
        )


class FrameTouching(Touching):
    """A frame, by touching its origin, a point on its x axis and points of its plane.

    Args:
        robot: that touches.
        name: of the frame.
        flange_from_tip: (4, 4) what touches [m].
    """

    fewest = 3
    value: FrameCalibration | None = None

    def __init__(self, robot: Robot, name: str, flange_from_tip: Array) -> None:
        super().__init__(robot, name)
        self.flange_from_tip = flange_from_tip

    def next_step(self) -> str:
        """Which point comes next."""
        steps = (
            "bring the tip to the origin",
            "bring it to a point on the x axis, far out",
            "bring it to a point of the x-y plane on the side of y",
        )
        return steps[len(self.joints)]

    def result_text(self) -> str:
        """Where the frame is; of more than three points, how flat they lie."""
        points = tool_poses(self.robot.chain, np.array(self.joints), self.flange_from_tip)[:, :3, 3]
        found: Result[FrameCalibration] = find_frame(points[0], points[1], list(points[2:]))
        self.findings, self.value = found.diagnostics, found.value
        if found.value is None:
            return ""
        heights = np.abs(found.value.heights) / MM
        flat = (
            f"the points lie within {heights.max():.3f} mm of a plane"
            if len(points) > 3
            else "three points lie in every plane: a fourth one would show how exact it is"
        )
        return f"{{{self.name}}} is found; {flat}\n  .done writes it; .touch adds another point of the plane"


class HomeTouching(Touching):
    """The offsets of the motors, by bringing joints to their marks.

    Args:
        robot: whose.
        marks: the joint positions [rad or m] at the marks, by the joints' names.
    """

    value: OffsetCalibration | None = None

    def __init__(self, robot: Robot, marks: Mapping[str, float]) -> None:
        super().__init__(robot, ", ".join(marks))
        self.marks = marks

    def next_step(self) -> str:
        """To the marks."""
        return f"bring {self.name} to {'its mark' if len(self.marks) == 1 else 'their marks'}"

    def result_text(self) -> str:
        """How much the joints read wrongly today, and how well the marks repeat."""
        counts = [to_counts(self.robot, q) for q in self.joints]
        found = find_offsets(self.robot, counts, self.marks)
        self.findings, self.value = found.diagnostics, found.value
        if found.value is None:
            return ""
        shift, spread = (values / self.robot.axis_units for values in (found.value.shift, found.value.spread))
        lines = [
            f"{name} reads {-shift[at]:+.4f} {self.robot.axis_unit_names[at]} wrong"
            + (f", to {spread[at]:.4f} {self.robot.axis_unit_names[at]}" if len(self.joints) > 1 else "")
            for at, name in enumerate(self.robot.joint_names)
            if name in self.marks
        ]
        return "\n".join(
            [*lines, "  .done writes it; .touch again, approached anew, shows how well the mark repeats"]
        )


def _numbers(values: Array) -> str:
    return " ".join(f"{value:.3f}" for value in values + 0.0)
