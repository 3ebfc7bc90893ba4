"""How far every command is from what it asks for: each kind of motion by its own proof."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from yarclang import hir
from yarclang.certify.bounds import Cubics
from yarclang.certify.certificate import Deviation
from yarclang.certify.joint import by_kind, joint_weights, straight_deviations
from yarclang.certify.layout import Layout, Place, row_chunks
from yarclang.certify.line import Lines, goal_pose, line_deviations
from yarclang.certify.pose import distance
from yarclang.certify.spline import spline_deviation
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.units import DEG, MM


@dataclass(frozen=True, slots=True)
class Paths:
    """What the paths are judged by. `find` takes a code, a message and the number of a step."""

    robot: Robot
    tolerance: Tolerance
    witnesses: Mapping[int, Array]
    laws: Mapping[int, Array]
    find: Callable[[str, str, int | None], None]


def find_deviations(paths: Paths, layout: Layout) -> dict[int, Deviation]:
    """A bound for every step, and a finding for each that is beyond the tolerance."""
    flanges = flange_poses(paths.robot.chain, layout.stands)
    found: dict[int, Deviation] = {}
    chosen: dict[type, list[tuple[int, Place]]] = {hir.JointMove: [], hir.LineMove: [], hir.SplineMove: []}
    for row, place in enumerate(layout.places):
        chosen[type(place.motion)].append((row, place))
    for rows in row_chunks(chosen[hir.JointMove]):
        found.update(_joint_moves(paths, layout, rows, flanges))
    for rows in row_chunks(chosen[hir.LineMove]):
        found.update(_line_moves(paths, layout, rows, flanges))
    for row, place in chosen[hir.SplineMove]:
        found[place.step] = _spline_move(paths, layout, row, place)
    for place in layout.places:
        _judge_deviation(paths, place, found[place.step])
    return found


def _judge_deviation(paths: Paths, place: Place, deviation: Deviation) -> None:
    tolerance = paths.tolerance
    if deviation.end_position > tolerance.position or deviation.end_angle > tolerance.angle:
        paths.find(
            "Y1160",
            f"the motion ends {_shown(deviation.end_position, deviation.end_angle)} from its goal, "
            f"allowed are {_shown(tolerance.position, tolerance.angle)} (line {place.last_line})",
            place.step,
        )
    elif not (deviation.position <= tolerance.position and deviation.angle <= tolerance.angle):
        paths.find(
            "Y1159",
            f"the path is proved within {_shown(deviation.position, deviation.angle)}, allowed are "
            f"{_shown(tolerance.position, tolerance.angle)}",
            place.step,
        )


def _shown(position: float, angle: float) -> str:
    """A distance [m] and an angle [rad] for a reader."""
    return f"{position / MM:.6g} mm and {angle / DEG:.6g} deg"


def _joint_moves(
    paths: Paths, layout: Layout, rows: list[tuple[int, Place]], flanges: Array
) -> Iterator[tuple[int, Deviation]]:
    robot = paths.robot
    goals, ends = [], []
    for row, place in rows:
        step = place.motion
        assert isinstance(step, hir.JointMove)
        end = layout.stands[row + 1]
        if isinstance(step.goal, hir.PoseGoal):
            position, angle = distance(
                flanges[row + 1] @ step.goal.flange_from_moving, step.goal.base_from_moving
            )
            goals.append(end)
            ends.append((float(position), float(angle)))
        else:
            goal = step.goal.q if isinstance(step.goal, hir.JointGoal) else layout.stands[row] + step.goal.dq
            goals.append(goal)
            ends.append(by_kind(np.abs(end - goal), robot))
    # a command without moves is one control point: where the robot stands
    control = [layout.points(place) if place.size else layout.stands[row : row + 1] for row, place in rows]
    first = np.cumsum([0, *(len(points) for points in control[:-1])])
    joints = straight_deviations(np.concatenate(control), first, np.array(goals), robot, paths.tolerance)
    for (_, place), off, end in zip(rows, joints, ends, strict=True):
        slide, turn = by_kind(off, robot)
        yield place.step, Deviation(max(slide, end[0]), max(turn, end[1]), *end)


def _line_moves(
    paths: Paths, layout: Layout, rows: list[tuple[int, Place]], flanges: Array
) -> Iterator[tuple[int, Deviation]]:
    starts, goals, frames, ends = [], [], [], []
    for row, place in rows:
        step = place.motion
        assert isinstance(step, hir.LineMove)
        start, goal = goal_pose(step.goal, flanges[row])
        end = flanges[row + 1] @ step.goal.flange_from_moving
        if place.size == 0:
            position, angle = (float(x) for x in distance(end, goal))
            yield place.step, Deviation(position, angle, position, angle)
            continue
        starts.append(start)
        goals.append(goal)
        frames.append(step.goal.flange_from_moving)
        ends.append(end)
    moving = [place for _, place in rows if place.size]
    if not moving:
        return
    rows_of = np.concatenate([np.arange(place.first, place.last) for place in moving])
    cubics = Cubics.of_spline(layout.control, layout.at[rows_of], layout.time[rows_of])
    first = np.cumsum([0, *(place.size for place in moving[:-1])])
    lines = Lines(np.array(starts), np.array(goals), np.array(frames))
    found = line_deviations(cubics, first, lines, np.array(ends), paths.robot, paths.tolerance)
    for place, deviation in zip(moving, found, strict=True):
        yield place.step, deviation


def _spline_move(paths: Paths, layout: Layout, row: int, place: Place) -> Deviation:
    robot = paths.robot
    step = place.motion
    assert isinstance(step, hir.SplineMove)
    witness = paths.witnesses.get(place.step)
    shape = (len(step.waypoints), robot.size)
    if witness is None or witness.shape != shape or not np.isfinite(witness).all():
        paths.find("Y1161", f"no joint positions of shape {shape} were given for its way-points", place.step)
        return Deviation(math.inf, math.inf, 0.0, 0.0)
    off_position, off_angle = _check_witness(paths, step, witness, place.step)
    stand, end = layout.stands[row], layout.stands[row + 1]
    end_position, end_angle = by_kind(np.abs(end - witness[-1]), robot)
    points = np.concatenate([stand[None], witness])
    if place.size:
        rows = slice(place.first, place.last)
        cubics = Cubics.of_spline(layout.control, layout.at[rows], layout.time[rows])
        law = paths.laws.get(place.step)
        bound = spline_deviation(cubics, points, joint_weights(robot, paths.tolerance), law)
        position, angle = by_kind(bound.deviation, robot)
        rest = by_kind(bound.remainder, robot)
    else:
        position, angle = by_kind(np.abs(points - stand).max(axis=0), robot)
        rest = 0.0, 0.0
    deviation = Deviation(position, angle, end_position, end_angle, *rest)
    return replace(
        deviation,
        position=max(position, end_position, off_position),
        angle=max(angle, end_angle, off_angle),
    )


def _check_witness(paths: Paths, step: hir.SplineMove, witness: Array, number: int) -> tuple[float, float]:
    """How far the claimed joint way-points are from the programmed ones [m], [rad]."""
    worst = 0.0, 0.0
    flanges = flange_poses(paths.robot.chain, witness)
    for i, waypoint in enumerate(step.waypoints):
        if isinstance(waypoint, hir.JointGoal):
            off = by_kind(np.abs(witness[i] - waypoint.q), paths.robot)
            allowed = 1e-9, 1e-9
        else:
            position, angle = distance(flanges[i] @ waypoint.flange_from_moving, waypoint.base_from_moving)
            off = float(position), float(angle)
            allowed = paths.tolerance.position, paths.tolerance.angle
        if off[0] > allowed[0] or off[1] > allowed[1]:
            paths.find(
                "Y1161",
                f"the planned way-point {i + 1} is {_shown(*off)} from the programmed one",
                number,
            )
        worst = max(worst[0], off[0]), max(worst[1], off[1])
    return worst
