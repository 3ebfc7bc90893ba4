"""Start point of each motion's programmed path.

A path starts at the current position, or at the programmed end of the motion that flows into it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from yarclang import hir
from yarclang.certify.claims import Claims
from yarclang.certify.kinematics.arm import flange_poses, poses_and_jacobians
from yarclang.certify.motion.joint import by_kind
from yarclang.certify.motion.pose import distance
from yarclang.certify.motion.programmed import goal_pose
from yarclang.certify.read.layout import Layout, Place
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.units import DEG, MM

SAME_JOINTS = 1e-9
"""Largest allowed difference between a claimed joint position and the programmed joint goal [rad or m]."""
CHOSEN = 1e-3
"""Largest distance of joint positions that the planner has chosen for a pose from this pose [mm and deg]. The
next path begins there, and could amplify a larger distance.
"""
AT_REST = 0.1
"""Largest distance from the goal at which a motion may come to rest, as a fraction of the tolerance."""
_ROUNDS = 20
"""Largest number of iterations of Newton's method."""
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


@frozen(eq=False)
class Starts:
    """Start points of the programmed paths of P motions.

    Attributes:
        q: (P, n) joint positions [rad or m].
        flange: (P, 4, 4) flange poses in {B}.
    """

    q: Array
    flange: Array


@frozen(eq=False)
class _End:
    """The programmed end of a motion: flange pose and joint positions.

    The joint positions of a Cartesian motion are None until they are needed.
    """

    flange: Array
    q: Array | None


def find_starts(judged: Judged, layout: Layout, flanges: Array) -> Starts:
    """Find the start point of every motion's programmed path.

    Args:
        judged: the context of the judgement.
        layout: the commands of the controller text.
        flanges: (P, 4, 4) flange poses at the joint positions `layout.begins`.
    """
    q, flange = layout.begins.copy(), flanges.copy()
    end: _End | None = None
    ahead: tuple[int, Place] | None = None
    for row, place in enumerate(layout.places):
        # If the motion before flows into this one, or if this one does not move, it begins at the exact
        # programmed end of the motion before.
        if end is not None and (place.before is not None or place.size == 0):
            flange[row] = end.flange
            if end.q is None and not place.motion.leads_frame:
                assert ahead is not None
                end = _End(end.flange, _joints(judged, layout, *ahead, end.flange))
            if end.q is not None:
                q[row] = end.q
        if place.behind is not None or (place.size == 0 and end is not None):
            end, ahead = _programmed_end(judged, place, q[row], flange[row]), (row, place)
        elif place.size:
            end = None
    return Starts(q, flange)


def _programmed_end(judged: Judged, place: Place, q: Array, flange: Array) -> _End:
    """Return the exact programmed end of a motion.

    Args:
        judged: the context of the judgement.
        place: the motion.
        q: (n,) joint positions at the motion's start [rad or m].
        flange: (4, 4) flange pose at the motion's start.
    """
    motion, chain = place.motion, judged.robot.chain
    match motion:
        case hir.JointMove(goal=hir.JointGoal(q=goal)):
            end = goal
        case hir.JointMove(goal=hir.JointDelta(dq=dq)):
            end = q + dq
        case hir.JointMove(goal=hir.PoseGoal()):
            claimed = claimed_joints(judged, place, 1)
            end = q if claimed is None else claimed[0]
        case hir.TimedMove(table=table):
            end = table.positions[-1]
        case hir.SplineMove():
            claimed = claimed_joints(judged, place, len(motion.goals))
            end = q if claimed is None else claimed[-1]
        case hir.AvoidMove():
            claimed = claimed_way(judged, place)
            end = q if claimed is None else claimed[-1]
        case hir.LineMove(goal=goal) | hir.ArcMove(goal=goal):
            # The goal is a pose of the moving frame: base_from_flange = base_from_moving moving_from_flange.
            return _End(goal_pose(goal, flange)[1] @ _inverse(goal.flange_from_moving.tobytes()), None)
        case hir.PoseSplineMove(waypoints=waypoints):
            last = waypoints[-1]
            return _End(last.base_from_moving @ _inverse(last.flange_from_moving.tobytes()), None)
    return _End(flange_poses(chain, end[None])[0], end)


@lru_cache(maxsize=16)
def _inverse(pose: bytes) -> Array:
    """Return the inverse (4, 4) of a pose (4, 4) given as bytes.

    Results are cached, since most motions of a program move the same frame.
    """
    inverse: Array = np.asarray(np.linalg.inv(np.frombuffer(pose).reshape(4, 4)), dtype=np.float64)
    return inverse


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


def _joints(judged: Judged, layout: Layout, row: int, place: Place, flange: Array) -> Array:
    """Return the joint positions (n,) at the end of a Cartesian motion.

    These are the joint positions that the planner claims. Without a claim, they are the ones nearest to the
    joint positions in the middle of the blend.
    """
    claimed = claimed_joints(judged, place, 1)
    if claimed is not None:
        position, angle = distance(flange_poses(judged.robot.chain, claimed)[0], flange)
        if position > CHOSEN * MM or angle > CHOSEN * DEG:
            judged.find(
                "Y1161",
                f"the joint positions planned for its end are {shown(float(position), float(angle))} away "
                "from the goal",
                place.step,
            )
        end: Array = claimed[0]
        return end
    return _nearest(judged.robot, layout.ends[row], flange)


def _nearest(robot: Robot, q: Array, flange: Array) -> Array:
    """Return joint positions (n,) that bring the flange to a pose (4, 4), by Newton's method from `q`.

    The result need not be exact: a wrong corner may make a proof fail, but it can't make a proof accept a
    wrong motion.
    """
    for _ in range(_ROUNDS):
        here, jacobian = poses_and_jacobians(robot.chain, q[None], np.eye(4))
        # Compute the errors of position and orientation. The error of the orientation is a vector along the
        # axis of the rotation from one orientation to the other; its length is the sine of the angle. It
        # follows from the antisymmetric part of this rotation.
        turn = here[0, :3, :3] @ flange[:3, :3].T
        vee = np.array([turn[1, 2] - turn[2, 1], turn[2, 0] - turn[0, 2], turn[0, 1] - turn[1, 0]]) / 2.0
        error = np.concatenate([flange[:3, 3] - here[0, :3, 3], vee])
        # Newton step: find the change dq with J dq = error by least squares, with the Jacobian J. Small
        # singular values are cut, so that the step stays finite at a singular position.
        q = q + np.linalg.lstsq(jacobian[0], error, rcond=1e-9)[0]
        if np.abs(error).max() < 1e-12:
            break
    return np.asarray(q)


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
