"""Start points of the programmed paths.

A path starts at the programmed goal of the motion before it, whether the robot rests there or not, and the
first path at the program's start. A path never starts where the text's numbers lead: a small error there
could make a turn of nearly 180 deg go the other way round, and errors of relative motions would add up.
"""

from __future__ import annotations

from contextlib import suppress
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.certify.judged import CHOSEN, Judged, claimed_joints, claimed_way, shown
from yarclang.certify.kinematics.arm import flange_poses, poses_and_jacobians
from yarclang.certify.motion.pose import distance
from yarclang.certify.motion.programmed import goal_pose
from yarclang.certify.read.layout import BARRIERS, Layout, Place
from yarclang.certify.read.ways import Standing
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot
from yarclang.units import DEG, MM

_ROUNDS = 20
"""Largest number of iterations of Newton's method."""


@frozen(eq=False)
class Starts:
    """Start points of the programmed paths of P motions.

    Attributes:
        q: (P, n) joint positions [rad or m].
        flange: (P, 4, 4) flange poses in {B}.
        chosen: (P,) True for motions in joint space after a motion to a pose: their joint positions were
            chosen for the pose.
    """

    q: Array
    flange: Array
    chosen: NDArray[np.bool_]

    def take(self, rows: list[int]) -> Starts:
        """Return the start points of some motions."""
        return Starts(self.q[rows], self.flange[rows], self.chosen[rows])


@frozen(eq=False)
class _End:
    """The programmed end of a motion: flange pose and joint positions.

    The flange pose of a goal in joint space, and the joint positions of a pose, are None until they are
    needed.
    """

    flange: Array | None
    q: Array | None


def find_starts(judged: Judged, layout: Layout, program: hir.Program) -> Starts:
    """Find the start point of every motion's programmed path."""
    count = len(layout.places)
    q, flange = layout.begins.copy(), np.zeros((count, 4, 4))
    known, chosen = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    ends: list[_End] = []
    for row, (place, before) in enumerate(zip(layout.places, _before(layout, program), strict=True)):
        end = ends[before] if before >= 0 else _End(None, program.start)
        chosen[row] = end.flange is not None and not place.motion.leads_frame
        if end.q is None and end.flange is not None and not place.motion.leads_frame:
            end = _End(end.flange, _joints(judged, layout, row, before, end.flange))
        if end.q is not None:
            q[row] = end.q
        if end.flange is None and _is_relative_line(place.motion):
            end = _End(flange_poses(judged.robot.chain, q[row : row + 1])[0], end.q)
        if end.flange is not None:
            flange[row], known[row] = end.flange, True
        ends.append(_programmed_end(judged, place, q[row], flange[row]))
    flange[~known] = flange_poses(judged.robot.chain, q[~known])
    return Starts(q, flange, chosen)


def _is_relative_line(motion: hir.Motion) -> bool:
    return isinstance(motion, hir.LineMove) and isinstance(motion.goal, hir.PoseDelta)


def _before(layout: Layout, program: hir.Program) -> NDArray[np.int64]:
    """Return for each motion the row of the motion before it, on one of the ways that lead to it; -1 for the
    first motion of the program.
    """
    rows = {place.step: row for row, place in enumerate(layout.places)}
    found: list[int] = []
    standing = Standing(np.array([-1.0]))
    for number, step in enumerate(program.steps):
        if (row := rows.get(number)) is not None:
            found.append(int(standing.at[0]))
            standing.at = np.array([float(row)])
        elif (kind := BARRIERS.get(type(step))) is not None:
            with suppress(ValueError):  # the check of the text's flow reports it
                standing.pass_(kind)
    return np.array(found, dtype=np.int64)


def _programmed_end(judged: Judged, place: Place, q: Array, flange: Array) -> _End:
    """Return the exact programmed end of a motion.

    Args:
        judged: the context of the judgement.
        place: the motion.
        q: (n,) joint positions at the motion's start [rad or m].
        flange: (4, 4) flange pose at the motion's start; only relative motions of a frame need it.
    """
    match place.motion:
        case hir.JointMove(goal=hir.JointDelta(dq=dq)):
            return _End(None, q + dq)
        case hir.TimedMove(table=table):
            return _End(None, table.positions[-1])
        case hir.LineMove(goal=hir.PoseDelta() as goal):
            return _End(_flange_at(goal_pose(goal, flange)[1], goal.flange_from_moving), None)
    last = place.motion.goals[-1]
    if isinstance(last, hir.JointGoal):
        return _End(None, last.q)
    assert isinstance(last, hir.PoseGoal)
    # The goals of splines are claimed, and are compared with the program (`check_claims`).
    is_claimed = isinstance(place.motion, hir.SplineMove | hir.AvoidMove)
    claimed = claimed_way(judged, place) if is_claimed else None
    end = _flange_at(last.base_from_moving, last.flange_from_moving)
    return _End(end, None if claimed is None else claimed[-1])


def _flange_at(base_from_moving: Array, flange_from_moving: Array) -> Array:
    """Return the flange's pose (4, 4) in {B} when the moving frame is at `base_from_moving`."""
    pose: Array = base_from_moving @ _inverse(flange_from_moving.tobytes())
    return pose


@lru_cache(maxsize=16)
def _inverse(pose: bytes) -> Array:
    """Return the inverse (4, 4) of a pose (4, 4) given as bytes.

    Results are cached, since most motions of a program move the same frame.
    """
    inverse: Array = np.asarray(np.linalg.inv(np.frombuffer(pose).reshape(4, 4)), dtype=np.float64)
    return inverse


def _joints(judged: Judged, layout: Layout, row: int, before: int, flange: Array) -> Array:
    """Return the joint positions (n,) at which a motion in joint space begins, after a motion to a pose.

    These are the joint positions that the planner claims for the pose. Without a claim, they are the ones
    nearest to the text's.
    """
    ahead = layout.places[before]
    claimed = claimed_joints(judged, ahead, 1)
    if claimed is not None:
        position, angle = distance(flange_poses(judged.robot.chain, claimed)[0], flange)
        if position > CHOSEN * MM or angle > CHOSEN * DEG:
            judged.find(
                "Y1161",
                f"the joint positions planned for its end are {shown(float(position), float(angle))} away "
                "from the goal",
                ahead.step,
            )
        chosen: Array = claimed[0]
        return chosen
    return _nearest(judged.robot, layout.begins[row], flange)


def _nearest(robot: Robot, here: Array, flange: Array) -> Array:
    """Return joint positions (n,) that bring the flange to a pose (4, 4), by Newton's method from the joint
    positions `here`; return `here` if there are none near it.

    A wrong corner may make a proof fail, but it can't make a proof accept a wrong motion.
    """
    q = here
    for _ in range(_ROUNDS):
        found, jacobian = poses_and_jacobians(robot.chain, q[None], np.eye(4))
        # Compute the errors of position and orientation. The error of the orientation is a vector along the
        # axis of the rotation from one orientation to the other; its length is the sine of the angle. It
        # follows from the antisymmetric part of this rotation.
        turn = found[0, :3, :3] @ flange[:3, :3].T
        vee = np.array([turn[1, 2] - turn[2, 1], turn[2, 0] - turn[0, 2], turn[0, 1] - turn[1, 0]]) / 2.0
        error = np.concatenate([flange[:3, 3] - found[0, :3, 3], vee])
        if np.abs(error).max() < 1e-12:
            return np.asarray(q)
        # Newton step: find the change dq with J dq = error by least squares, with the Jacobian J. Small
        # singular values are cut, so that the step stays finite at a singular position.
        q = q + np.linalg.lstsq(jacobian[0], error, rcond=1e-9)[0]
    return here
