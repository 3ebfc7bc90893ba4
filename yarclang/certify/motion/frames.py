"""Motions along paths of the moving frame: lines, arcs and splines of poses."""

from __future__ import annotations

import numpy as np

from yarclang import hir
from yarclang.certify.blends.flows import Asked
from yarclang.certify.certificate import Deviation, ToolSpeed
from yarclang.certify.judged import Judged
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.cartesian import Followed, Stretch, follow
from yarclang.certify.motion.pose import distance
from yarclang.certify.motion.posespline import PoseSpline
from yarclang.certify.motion.programmed import Arcs, FramePaths, Lines, goal_pose
from yarclang.certify.motion.proved import Proofs, law_of
from yarclang.certify.motion.speed import Programmed
from yarclang.certify.read.layout import Layout, Place
from yarclang.robot.model import Array

Rows = list[tuple[int, Place]]

NO_WAY = 1e-6
"""Length [m] and angle of rotation [rad] below which a path counts as a single point."""
STILL = 1e-9
"""If a frame's origin moves by less than this [m], it counts as standing still.

The speed of such a frame is its angular speed.
"""


def frame_moves(
    judged: Judged, layout: Layout, rows: Rows, flanges: Array, asked: Asked, proofs: Proofs
) -> None:
    """Prove motions of one kind along paths of the moving frame."""
    moving = [(row, place) for row, place in rows if place.size]
    for row, place in rows:
        if not place.size:
            _stays(place, proofs.starts.flange[row], flanges[row], proofs)
    if not moving:
        return
    numbers = np.array([row for row, _ in moving])
    paths = _paths(moving, proofs)
    ends = distance(flanges[numbers] @ paths.flange_from_moving, paths.goal)
    stretch = _stretch(judged, layout, moving, paths, asked, proofs)
    followed = None
    row, place = moving[0]
    # Only splines have claimed laws s(t). Splines are judged one by one, so that the proof of a motion does
    # not depend on other motions.
    has_law = isinstance(place.motion, hir.PoseSplineMove) and not proofs.flows.is_cut(row)
    law = law_of(judged, place) if has_law else None
    # If a speed is programmed, the claimed values are usually fractions of the path length rather than s: try
    # this first.
    ways = [True, False] if law is not None and np.isfinite(stretch.speed.top[0]) else [False]
    for is_way in ways if law is not None else []:
        if followed is None or _is_beyond(followed, stretch):
            followed = follow(stretch, paths, judged.robot, law, is_way=is_way)
    if followed is None or _is_beyond(followed, stretch):
        followed = follow(stretch, paths, judged.robot)
    proofs.covered[numbers] = followed.covered
    for i, (row, place) in enumerate(moving):
        proofs.frames[row] = paths, i
        end = (0.0, 0.0) if place.behind is not None else (float(ends[0][i]), float(ends[1][i]))
        proofs.deviations[place.step] = Deviation(
            max(float(followed.position[i]), end[0]),
            max(float(followed.angle[i]), end[1]),
            *end,
            float(followed.rest[i]),
            float(followed.angle_rest[i]),
        )
        proofs.speeds[place.step] = _tool_speed(followed, i)


def _is_beyond(found: Followed, stretch: Stretch) -> bool:
    """Return True if the first command is farther from its path than allowed."""
    return bool(found.position[0] > stretch.tolerance[0] or found.angle[0] > stretch.angle[0])


def _stays(place: Place, start: Array, flange: Array, proofs: Proofs) -> None:
    """Prove a motion without moves: all its goals must be at the flange's pose (4, 4).

    A relative goal refers to the programmed `start` (4, 4) of the flange.
    """
    step = place.motion
    if isinstance(step, hir.LineMove):
        goals = [goal_pose(step.goal, start)[1]]
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
    judged: Judged, layout: Layout, moving: Rows, paths: FramePaths, asked: Asked, proofs: Proofs
) -> Stretch:
    numbers = np.array([row for row, _ in moving])
    flows = proofs.flows
    whole = flows.whole[numbers]
    # Put the segments of all commands one after the other, and leave out those in between that belong to none
    # of these commands.
    sizes = whole[:, 1] - whole[:, 0]
    first = np.cumsum(sizes) - sizes
    rows_of = np.arange(sizes.sum()) + np.repeat(whole[:, 0] - first, sizes)
    cubics = Cubics.of_spline(layout.control, layout.at[rows_of], layout.time[rows_of])
    follows = flows.follow[numbers] - whole[:, :1]
    cubics = flows.cut(cubics, numbers, first, first + sizes)
    count = len(moving)
    own = np.arange(count)
    # Bounds of the path's first derivatives distinguish a motion of the origin from a pure rotation.
    steep = paths.bounds(own, np.zeros(count), np.ones(count))
    reach, turned = steep.position[:, 0], steep.rotation[:, 0]
    # Below `NO_WAY`, the origin of a frame that turns moves only because coordinates are rounded.
    turns = (reach < STILL) | ((reach < NO_WAY) & (turned >= NO_WAY))
    # The programmed speed of a pure rotation is an angular speed.
    top = np.where(turns, asked.top[numbers, 1], asked.top[numbers, 0])
    # A motion that goes nowhere has no speed.
    top[(reach < NO_WAY) & (turned < NO_WAY)] = np.nan
    wanted = Programmed(
        top * asked.share[numbers],
        top,
        turns,
        np.where(turns[:, None], np.inf, asked.around[numbers]),
        asked.held[numbers] & ~turns[:, None],
    )
    tolerances = [judged.tolerance_of(place.motion) for _, place in moving]
    return Stretch(
        cubics,
        first,
        follows + first[:, None],
        proofs.flows.free[numbers],
        np.array([one.position for one in tolerances]),
        np.array([one.angle for one in tolerances]),
        wanted,
    )


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


def moving_frame(motion: hir.Motion) -> Array:
    """Return the moving frame of a motion, relative to the flange (4, 4).

    This is the frame of the motion's goals, or the frame named on its line, or the flange itself.
    """
    if (named := motion.flange_from_moving) is not None:
        return named
    flange_from_moving = np.eye(4)
    link = motion.origin.moving
    while link is not None and link.parent is not None:
        flange_from_moving = link.parent_from_frame @ flange_from_moving
        link = link.parent
    return flange_from_moving
