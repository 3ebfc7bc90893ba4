"""Collect the touches of a calibration, compute its result, and tell the user the next step. This module
moves no robot.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from yarclang.calibration.frame import FrameCalibration, find_frame
from yarclang.calibration.home import OffsetCalibration, find_offsets
from yarclang.calibration.spread import ERROR, touch_error
from yarclang.calibration.tool import FEWEST_TOUCHES, TipCalibration, find_tip
from yarclang.diagnostics import Diagnostic
from yarclang.robot.actuation import to_counts
from yarclang.robot.kinematics.fk import flange_poses, tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.units import MM


class Touching(ABC):
    """A calibration in progress: the touches so far, and their result.

    Args:
        robot: the robot that touches.
        name: name of the calibrated object, such as a tool or a frame.

    Attributes:
        fewest: least number of touches for a result.
        joints: joint positions (n,) at each touch [rad or m].
        findings: findings about the touches so far.
    """

    fewest = 1
    named: tuple[str, ...] = ()
    """Names of the first touches, if each of them has a meaning of its own, such as `origin`."""

    def __init__(self, robot: Robot, name: str) -> None:
        self.robot = robot
        self.name = name
        self.joints: list[Array] = []
        self.findings: tuple[Diagnostic, ...] = ()

    def touch(self, joints: Array, at: int | None = None) -> None:
        """Add or replace a touch.

        Args:
            joints: (n,) joint positions of the robot [rad or m].
            at: index of the touch to replace; None to add a touch.
        """
        if at is None:
            self.joints.append(joints)
        else:
            self.joints[at] = joints
        self.solve()

    def can_go(self, at: int) -> bool:
        """Return True if the touch with index `at` can be removed.

        A touch with a meaning of its own (`named`), such as the origin of a frame, can be removed only if it
        is the last touch. Otherwise the next touch would get its meaning.
        """
        return at >= len(self.named) or at == len(self.joints) - 1

    def untouch(self, at: int = -1) -> None:
        """Remove a touch for which `can_go` is true, by default the last one."""
        self.joints.pop(at)
        self.solve()

    def error(self) -> float:
        """Return the error of one touch [m]: an estimate from the touches, or an assumed value."""
        return ERROR

    @property
    def missing(self) -> int:
        """Number of touches that are still needed."""
        return max(0, self.fewest - len(self.joints))

    def solve(self) -> None:
        """Compute the result of the touches, and update `findings`."""
        self.findings = ()
        self.forget()
        if not self.missing:
            self.find()

    @abstractmethod
    def forget(self) -> None:
        """Discard the result of the calibration."""

    @abstractmethod
    def find(self) -> None:
        """Compute the result of the calibration. There must be enough touches."""

    @abstractmethod
    def next_step(self) -> str:
        """Return the instruction for the next touch."""

    @abstractmethod
    def result_text(self) -> str:
        """Return the result in words; empty if there is none."""

    @abstractmethod
    def residuals(self) -> Array | None:
        """Return the residuals of all touches (k,): distances in mm, but angles in deg for a revolute joint.
        None if there is no result.
        """


class TipTouching(Touching):
    """Calibration of the tip of a tool, by touching one point several times."""

    fewest = FEWEST_TOUCHES
    value: TipCalibration | None = None

    def poses(self) -> Array:
        """Return the poses of the flange (k, 4, 4) [m]."""
        return flange_poses(self.robot.chain, np.array(self.joints).reshape(-1, self.robot.size))

    def forget(self) -> None:
        """Discard the tip."""
        self.value = None

    def error(self) -> float:
        """Return the error of one touch [m], estimated from the misses."""
        return ERROR if self.value is None else self.value.error

    def find(self) -> None:
        """Compute the tip."""
        found = find_tip(self.poses())
        self.findings, self.value = found.diagnostics, found.value

    def next_step(self) -> str:
        """Return the instruction for the first touch, or for a touch with a tilted tool."""
        if not self.joints:
            return "move the tool's tip to a fixed, pointed object"
        return "move it to the same point again, tilted in another direction by 20 deg or more"

    def result_text(self) -> str:
        """Return the position of the tip and its uncertainty, in words."""
        if self.value is None:
            return ""
        tip, spread = self.value.flange_from_tip / MM, self.value.uncertainty / MM
        misses = self.value.misses / MM
        return (
            f"{len(misses)} touches: {{{self.name}}} is at {_numbers(tip)} mm in {{FLANGE}}, to "
            f"{_numbers(spread)} mm (95 %); the touches disagree by {misses.mean():.3f} mm, touch "
            f"{self.value.worst + 1} most, by {misses.max():.3f} mm"
        )

    def residuals(self) -> Array | None:
        """Return the distance of the tip from the fixed point at each touch (k,) [mm]."""
        return None if self.value is None else self.value.misses / MM


class FrameTouching(Touching):
    """Calibration of a frame, by touching its origin, a point on its x axis and points of its plane.

    Args:
        robot: the robot that touches.
        name: name of the frame.
        flange_from_tip: (4, 4) pose of the tip that touches the points [m].
    """

    fewest = 3
    named = ("origin", "point on x")
    value: FrameCalibration | None = None

    def __init__(self, robot: Robot, name: str, flange_from_tip: Array) -> None:
        super().__init__(robot, name)
        self.flange_from_tip = flange_from_tip

    def points(self) -> Array:
        """Return the touched points (k, 3) in {B} [m]."""
        joints = np.array(self.joints).reshape(-1, self.robot.size)
        return tool_poses(self.robot.chain, joints, self.flange_from_tip)[:, :3, 3]

    def error(self) -> float:
        """Return the error of one touched point [m], estimated from the points' distances to the plane."""
        if self.value is None:
            return ERROR
        return touch_error(float(np.sum(self.value.heights**2)), len(self.joints) - self.fewest)

    def forget(self) -> None:
        """Discard the frame."""
        self.value = None

    def find(self) -> None:
        """Compute the frame."""
        points = self.points()
        found = find_frame(points[0], points[1], list(points[2:]))
        self.findings, self.value = found.diagnostics, found.value

    def next_step(self) -> str:
        """Return the instruction for the next point."""
        steps = (
            "move the tip to the origin",
            "move it to a point on the x axis, far from the origin",
            "move it to a point of the x-y plane on the side of y",
        )
        return (
            steps[len(self.joints)]
            if self.missing
            else "move it to another point of the x-y plane on the side of y"
        )

    def result_text(self) -> str:
        """Return the result in words, with the flatness of more than three points."""
        if self.value is None:
            return ""
        heights = np.abs(self.value.heights) / MM
        flat = (
            f"the points lie within {heights.max():.3f} mm of a plane"
            if len(self.joints) > self.fewest
            else "three points always lie in a plane: a fourth point would show the error"
        )
        return f"{{{self.name}}} is found; {flat}"

    def residuals(self) -> Array | None:
        """Return the distance of each point from the plane (k,) [mm]; None for three points."""
        if self.value is None or len(self.joints) <= self.fewest:
            return None
        # The height of the origin is zero, because the plane goes through the origin.
        heights: Array = np.abs(self.value.heights) / MM
        return heights


class HomeTouching(Touching):
    """Calibration of the motors' offsets, by moving joints to their marks.

    Args:
        robot: the robot.
        marks: joint positions at the marks [rad or m], by the joints' names.
    """

    value: OffsetCalibration | None = None

    def __init__(self, robot: Robot, marks: Mapping[str, float]) -> None:
        super().__init__(robot, ", ".join(marks))
        self.marks = marks

    def forget(self) -> None:
        """Discard the offsets."""
        self.value = None

    def find(self) -> None:
        """Compute the offsets."""
        found = find_offsets(self.robot, [to_counts(self.robot, q) for q in self.joints], self.marks)
        self.findings, self.value = found.diagnostics, found.value

    def next_step(self) -> str:
        """Return the instruction to move the joints to their marks."""
        marks = "its mark" if len(self.marks) == 1 else "their marks"
        return f"move {self.name} to {marks}{', approached anew' if self.joints else ''}"

    def result_text(self) -> str:
        """Return, in words, the errors of the joint positions as the robot indicates them now, and the
        repeatability of the marks.
        """
        if self.value is None:
            return ""
        shift, spread = (values / self.robot.axis_units for values in (self.value.shift, self.value.spread))
        return "\n".join(
            f"the reading of {name} is off by {-shift[at]:+.4f} {self.robot.axis_unit_names[at]}"
            + (
                f"; its approaches differ from their mean by {spread[at]:.4f} "
                f"{self.robot.axis_unit_names[at]} at most"
                if len(self.joints) > 1
                else ""
            )
            for at, name in enumerate(self.robot.joint_names)
            if name in self.marks
        )

    def residuals(self) -> Array | None:
        """Return the residual of each visit of the marks, (k,) [deg or mm]: the distance from the mean of all
        visits, for the joint whose visits differ most.

        The result is None after a single visit.
        """
        if self.value is None or len(self.joints) < 2:
            return None
        marked = np.array([name in self.marks for name in self.robot.joint_names])
        visits = np.array(self.joints) / self.robot.axis_units
        apart: Array = np.abs((visits - visits.mean(axis=0))[:, marked]).max(axis=1)
        return apart


def _numbers(values: Array) -> str:
    return " ".join(f"{value:.3f}" for value in values + 0.0)
