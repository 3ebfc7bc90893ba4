"""Find a joint near its limit at a target."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from yarclang.findings import Finding
from yarclang.hir import Array, Motion
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.robot.model import Limits

NEAR = 2.0
"""Distance from a limit below which there is a remark [deg or mm]."""


def _look(plan: MotionPlan, around: Surroundings) -> Iterator[Remark]:
    robot = around.robot
    limits, units = robot.limits, robot.axis_units
    for motion in _near(plan.motions, limits, units):
        room = np.minimum(motion.waypoints - limits.lower, limits.upper - motion.waypoints) / units
        at, joint = np.unravel_index(int(np.argmin(room)), room.shape)
        step = plan.program.steps[motion.step]
        assert isinstance(step, Motion)
        unit = robot.axis_unit_names[joint]
        which = f"waypoint {at + 1}" if len(motion.waypoints) > 1 else "the target"
        message = (
            f"{which} moves {robot.joint_names[joint]} to {motion.waypoints[at, joint] / units[joint]:.4g} "
            f"{unit}, {max(0.0, room[at, joint]):.2g} {unit} from its limit"
        )
        help_ = "choose another configuration (NEAR), or another place for the part"
        yield remark_at(step.origin, message, help_)


def _near(motions: Sequence[PlannedMotion], limits: Limits, units: Array) -> Iterator[PlannedMotion]:
    """Yield the motions with a waypoint near a joint limit. All waypoints are compared in one array."""
    if not motions:
        return
    q = np.concatenate([motion.waypoints for motion in motions])
    owners = np.repeat(np.arange(len(motions)), [len(motion.waypoints) for motion in motions])
    near = (np.minimum(q - limits.lower, limits.upper - q) / units).min(axis=1) < NEAR
    for row in np.unique(owners[near]).tolist():
        yield motions[row]


RULE = Rule(
    Finding(
        "Y0506",
        "near-joint-limit",
        "note",
        "a joint comes within 2 deg (or mm) of its limit at a target",
        "The program works now. But after a small correction of the target, the pose may be refused, or the "
        "arm may take another configuration. On the machine, the limit switch may be slightly closer than "
        "robot.toml states.",
        "P0010 MOVEJ 169 0 0 0 0 0 [50%] (deg)",
        "P0010 MOVEJ 160 0 0 0 0 0 [50%] (deg)",
    ),
    MotionPlan,
    _look,
    valid=("P0010 MOVEJ 167.9 0 0 0 0 0 [50%] (deg)", "P0010 STOP"),
    invalid=(
        "P0010 MOVEJ 168.1 0 0 0 0 0 [50%] (deg)",
        "P0010 MOVEJ_SPLINE 100 0 0 0 0 0; 169 5 0 0 0 0; 100 0 0 0 20 0 [30] (deg,s)",
    ),
)
