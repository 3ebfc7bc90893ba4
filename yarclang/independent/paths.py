"""The programmed paths as dense polylines, computed independently of the compiler, and the distance of
executed motions from these paths.

A pose of the moving frame is represented as a vector: its position [mm] and its rotation matrix, each divided
by its tolerance, so that one distance covers both. Joint positions are vectors as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation, Slerp

from yarclang.independent.arm import Arm, Array
from yarclang.independent.rules import Rule
from yarclang.independent.timetable import Timetable

DENSE, SHORT = 3000, 10.0
"""Number of points of a polyline, and length [mm] below which a path gets only a tenth of them."""

TURN_CHORD = 100.0
"""Length that a rotation by 1 rad adds to the chord parameter of a spline [mm]."""


@dataclass
class Said:
    """The requirements of a program on a motion.

    `kind` is joints, joint_spline, timed, line, arc or pose_spline. `goals` are joint positions [deg, mm] or
    poses, each a position [mm] and a Rotation. If `relative` is True, the goals are increments, which
    `goals_from` adds to the start.
    """

    kind: str
    goals: list[Any]
    via: Array | None = None
    relative: bool = False
    profile: str = "LSPB"
    time: str = "[MIN]"
    blend: float | None = None
    acc: float = 1.0
    tol: float | None = None
    table: Timetable | None = None
    """Table of a timed motion. `stretch` is the factor for all its times."""
    stretch: float = 1.0
    avoids: bool = False
    """True if the motion may leave its straight path to avoid obstacles."""
    rules: tuple[Rule, ...] = ()

    @property
    def in_joints(self) -> bool:
        """True if the motion is defined in joint space."""
        return self.kind in ("joints", "joint_spline", "timed")

    @property
    def seconds(self) -> float | None:
        """Return the requested time [s]; None if there is none."""
        inside = self.time[1:-1]
        return None if inside == "MIN" or "%" in inside or "V" in inside else float(inside)

    @property
    def speed(self) -> float | None:
        """Return the requested speed [mm/s]; None if there is none."""
        return float(self.time[2:-1]) if self.time.startswith("[V ") else None

    @property
    def ceiling(self) -> float | None:
        """Return the largest allowed speed [mm/s]; None if there is none."""
        return float(self.time[4:-1]) if self.time.startswith("[V<=") else None

    @property
    def share(self) -> float:
        """Return the fraction of the limits that the motion may use."""
        return float(self.time[1:-2]) / 100.0 if "%" in self.time else 1.0


def goals_from(arm: Arm, said: Said, start: Array) -> list[Any]:
    """Return the goals of a motion that begins at joint positions `start`. Goals that are increments are
    added to the start.
    """
    if not said.relative:
        return said.goals
    (goal,) = said.goals
    if said.in_joints:
        return [start + goal]
    (point,), turns = arm.poses(start[None])
    return [(point + turns[0].apply(goal[0]), turns[0] * goal[1])]


def path(arm: Arm, said: Said, start: Array, goals: list[Any], way_points: Array) -> Array:
    """Return the programmed path of a motion as a polyline (M, d) of joint positions, or of poses as vectors
    (`embedded`).

    `way_points` are the joint positions that were chosen for the goals.
    """
    if said.kind == "joints":
        return np.array([start, way_points[-1]])
    if said.kind == "joint_spline":
        return _joint_spline(np.array([start, *way_points]), arm.si)
    (first,), turns = arm.poses(start[None])
    return embedded(arm, said, *_of_frame(said, first, turns[0], goals))


def embedded(arm: Arm, said: Said, points: Array, rotations: Any) -> Array:
    """Return poses as vectors (N, 12) in units of the motion's tolerance."""
    tolerance = arm.data["tolerance"]
    # TOL also sets the tolerance of the orientation: one degree per millimeter, but at least the robot's own
    # tolerance.
    angle = max(tolerance["angle"], said.tol or 0.0)
    turns = rotations.as_matrix().reshape(-1, 9) / np.sqrt(2.0) / np.radians(angle)
    places: Array = np.concatenate((points / (said.tol or tolerance["position"]), turns), axis=1)
    return places


def nearest(samples: Array, polyline: Array) -> Array:
    """Return the point of a polyline nearest to each sample."""
    at = cKDTree(polyline).query(samples)[1]
    best: Array = polyline[at]
    far = np.linalg.norm(samples - best, axis=1)
    # Improve the nearest corner: project each sample onto the two pieces beside this corner.
    for piece in (at - 1, at):
        low = np.clip(piece, 0, len(polyline) - 2)
        a, way = polyline[low], polyline[low + 1] - polyline[low]
        square = np.maximum((way * way).sum(axis=1), 1e-300)
        foot = a + np.clip(((samples - a) * way).sum(axis=1) / square, 0.0, 1.0)[:, None] * way
        distance = np.linalg.norm(samples - foot, axis=1)
        nearer = distance < far
        best[nearer], far[nearer] = foot[nearer], distance[nearer]
    return best


def off(arm: Arm, said: Said, samples: Array, polyline: Array) -> Array:
    """Return the distances of samples (N, n) from a path, as fractions of the tolerance (N,)."""
    tolerance = arm.data["tolerance"]
    if said.in_joints:
        each = np.where(arm.slides, tolerance["position"], tolerance["angle"])
        shares: Array = np.abs((samples - nearest(samples, polyline)) / each).max(axis=1)
        return shares
    places = embedded(arm, said, *arm.poses(samples))
    miss = places - nearest(places, polyline)
    return np.asarray(np.maximum(np.linalg.norm(miss[:, :3], axis=1), np.linalg.norm(miss[:, 3:], axis=1)))


def _of_frame(said: Said, first: Array, turn: Any, goals: list[Any]) -> tuple[Array, Any]:
    """Return densely sampled positions [mm] and rotations along a path of the moving frame."""
    short = np.linalg.norm(goals[-1][0] - first) < SHORT
    s = np.linspace(0.0, 1.0, DENSE // 10 if short else DENSE)
    if said.kind == "pose_spline":
        return _pose_spline(first, turn, goals, s)
    point, rotation = goals[-1]
    turns = Slerp([0, 1], Rotation.concatenate([turn, rotation]))(s)
    if said.kind == "line":
        return first + s[:, None] * (point - first), turns
    assert said.via is not None
    return _arc(first, said.via, point, s), turns


def _arc(first: Array, via: Array, last: Array, s: Array) -> Array:
    normal = np.cross(via - first, last - first)
    normal /= np.linalg.norm(normal)
    # The center has the same distance from all three points, and is in their plane: three linear equations.
    rows = np.array([via - first, last - first, normal])
    right = np.array([(via @ via - first @ first) / 2, (last @ last - first @ first) / 2, normal @ first])
    centre = np.linalg.solve(rows, right)
    x = first - centre
    y = np.cross(normal, x)
    sweep = np.arctan2((last - centre) @ y, (last - centre) @ x) % (2 * np.pi)
    points: Array = centre + np.cos(s * sweep)[:, None] * x + np.sin(s * sweep)[:, None] * y
    return points


def _pose_spline(first: Array, turn: Any, goals: list[Any], s: Array) -> tuple[Array, Any]:
    points, quaternions = [first], [turn.as_quat()]
    steps = []
    for point, rotation in goals:
        quaternion = rotation.as_quat()
        # q and -q are the same rotation: choose the sign that is nearer to the quaternion before.
        if quaternion @ quaternions[-1] < 0:
            quaternion = -quaternion
        angle = (Rotation.from_quat(quaternions[-1]).inv() * rotation).magnitude()
        step = np.hypot(np.linalg.norm(point - points[-1]), TURN_CHORD * angle)
        if step > 1e-9:
            points.append(point)
            quaternions.append(quaternion)
            steps.append(step)
    if not steps:
        return np.tile(first, (len(s), 1)), Rotation.concatenate([turn] * len(s))
    knots = np.concatenate(([0.0], np.cumsum(steps))) / np.sum(steps)
    placed = CubicSpline(knots, np.array(points), bc_type="natural")(s)
    turned = CubicSpline(knots, np.array(quaternions), bc_type="natural")(s)
    return placed, Rotation.from_quat(turned)


def _joint_spline(points: Array, si: Array) -> Array:
    """Return the natural cubic spline through joint positions as a polyline. Its parameter is the chord
    length in rad and m.
    """
    keep = [0]
    for number in range(1, len(points)):
        if np.linalg.norm((points[number] - points[keep[-1]]) * si) > 1e-9:
            keep.append(number)
    points = points[keep]
    if len(points) == 1:
        return np.repeat(points, 2, axis=0)
    knots = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points * si, axis=0), axis=1))))
    curve: Array = CubicSpline(knots, points, bc_type="natural")(np.linspace(0.0, knots[-1], DENSE))
    return curve
