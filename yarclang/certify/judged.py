"""What the judge compares with: the robot, the tolerances, and the planner's claims."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang import hir
from yarclang.certify.claims import Claims
from yarclang.certify.kinematics.arm import flange_poses
from yarclang.certify.motion.joint import by_kind
from yarclang.certify.motion.pose import distance
from yarclang.certify.read.layout import Place
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.units import DEG, MM

SAME_JOINTS = 1e-9
"""Largest allowed difference between a claimed joint position and the programmed joint goal [rad or m]."""
CHOSEN = 1e-3
"""Largest distance of joint positions that the planner has chosen for a pose from this pose [mm and deg]."""
NEARLY_KEPT = 5e-4
"""Largest loss of speed that counts as none, as a fraction of the programmed speed.

If the planner claims a speed that is lower by no more than this, the claim is ignored: the motion must reach
the programmed speed.
"""


def tolerance_of(motion: hir.Motion, tolerance: Tolerance) -> Tolerance:
    """Return the motion's own tolerance, or the general `tolerance` if it has none."""
    return tolerance.of_motion(motion.tolerance, leads_frame=motion.leads_frame)


@frozen
class Judged:
    """The robot, tolerances and claims with which the judge compares programmed paths with executed ones.

    Attributes:
        robot: the robot.
        tolerance: the general tolerance, for motions without their own.
        claims: the planner's claims.
        find: function that reports a finding, given its code, its message and the step concerned.
    """

    robot: Robot
    tolerance: Tolerance
    claims: Claims
    find: Callable[[str, str, int | None], None]

    def tolerance_of(self, motion: hir.Motion) -> Tolerance:
        """Return the motion's own tolerance, or the general one if it has none."""
        return tolerance_of(motion, self.tolerance)

    def share_of(self, step: int) -> float:
        """Return the fraction of its programmed speed that a motion must reach: the planner's claim, or 1."""
        return _share(self.claims.kept.get(step, 1.0))

    def least_of(self, step: int) -> float:
        """Return the fraction of its programmed speed below which a motion's speed must not fall after it has
        reached the fraction `share_of`.

        This is `share_of`, or the planner's claim `least` if that is smaller.
        """
        return min(self.share_of(step), _share(self.claims.least.get(step, 1.0)))


def _share(claimed: float) -> float:
    return claimed if 0.0 < claimed < 1.0 - NEARLY_KEPT else 1.0


def claimed_joints(judged: Judged, place: Place, count: int) -> Array | None:
    """Return the joint positions (count, n) that the planner claims for a motion.

    None if there is no claim of this shape.
    """
    claimed = judged.claims.witnesses.get(place.step)
    if claimed is None or claimed.shape != (count, judged.robot.size) or not np.isfinite(claimed).all():
        return None
    return claimed


def claimed_way(judged: Judged, place: Place) -> Array | None:
    """Return the waypoints (k, n) that the planner claims for a motion; None without a well-formed claim.

    An AvoidMove has as many waypoints as the planner claims, a SplineMove as many as are programmed.
    """
    motion = place.motion
    if isinstance(motion, hir.SplineMove):
        return claimed_joints(judged, place, len(motion.goals))
    claimed = judged.claims.witnesses.get(place.step)
    return claimed_joints(judged, place, max(len(claimed), 1) if claimed is not None and claimed.ndim else 1)


def check_claims(judged: Judged, place: Place) -> tuple[float, float]:
    """Compare the goals that the planner claims for a motion with the programmed ones.

    Differences beyond the tolerance are reported.

    Returns:
        The largest distance [m] and the largest angle [rad] between claimed and programmed goals; both
        infinite without a well-formed claim.
    """
    motion = place.motion
    assert isinstance(motion, hir.JointMove | hir.AvoidMove | hir.SplineMove)
    goals = motion.goals
    claimed = claimed_joints(judged, place, len(goals))
    if isinstance(motion, hir.AvoidMove) and (way := claimed_way(judged, place)) is not None:
        claimed = way[-1:]  # the waypoints in between are not programmed
    if claimed is None:
        shape = (len(goals), judged.robot.size)
        judged.find("Y1161", f"no joint positions of shape {shape} were given for its waypoints", place.step)
        return np.inf, np.inf
    worst = 0.0, 0.0
    flanges = flange_poses(judged.robot.chain, claimed)
    for i, goal in enumerate(goals):
        if isinstance(goal, hir.PoseGoal):
            position, angle = distance(flanges[i] @ goal.flange_from_moving, goal.base_from_moving)
            off = float(position), float(angle)
            allowed = CHOSEN * MM, CHOSEN * DEG
        else:
            assert isinstance(goal, hir.JointGoal)
            off = by_kind(np.abs(claimed[i] - goal.q), judged.robot)
            allowed = SAME_JOINTS, SAME_JOINTS
        if off[0] > allowed[0] or off[1] > allowed[1]:
            judged.find(
                "Y1161",
                f"the planned waypoint {i + 1} is {shown(*off)} away from the programmed one",
                place.step,
            )
        worst = max(worst[0], off[0]), max(worst[1], off[1])
    return worst


def shown(position: float, angle: float) -> str:
    """Return a distance [m] and an angle [rad] in words."""
    return f"{position / MM:.6g} mm and {angle / DEG:.6g} deg"
