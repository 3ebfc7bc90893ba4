"""Deviation of every command from its programmed path, by the method for its kind of motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang import hir
from yarclang.certify.blends.flows import covered_by_balls, find_flows, speeds_asked
from yarclang.certify.blends.starts import Starts
from yarclang.certify.certificate import Deviation
from yarclang.certify.judged import Judged, check_claims, claimed_joints, claimed_way, shown
from yarclang.certify.kinematics.arm import flange_poses
from yarclang.certify.motion.frames import frame_moves, moving_frame
from yarclang.certify.motion.joint import JointLines, by_kind, frame_off, joint_weights, straight_deviations
from yarclang.certify.motion.pose import distance
from yarclang.certify.motion.proved import Proofs, law_of
from yarclang.certify.motion.spline import NaturalSpline, SplineBound, spline_deviation
from yarclang.certify.motion.timed import timed_move
from yarclang.certify.read.layout import Layout, Place, row_chunks
from yarclang.progress import go_on
from yarclang.robot.model import Array

Rows = list[tuple[int, Place]]


def find_deviations(judged: Judged, layout: Layout, starts: Starts) -> Proofs:
    """Bound the deviation of every step, and report each that is beyond the tolerance."""
    q, flanges = _ends(judged, layout, starts)
    covered = np.tile([0.0, 1.0], (len(layout.places), 1))
    proofs = Proofs(starts, find_flows(judged, layout, starts), covered)
    chosen: dict[type, Rows] = {kind: [] for kind in hir.Motion.__args__}
    for row, place in enumerate(layout.places):
        chosen[type(place.motion)].append((row, place))
    for rows in row_chunks(chosen[hir.JointMove]):
        _joint_moves(judged, layout, rows, (q, flanges), proofs)
    asked = speeds_asked(judged, layout, proofs.flows)
    for kind in (hir.LineMove, hir.ArcMove):
        for rows in row_chunks(chosen[kind]):
            frame_moves(judged, layout, rows, flanges, asked, proofs)
    for one in chosen[hir.PoseSplineMove]:
        go_on()
        frame_moves(judged, layout, [one], flanges, asked, proofs)
    for row, place in (*chosen[hir.SplineMove], *chosen[hir.AvoidMove]):
        go_on()
        proofs.deviations[place.step] = _spline_move(judged, layout, row, place, q[row], proofs)
    for row, place in chosen[hir.TimedMove]:
        go_on()
        proofs.deviations[place.step] = timed_move(judged, layout, row, place, proofs.starts.q[row])
    for place in layout.places:
        if not isinstance(place.motion, hir.TimedMove):
            _judge_deviation(judged, place, proofs.deviations[place.step])
    return proofs


def _ends(judged: Judged, layout: Layout, starts: Starts) -> tuple[Array, Array]:
    """Return the joint positions (P, n) [rad or m] and the flange poses (P, 4, 4) at the end of each motion.

    They are those of the text, except for a motion without moves in a chain: the robot is not at rest there.
    """
    flows, inside = False, list[int]()
    for row, place in enumerate(layout.places):
        if place.size:
            flows = place.behind is not None
        elif flows:
            inside.append(row)
    q, flanges = layout.ends.copy(), flange_poses(judged.robot.chain, layout.ends)
    q[inside], flanges[inside] = starts.q[inside], starts.flange[inside]
    return q, flanges


def _judge_deviation(judged: Judged, place: Place, deviation: Deviation) -> None:
    tolerance = judged.tolerance_of(place.motion)
    if deviation.end_position > tolerance.position or deviation.end_angle > tolerance.angle:
        judged.find(
            "Y1160",
            f"the motion ends {shown(deviation.end_position, deviation.end_angle)} from its goal; "
            f"{shown(tolerance.position, tolerance.angle)} are allowed (line {place.last_line})",
            place.step,
        )
    elif not (deviation.position <= tolerance.position and deviation.angle <= tolerance.angle):
        judged.find(
            "Y1159",
            f"the path deviation is proved only within {shown(deviation.position, deviation.angle)}; "
            f"{shown(tolerance.position, tolerance.angle)} are allowed",
            place.step,
        )


def _joint_moves(
    judged: Judged, layout: Layout, rows: Rows, reached: tuple[Array, Array], proofs: Proofs
) -> None:
    """Prove motions along straight lines in joint space; `reached` are the ends of all motions (`_ends`)."""
    robot, starts, flows, (stops, flanges) = judged.robot, proofs.starts, proofs.flows, reached
    goals, ends = [], []
    for row, place in rows:
        step = place.motion
        assert isinstance(step, hir.JointMove)
        end = stops[row]
        flows_on = place.behind is not None
        # The goal of a motion that flows on is not in the text, so the planner claims it. If the motion ends
        # at rest, its goal is its end in the text, which is compared with the programmed pose.
        if isinstance(step.goal, hir.PoseGoal) and flows_on:
            claimed = claimed_joints(judged, place, 1)
            ends.append(check_claims(judged, place))
            goals.append(end if claimed is None else claimed[0])
        elif isinstance(step.goal, hir.PoseGoal):
            position, angle = distance(
                flanges[row] @ step.goal.flange_from_moving, step.goal.base_from_moving
            )
            goals.append(end)
            ends.append((float(position), float(angle)))
        else:
            goal = step.goal.q if isinstance(step.goal, hir.JointGoal) else starts.q[row] + step.goal.dq
            goals.append(goal)
            ends.append((0.0, 0.0) if flows_on else by_kind(np.abs(end - goal), robot))
    control, following = [], []
    for row, _ in rows:
        begin, stop = flows.follow[row]
        following.append(bool(begin < stop) and not flows.is_cut(row))
        # A command without moves has one control point: the current position.
        control.append(layout.points_of(begin, stop) if following[-1] else stops[row : row + 1])
    first = np.cumsum([0, *(len(points) for points in control[:-1])])
    numbers = np.array([row for row, _ in rows])
    free = flows.free[numbers] & np.array(following)[:, None]
    lines = JointLines(starts.q[numbers], np.array(goals), free)
    joints, covered = straight_deviations(np.concatenate(control), first, lines, robot, judged.tolerance)
    weights = joint_weights(robot, judged.tolerance)
    for i, (row, place) in enumerate(rows):
        off, rest = joints[i], (0.0, 0.0)
        proofs.covered[row] = covered[i]
        if place.before is not None or place.behind is not None:
            proofs.curves[row] = NaturalSpline.through(np.stack([starts.q[row], goals[i]]))
            begin, stop = flows.follow[row]
            # The blends cover the whole motion.
            if place.size and begin == stop:
                off, proofs.covered[row] = np.zeros_like(off), covered_by_balls(flows.free[row])
            elif flows.is_cut(row) or (off * weights).max() > 1.0:
                # Control points next to a blend may be off a line that the motion itself follows: prove the
                # motion as a spline.
                bound = _along_spline(judged, layout, row, np.stack([starts.q[row], goals[i]]), proofs)
                off, rest = bound.deviation, by_kind(bound.remainder, robot)
                proofs.covered[row] = bound.covered
        slide, turn = by_kind(off, robot)
        slide = max(slide, _frame_off(judged, layout, place, off))
        end = ends[i]
        deviation = Deviation(max(slide, end[0]), max(turn, end[1]), *end, *rest)
        proofs.deviations[place.step] = deviation


def _frame_off(judged: Judged, layout: Layout, place: Place, off: Array) -> float:
    """Bound the deviation of the moving frame [m] in a joint motion that has a tolerance of its own.

    The bound is zero for other motions.
    """
    motion = place.motion
    if motion.tolerance is None or not place.size or not np.isfinite(off).all():
        return 0.0
    # A joint position is a convex combination of control points, so it is no farther from zero than the
    # farthest of them.
    travel = np.abs(layout.points(place)).max(axis=0)
    return frame_off(off, moving_frame(motion), travel, judged.robot)


def _along_spline(judged: Judged, layout: Layout, row: int, points: Array, proofs: Proofs) -> SplineBound:
    """Prove the segments that follow a natural spline through `points` (m, n) in joint space."""
    flows = proofs.flows
    place = layout.places[row]
    begin, stop = (int(x) for x in flows.follow[row])
    claimed = None if flows.is_cut(row) else law_of(judged, place)
    law = None
    if claimed is not None:
        # Take the claimed values of the segments that follow the path.
        # Segment k of a uniform cubic B-spline depends on the control values k to k + 3.
        skip = begin - place.first - claimed[1]
        law = claimed[0][skip : skip + stop - begin + 3]
    free = bool(flows.free[row, 0]), bool(flows.free[row, 1])
    weights = joint_weights(judged.robot, judged.tolerance)
    return spline_deviation(flows.cubics(layout, row), points, weights, law, free)


def _spline_move(
    judged: Judged, layout: Layout, row: int, place: Place, end: Array, proofs: Proofs
) -> Deviation:
    """Prove a spline in joint space that ends at the joint positions `end` (n,) [rad or m]."""
    robot, start = judged.robot, proofs.starts.q[row]
    step = place.motion
    assert isinstance(step, hir.SplineMove | hir.AvoidMove)
    off_position, off_angle = check_claims(judged, place)
    witness = claimed_way(judged, place)
    if witness is None:
        return Deviation(np.inf, np.inf, 0.0, 0.0)
    end_position, end_angle = by_kind(np.abs(end - witness[-1]), robot)
    if place.behind is not None:
        end_position, end_angle = 0.0, 0.0
    points = np.concatenate([start[None], witness])
    if place.before is not None or place.behind is not None:
        proofs.curves[row] = NaturalSpline.through(points)
    begin, stop = proofs.flows.follow[row]
    if begin < stop:
        bound = _along_spline(judged, layout, row, points, proofs)
        position, angle = by_kind(bound.deviation, robot)
        position = max(position, _frame_off(judged, layout, place, bound.deviation))
        rest = by_kind(bound.remainder, robot)
        proofs.covered[row] = bound.covered
    elif place.size:
        position, angle, rest = 0.0, 0.0, (0.0, 0.0)
        proofs.covered[row] = covered_by_balls(proofs.flows.free[row])
    else:
        position, angle = by_kind(np.abs(points - end).max(axis=0), robot)
        rest = 0.0, 0.0
    deviation = Deviation(position, angle, end_position, end_angle, *rest)
    return replace(
        deviation,
        position=max(position, end_position, off_position),
        angle=max(angle, end_angle, off_angle),
    )
