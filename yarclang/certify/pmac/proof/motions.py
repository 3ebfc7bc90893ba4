"""Description of each motion in a proof, with the data that the checker needs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from yarclang import hir
from yarclang.certify.blends.flows import Corner, find_flows, frame_of
from yarclang.certify.blends.starts import find_starts
from yarclang.certify.bodies.zones import moving_of
from yarclang.certify.claims import Claims
from yarclang.certify.judged import Judged, tolerance_of
from yarclang.certify.motion.frames import moving_frame
from yarclang.certify.motion.joint import joint_weights
from yarclang.certify.motion.programmed import goal_pose
from yarclang.certify.motion.timed import timed_tolerance
from yarclang.certify.pmac.proof.room import in_units, told_frame
from yarclang.certify.pmac.proof.shares import (
    Own,
    corner_pieces,
    frame_proof,
    joint_proof,
    pose_spline_proof,
    spline_proof,
)
from yarclang.certify.read.layout import Layout, Place
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.units import DEG, MM
from yarclang.verify.paths import GRID

_PIECES_OF_CEILING = 8
"""Number of pieces of a segment on which the speed of a frame with a ceiling is bounded. With fewer pieces, a
bound could exceed the ceiling although the speed only just reaches it.
"""
_PIECES_OF_TABLE = 4
"""Number of pieces into which a segment of a timed motion is cut."""
_LEAST_PART = GRID >> 16
"""Least part of a segment that the proof of a path covers [1 / GRID of a segment]."""
_ROUNDING = 1e-9
"""Largest difference of poses that are equal but for rounding [m, and entries of rotation matrices]."""


@frozen(eq=False)
class Begin:
    """Start of a motion: joints `q` (n,) [rad or m], and `flange` (4, 4) in {B}."""

    q: Array
    flange: Array


class Motions:
    """All motions of a text, described for the proof.

    Attributes:
        told: the description of each motion in the proof, by its step.
        proofs: the data with which the checker checks a motion, by the motion's step written as a string.
    """

    def __init__(
        self, judged: Judged, layout: Layout, program: hir.Program, firsts: Mapping[int, int]
    ) -> None:
        self._judged, self._layout, self._firsts = judged, layout, firsts
        starts = find_starts(judged, layout, program)
        self._flows = find_flows(judged, layout, starts)
        self._chosen = starts.chosen
        self._begins = [Begin(q, flange) for q, flange in zip(starts.q, starts.flange, strict=True)]
        self.told: dict[int, dict[str, Any]] = {}
        self.proofs: dict[str, Any] = {}
        for row, place in enumerate(layout.places):
            self._add(row, place)
        for corner in self._flows.corners:
            self._add_corner(corner)

    def _add(self, row: int, place: Place) -> None:
        judged, begin = self._judged, self._begins[row]
        entry = _told(place, begin, judged.robot, judged.tolerance, judged.claims)
        self.told[place.step] = entry
        if place.behind is not None:
            blend = place.motion.blend
            sizes = ((blend and blend.length, MM), (blend and blend.angle, DEG))
            entry["blend"] = [float(f"{(size or 0.0) / unit:.13g}") for size, unit in sizes]
        if not place.size or "unchecked" in entry:
            return
        proof = self._proof(row, place, begin)
        if isinstance(proof, str):
            entry["unchecked"] = proof
        elif proof is not None:
            if self._chosen[row]:
                proof["start"] = (begin.q / judged.robot.axis_units).tolist()
            if place.motion.timing.ceiling is not None:
                proof["speeds"] = _PIECES_OF_CEILING
            self.proofs[str(place.step)] = proof

    def _proof(self, row: int, place: Place, begin: Begin) -> dict[str, Any] | str | None:
        """Return the data with which the checker checks a motion; None if no data are needed.

        If the motion cannot be checked, the result is a string with the reason.
        """
        motion, robot = place.motion, self._judged.robot
        if isinstance(motion, hir.LineMove | hir.ArcMove):
            start, goal = goal_pose(motion.goal, begin.flange)
            return frame_proof(
                self._own(row, place), motion, start, goal, robot, self._judged.tolerance_of(motion)
            )
        if isinstance(motion, hir.JointMove):
            return self._of_joints(row, place, begin)
        if isinstance(motion, hir.PoseSplineMove):
            frame = motion.waypoints[0].flange_from_moving
            goals = (one.base_from_moving for one in _distinct(motion.waypoints))
            poses = np.array([begin.flange @ frame, *goals])
            own = self._own(row, place)
            return pose_spline_proof(
                own, poses, frame, robot, self._judged.tolerance_of(motion), motion.timing
            )
        if isinstance(motion, hir.TimedMove):
            return {"pieces": _PIECES_OF_TABLE}
        if isinstance(motion, hir.SplineMove | hir.AvoidMove):
            through = [one["q"] for one in _through(place, begin, robot, self._judged.claims)]
            points = np.array([begin.q / robot.axis_units, *through]) * robot.axis_units
            weights = joint_weights(robot, self._judged.tolerance)
            law = self._judged.claims.laws.get(place.step)
            return spline_proof(self._own(row, place), points, weights, law)
        return None

    def _of_joints(self, row: int, place: Place, begin: Begin) -> dict[str, Any]:
        """Return the data of a straight joint motion, with the joint positions chosen for its end pose."""
        robot, claims = self._judged.robot, self._judged.claims
        (goal,) = _through(place, begin, robot, claims)
        claimed = claims.witnesses.get(place.step)
        q = self._layout.ends[row] / robot.axis_units if claimed is None else claimed[-1] / robot.axis_units
        told = {}
        if place.behind is not None and goal["q"] is None:
            told["goal"] = q.tolist()
        end = np.array(q if goal["q"] is None else goal["q"]) * robot.axis_units
        weights = joint_weights(robot, self._judged.tolerance)
        return told | joint_proof(self._own(row, place), begin.q, end, weights)

    def _own(self, row: int, place: Place) -> Own:
        """Return the segments that follow a motion's own path, without the parts that belong to blends."""
        flows, layout = self._flows, self._layout
        begin, end = (int(x) for x in flows.follow[row])
        if (place.before, place.behind) == (None, None):
            return Own(layout.cubics(begin, end), (0.0, 1.0), {})
        free = flows.free[row].tolist()
        ends = None if free[0] else 0.0, None if free[1] else 1.0
        since, until = float(flows.since[row]), float(flows.until[row])
        base = place.first - self._firsts[place.step]
        places = [float(begin - base), float(end - base)]
        if np.isfinite(since):
            places[0] += since / float(layout.time[begin])
        if np.isfinite(until):
            places[1] += until / float(layout.time[end - 1]) - 1.0
        told = {name: round(one * GRID) for name, one in zip(("from", "until"), places, strict=True)}
        if begin >= end:
            told["until"] = told["from"]
            return Own(layout.cubics(begin, begin), ends, told)
        # Parts of a segment that would vanish by the rounding of places and of s are left out or completed.
        for name, at in told.items():
            edge = round(at / GRID) * GRID
            told[name] = edge if abs(at - edge) < _LEAST_PART else at
        rows = np.arange(told["from"] // GRID, -(-told["until"] // GRID)) + base - begin
        return Own(flows.cubics(layout, row).take(rows), ends, told)

    def _add_corner(self, corner: Corner) -> None:
        """Add to the data of a motion the number of pieces into which the segments of the blend after it are
        cut.
        """
        layout, judged = self._layout, self._judged
        first, second = (layout.places[row] for row in (corner.first, corner.second))
        proof = self.proofs.get(str(first.step))
        if proof is None or str(second.step) not in self.proofs:
            return
        if not corner.rounded:
            return
        begin, end = int(self._flows.follow[corner.first, 1]), int(self._flows.follow[corner.second, 0])
        frame = None if corner.joints else frame_of(first.motion, second.motion)
        if frame is None or end <= begin:
            proof["corner"] = 1
            return
        own = judged.tolerance_of(first.motion)
        ball = (first.motion.blend.length or 0.0) if first.motion.blend else 0.0
        cubics = layout.cubics(begin, end)
        proof["corner"] = corner_pieces(cubics, frame, judged.robot, ball + own.position, own.angle)


def _told(place: Place, begin: Begin, robot: Robot, tolerance: Tolerance, claims: Claims) -> dict[str, Any]:
    """Return the description of a motion in the proof."""
    motion = place.motion
    own = (
        timed_tolerance(motion, robot)
        if isinstance(motion, hir.TimedMove)
        else tolerance_of(motion, tolerance)
    )
    entry: dict[str, Any] = {"tolerance": in_units(np.array([own.position / MM, own.angle / DEG]))}
    timing = motion.timing
    if timing.duration is not None:
        entry["duration"] = float(f"{timing.duration:.13g}")
    if timing.speed is not None:
        entry["speed"] = _speed(timing.speed)
        kept = min(claims.kept.get(place.step, 1.0), claims.least.get(place.step, 1.0))
        if kept < 1.0:
            entry["kept"] = float(kept)
    if timing.ceiling is not None:
        entry["ceiling"] = float(f"{timing.ceiling / MM:.13g}")
    if place.any_jerk:
        entry["any_jerk"] = True
    match motion:
        case hir.LineMove(goal=goal) | hir.ArcMove(goal=goal):
            pose = goal_pose(goal, begin.flange)[1]
            entry |= {"move": "line", "pose": told_frame(pose), "tool": told_frame(goal.flange_from_moving)}
            if isinstance(motion, hir.ArcMove):
                entry |= {"move": "arc", "via": motion.via.tolist()}
        case hir.JointMove() | hir.SplineMove() | hir.AvoidMove():
            entry["move"] = "joint" if isinstance(motion, hir.JointMove) else "spline"
            entry["through"] = list(_through(place, begin, robot, claims))
            if timing.ceiling is not None:
                entry["tool"] = told_frame(moving_of(motion, robot).flange_from_moving)
            if motion.tolerance is not None and place.size:
                entry["tolerance_of"] = told_frame(moving_frame(motion))
        case hir.PoseSplineMove(waypoints=waypoints):
            *poses, last = (told_frame(waypoint.base_from_moving) for waypoint in _distinct(waypoints))
            tool = told_frame(waypoints[0].flange_from_moving)
            entry |= {"move": "spline of poses", "pose": last, "tool": tool, "poses": poses}
        case hir.TimedMove():
            entry |= {"move": "timetable", "within": in_units(motion.within / robot.axis_units)}
            entry["rows"] = _rows(motion, robot)
    return entry


def _distinct(waypoints: Sequence[hir.PoseGoal]) -> list[hir.PoseGoal]:
    """Return the waypoints of a spline of poses without those that equal the next one but for rounding.

    The language counts equal neighbours as one waypoint. The checker has no such rule, and so needs a list
    without them.
    """
    poses = np.array([one.base_from_moving for one in waypoints])
    moved = np.abs(np.diff(poses, axis=0)).max(axis=(1, 2)) > _ROUNDING
    return [*(one for one, goes in zip(waypoints, moved, strict=False) if goes), waypoints[-1]]


def _rows(motion: hir.TimedMove, robot: Robot) -> list[dict[str, Any]]:
    """Return the rows of a timetable. The first row has the time 0, and may have no position."""
    table, units = motion.asked, robot.axis_units
    columns = {"q": table.positions, "v": table.velocities, "a": table.accelerations}
    given = {name: (column / units).tolist() for name, column in columns.items() if column is not None}
    times = [float(f"{at:.13g}") for at in table.times]
    rows = [{"at": at, **{name: given[name][number] for name in given}} for number, at in enumerate(times)]
    still = [0.0] * len(units)
    if table.begins:
        return [rows[0] | ({"v": still} if "v" in given else {}), *rows[1:]]
    return [{"at": 0.0} | {name: None if name == "q" else still for name in given}, *rows]


def _speed(speed: hir.Reading) -> list[float | None]:
    """Return a speed as two values: the speed of the frame's origin [mm/s] and its angular speed [deg/s].

    A value that is not given is None.
    """
    read_as = (speed.length, MM), (speed.angle, DEG)
    return [None if number is None else float(f"{number / unit:.13g}") for number, unit in read_as]


def _through(place: Place, begin: Begin, robot: Robot, claims: Claims) -> Iterator[dict[str, Any]]:
    """Yield the waypoints of a joint motion [deg or mm], with the poses for which they were chosen."""
    motion = place.motion
    claimed = claims.witnesses.get(place.step)
    goals = motion.goals
    if isinstance(motion, hir.AvoidMove) and claimed is not None:
        for q in claimed[:-1]:
            yield {"q": (q / robot.axis_units).tolist()}
        claimed = claimed[-1:]
    for number, goal in enumerate(goals):
        match goal:
            case hir.JointGoal(q=q):
                yield {"q": (q / robot.axis_units).tolist()}
            case hir.JointDelta(dq=dq):
                yield {"q": ((begin.q + dq) / robot.axis_units).tolist()}
            case hir.PoseGoal():
                of_text = isinstance(motion, hir.JointMove) or claimed is None
                q_told = None if of_text or claimed is None else (claimed[number] / robot.axis_units).tolist()
                frame = told_frame(goal.flange_from_moving)
                yield {"q": q_told, "pose": told_frame(goal.base_from_moving), "tool": frame}
