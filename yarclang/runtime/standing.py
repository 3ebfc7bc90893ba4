"""Description of a robot's position, and of its distance from a job's start."""

from __future__ import annotations

import numpy as np

from yarclang.robot.model import Array, Robot
from yarclang.runtime.job import Job


def off_the_start(job: Job, joints: Array) -> str:
    """Return the distance of each joint from a job's start, in words; empty if all joints are near enough to
    it.

    Args:
        job: the job.
        joints: (n,) the robot's joint positions [rad or m].
    """
    robot = job.robot
    off = joints - job.start
    if (np.abs(off) <= job.slack).all():
        return ""
    parts = [
        f"{name} {value / unit:+.4f} {unit_name}"
        for name, value, allowed, unit, unit_name in zip(
            robot.joint_names, off, job.slack, robot.axis_units, robot.axis_unit_names, strict=True
        )
        if abs(value) > allowed
    ]
    return f"the robot doesn't stand where {job.name} starts: {', '.join(parts)}"


def described(robot: Robot, joints: Array) -> str:
    """Return joint positions for people: `J1 10.000 deg, ...`.

    Args:
        robot: the robot.
        joints: (n,) the positions [rad or m].
    """
    return ", ".join(
        f"{name} {value / unit:.3f} {unit_name}"
        for name, value, unit, unit_name in zip(
            robot.joint_names, joints, robot.axis_units, robot.axis_unit_names, strict=True
        )
    )
