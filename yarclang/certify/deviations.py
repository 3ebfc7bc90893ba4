"""How far every command is from what it asks for: each kind of motion by its own proof."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from yarclang import hir
from yarclang.certify.bounds import Cubics
from yarclang.certify.cartesian import Followed, Stretch, follow
from yarclang.certify.certificate import Deviation, ToolSpeed
from yarclang.certify.corner import Judged, Starts, check_claims, claimed_joints, find_starts, shown
from yarclang.certify.flows import Flows, cruise, find_flows, speeds_around
from yarclang.certify.joint import JointLines, by_kind, joint_weights, straight_deviations
from yarclang.certify.layout import Layout, Place, row_chunks
from yarclang.certify.pose import distance
from yarclang.certify.posespline import PoseSpline
from yarclang.certify.programmed import Arcs, FramePaths, Lines, goal_pose
from yarclang.certify.speed import Programmed
from yarclang.certify.spline import NaturalSpline, SplineBound, spline_deviation
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Array

Rows = list[tuple[int, Place]]

STILL = 1e-9
"""The origin of a frame that goes no farther than this [m] stands still: its speed is that of the turn."""


@dataclass(slots=True, eq=False)
class Proofs:
    """What was proved of every motion, and about which path: by the motion's number among the motions, but `deviations` and
    `speeds` by its step.

    `frames` are paths of moving frames, each one of several; `curves` those in joint space. `covered` (P, 2) are the shares
    of the paths between which they were followed.
    """

    starts: Starts
    flows: Flows
    covered: Array
    deviations: dict[int, Deviation] = field(default_factory=dict)
    speeds: dict[int, ToolSpeed] = field(default_factory=dict)
    frames: dict[int, tuple[FramePaths, int]] = field(default_factory=dict)
    curves: dict[int, NaturalSpline] = field(default_factory=dict)


def find_deviations(judged: Judged, layout: Layout) -> Proofs:
    """A bound for every step, and a finding for each that is beyond the tolerance."""
    count = len(layout.places)
    poses = flange_poses(judged.robot.chain, np.concatenate([layout.begins, layout.ends]))
    starts, flanges = find_starts(judged, layout, poses[:count]), poses[count:]
    covered = np.tile([0.0, 1.0], (count, 1))
    proofs = Proofs(starts, find_flows(judged, layout, starts), covered)
    chosen: dict[type, Rows] = {kind: [] for kind in hir.Motion.__args__}
    for row, place in enumerate(layout.places):
        chosen[type(place.motion)].append((row, place))
    for rows in row_chunks(chosen[hir.JointMove]):
        _joint_moves(judged, layout, rows, flanges, proofs)
    around = speeds_around(layout, proofs.flows)
    for kind in (hir.LineMove, hir.ArcMove):
        for rows in row_chunks(chosen[kind]):
            _frame_moves(judged, layout, rows, flanges, around, proofs)
    for one in chosen[hir.PoseSplineMove]:
        _frame_moves(judged, layout, [one], flanges, around, proofs)
    for row, place in chosen[hir.SplineMove]:
        proofs.deviations[place.step] = _spline_move(judged, layout, row, place, proofs)
    for place in layout.places:
        _judge_deviation(judged, place, proofs.deviations[place.step])
    return proofs


def _judge_deviation(judged: Judged, place: Place, deviation: Deviation) -> None:
    tolerance = judged.tolerance_of(place.motion)
    if deviation.end_position > tolerance.position or deviation.end_angle > tolerance.angle:
        judged.find(
            "Y1160",
            f"the motion ends {shown(deviation.end_position, deviation.end_angle)} from its goal, "
            f"allowed are {shown(tolerance.position, tolerance.angle)} (line {place.last_line})",
            place.step,
        )
    elif not (deviation.position <= tolerance.position and deviation.angle <= tolerance.angle):
        judged.find(
            "Y1159",
            f"the path is proved within {shown(deviation.position, deviation.angle)}, allowed are "
            f"{shown(tolerance.position, tolerance.angle)}",
            place.step,
        )


def _joint_moves(judged: Judged, layout: Layout, rows: Rows, flanges: Array, proofs: Proofs) -> None:
    robot, starts, flows = judged.robot, proofs.starts, proofs.flows
    goals, ends = [], []
    for row, place in rows:
        step = place.motion
        assert isinstance(step, hir.JointMove)
        end = layout.ends[row]
        flows_on = place.behind is not None
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
            off = np.abs((end if place.size else starts.q[row]) - goal)
            ends.append((0.0, 0.0) if flows_on else by_kind(off, robot))
    control, following = [], []
    for row, _ in rows:
        begin, stop = flows.follow[row]
        following.append(bool(begin < stop) and not flows.is_cut(row))
        # a command without moves is one control point: where the robot stands
        control.append(layout.points_of(begin, stop) if following[-1] else starts.q[row : row + 1])
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
            if place.size and begin == stop:
                off, proofs.covered[row] = np.zeros_like(off), 0.5
            elif flows.is_cut(row) or (off * weights).max() > 1.0:
                # control points next to a blend may be off a line that the motion itself keeps to
                bound = _along_spline(judged, layout, row, np.stack([starts.q[row], goals[i]]), proofs)
                off, rest = bound.deviation, by_kind(bound.remainder, robot)
                proofs.covered[row] = bound.covered
        slide, turn = by_kind(off, robot)
        end = ends[i]
        deviation = Deviation(max(slide, end[0]), max(turn, end[1]), *end, *rest)
        proofs.deviations[place.step] = deviation


def _frame_moves(
    judged: Judged, layout: Layout, rows: Rows, flanges: Array, around: Array, proofs: Proofs
) -> None:
    """Motions of one kind along paths of the moving frame."""
    moving = [(row, place) for row, place in rows if place.size]
    for row, place in rows:
        if not place.size:
            _stays(place, proofs.starts.flange[row], proofs)
    if not moving:
        return
    numbers = np.array([row for row, _ in moving])
    paths = _paths(moving, proofs)
    ends = distance(flanges[numbers] @ paths.flange_from_moving, paths.goal)
    stretch = _stretch(judged, layout, moving, paths, around, proofs)
    found = None
    single = len(moving) == 1 and not proofs.flows.is_cut(moving[0][0])
    law = _law(judged, moving[0][1]) if single else None
    if law is not None:
        found = follow(stretch, paths, judged.robot, law)
    if found is None or found.position[0] > stretch.tolerance[0] or found.angle[0] > stretch.angle:
        found = follow(stretch, paths, judged.robot)
    proofs.covered[numbers] = found.covered
    for i, (row, place) in enumerate(moving):
        proofs.frames[row] = paths, i
        end = (0.0, 0.0) if place.behind is not None else (float(ends[0][i]), float(ends[1][i]))
        proofs.deviations[place.step] = Deviation(
            max(float(found.position[i]), end[0]),
            max(float(found.angle[i]), end[1]),
            *end,
            float(found.rest[i]),
            float(found.angle_rest[i]),
        )
        proofs.speeds[place.step] = _tool_speed(found, i)


def _stays(place: Place, flange: Array, proofs: Proofs) -> None:
    """A motion without moves must have nowhere to go."""
    step = place.motion
    if isinstance(step, hir.LineMove):
        goals = [goal_pose(step.goal, flange)[1]]
        frame = step.goal.flange_from_moving
    elif isinstance(step, hir.ArcMove):
        goals, frame = [step.goal.base_from_moving], step.goal.flange_from_moving
    else:
        assert isinstance(step, hir.PoseSplineMove)
        goals = [goal.base_from_moving for goal in step.waypoints]
        frame = step.waypoints[0].flange_from_moving
    here = flange @ frame
    position, angle = (float(far.max()) for far in distance(here[None], np.array(goals)))
    if isinstance(step, hir.ArcMove):
        position = max(position, float(np.linalg.norm(here[:3, 3] - step.via)))
    end_position, end_angle = (float(far) for far in distance(here, goals[-1]))
    proofs.deviations[place.step] = Deviation(position, angle, end_position, end_angle)


def _paths(moving: Rows, proofs: Proofs) -> FramePaths:
    starts, goals, frames, vias = [], [], [], []
    for row, place in moving:
        step, flange = place.motion, proofs.starts.flange[row]
        if isinstance(step, hir.PoseSplineMove):
            frame = step.waypoints[0].flange_from_moving
            through = np.array([flange @ frame, *(goal.base_from_moving for goal in step.waypoints)])
            free = proofs.flows.free[row]
            spline = PoseSpline.through(through, frame, (bool(free[0]), bool(free[1])))
            return spline or Lines.between(through[:1], through[-1:], frame[None])
        assert isinstance(step, hir.LineMove | hir.ArcMove)
        start, goal = goal_pose(step.goal, flange)
        starts.append(start)
        goals.append(goal)
        frames.append(step.goal.flange_from_moving)
        if isinstance(step, hir.ArcMove):
            vias.append(step.via)
    if vias:
        return Arcs.through(np.array(starts), np.array(vias), np.array(goals), np.array(frames))
    return Lines.between(np.array(starts), np.array(goals), np.array(frames))


def _stretch(
    judged: Judged, layout: Layout, moving: Rows, paths: FramePaths, around: Array, proofs: Proofs
) -> Stretch:
    numbers = np.array([row for row, _ in moving])
    flows = proofs.flows
    whole = flows.whole[numbers]
    rows_of = np.concatenate([np.arange(begin, stop) for begin, stop in whole])
    cubics = Cubics.of_spline(layout.control, layout.at[rows_of], layout.time[rows_of])
    sizes = whole[:, 1] - whole[:, 0]
    first = np.cumsum(sizes) - sizes
    follows = flows.follow[numbers] - whole[:, :1]
    for i, row in enumerate(numbers):
        if flows.is_cut(row):
            cubics = flows.cut(cubics, row, int(first[i]), int(first[i] + sizes[i]) - 1)
    count = len(moving)
    own = np.arange(count)
    reach = paths.bounds(own, np.zeros(count), np.ones(count)).position[:, 0]
    turns = reach < STILL
    speeds = np.array([cruise(place) for _, place in moving])
    wanted = Programmed(
        np.where(turns, speeds[:, 1], speeds[:, 0]),
        turns,
        np.where(turns[:, None], np.inf, around[numbers]),
    )
    tolerances = np.array([judged.tolerance_of(place.motion).position for _, place in moving])
    return Stretch(
        cubics,
        first,
        follows + first[:, None],
        proofs.flows.free[numbers],
        tolerances,
        judged.tolerance.angle,
        wanted,
    )


def _law(judged: Judged, place: Place) -> tuple[Array, int] | None:
    """A claimed law that covers all of the command, with half of each blend's segments on either side."""
    law = judged.laws.get(place.step)
    lead, trail = (place.before or 0) // 2, (place.behind or 0) // 2
    if law is None or law.shape != (place.size + lead + trail + 3,) or not np.isfinite(law).all():
        return None
    return law, -lead


def _along_spline(judged: Judged, layout: Layout, row: int, points: Array, proofs: Proofs) -> SplineBound:
    """The proof for a natural spline through `points` (m, n), of what follows it."""
    flows = proofs.flows
    place = layout.places[row]
    begin, stop = (int(x) for x in flows.follow[row])
    claimed = None if flows.is_cut(row) else _law(judged, place)
    law = None
    if claimed is not None:
        skip = begin - place.first - claimed[1]
        law = claimed[0][skip : skip + stop - begin + 3]
    free = bool(flows.free[row, 0]), bool(flows.free[row, 1])
    weights = joint_weights(judged.robot, judged.tolerance)
    return spline_deviation(flows.cubics(layout, row), points, weights, law, free)


def _tool_speed(found: Followed, i: int) -> ToolSpeed:
    speeds = found.speeds
    return ToolSpeed(
        bool(speeds.turns[i]),
        float(speeds.largest[i]),
        float(speeds.programmed[i]),
        float(speeds.least[i]),
        float(speeds.most[i]),
        float(speeds.beyond[i]),
    )


def _spline_move(judged: Judged, layout: Layout, row: int, place: Place, proofs: Proofs) -> Deviation:
    robot, start = judged.robot, proofs.starts.q[row]
    step = place.motion
    assert isinstance(step, hir.SplineMove)
    off_position, off_angle = check_claims(judged, place)
    witness = claimed_joints(judged, place, len(step.waypoints))
    if witness is None:
        return Deviation(np.inf, np.inf, 0.0, 0.0)
    end = layout.ends[row] if place.size else start
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
        rest = by_kind(bound.remainder, robot)
        proofs.covered[row] = bound.covered
    elif place.size:
        position, angle, rest = 0.0, 0.0, (0.0, 0.0)
        proofs.covered[row] = 0.5
    else:
        position, angle = by_kind(np.abs(points - start).max(axis=0), robot)
        rest = 0.0, 0.0
    deviation = Deviation(position, angle, end_position, end_angle, *rest)
    return replace(
        deviation,
        position=max(position, end_position, off_position),
        angle=max(angle, end_angle, off_angle),
    )
