"""Paths of the moving frame, computed in other ways than by the judge: circles from perpendicular bisectors,
and scipy's rotations and splines.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from tests.certify.certify_bench import FLANGE_FROM_TCP, inverse, sample
from yarclang.robot.kinematics.fk import tool_poses


def pose(xyz, rotation) -> np.ndarray:
    """Return a transform (4, 4)."""
    made = np.eye(4)
    made[:3, 3], made[:3, :3] = xyz, rotation
    return made


def moved(start, way, rotvec) -> np.ndarray:
    """Return a pose shifted by `way` and rotated by `rotvec`, both in the base's axes."""
    return pose(start[:3, 3] + way, Rotation.from_rotvec(rotvec).as_matrix() @ start[:3, :3])


def arc_poses(start, via, goal, s) -> np.ndarray:
    """Return poses (k, 4, 4) on the circle through start, via and goal, at shares `s` of the arc."""
    a, b, c = start[:3, 3], np.asarray(via, float), goal[:3, 3]
    normal = np.cross(b - a, c - b)
    # The center is in the plane of the points, and in the bisecting planes of two pairs of them.
    rows = np.array([b - a, c - b, normal])
    centre = np.linalg.solve(rows, [(b - a) @ (a + b) / 2, (c - b) @ (b + c) / 2, normal @ a])
    x = a - centre
    y = np.cross(normal / np.linalg.norm(normal), x)
    angles = [np.arctan2((p - centre) @ y, (p - centre) @ x) % (2 * np.pi) for p in (b, c)]
    assert angles[0] < angles[1]
    phi = np.outer(s, [angles[1]])
    return joined(centre + np.cos(phi) * x + np.sin(phi) * y, turn(start, goal, s))


def turn(start, goal, s) -> np.ndarray:
    """Return rotations (k, 3, 3) from one pose's to the other's, about one axis."""
    vector = Rotation.from_matrix(goal[:3, :3] @ start[:3, :3].T).as_rotvec()
    return Rotation.from_rotvec(np.outer(s, vector)).as_matrix() @ start[:3, :3]


def joined(points, rotations) -> np.ndarray:
    """Return poses (k, 4, 4) of points and rotations."""
    poses = np.tile(np.eye(4), (len(points), 1, 1))
    poses[:, :3, 3], poses[:, :3, :3] = points, rotations
    return poses


def chord(poses) -> np.ndarray:
    """Return the parameter u at the waypoints: the distance, where 1 rad counts as 0.1 m."""
    far = np.linalg.norm(np.diff([p[:3, 3] for p in poses], axis=0), axis=1)
    angles = [
        (Rotation.from_matrix(b[:3, :3]) * Rotation.from_matrix(a[:3, :3]).inv()).magnitude()
        for a, b in itertools.pairwise(poses)
    ]
    return np.r_[0.0, np.cumsum(np.hypot(far, 0.1 * np.array(angles)))]


def spline_poses(poses, s, bc_type="natural") -> np.ndarray:
    """Return poses (k, 4, 4) on the natural splines of position and quaternion through waypoints, at shares
    `s` of u.
    """
    u = chord(poses)
    q = np.array([Rotation.from_matrix(p[:3, :3]).as_quat() for p in poses])
    for k in range(1, len(q)):
        if q[k] @ q[k - 1] < 0:
            q[k] = -q[k]
    at = CubicSpline(u, np.hstack([[p[:3, 3] for p in poses], q]), bc_type=bc_type)(np.asarray(s) * u[-1])
    return joined(at[:, :3], Rotation.from_quat(at[:, 3:]).as_matrix())


def arm_curve(robot, start_q, poses_of, tool=FLANGE_FROM_TCP):
    """Return the curve q(s) of a path of poses."""
    return lambda s: inverse(robot, poses_of(np.asarray(s)), start_q, tool)


def off_path(robot, start, points, h, poses_of, tool=FLANGE_FROM_TCP, per_segment=8):
    """Sample a motion densely. Return the largest distance [m] from the nearest point of the path; and the
    largest distance and angle [rad] from the path's pose that is nearest in position and rotation together.
    """
    _, q, *_ = sample(start, points, h, per_segment)
    return off_path_at(tool_poses(robot.chain, q, tool), poses_of)


def off_path_at(poses, poses_of):
    """Do the same as `off_path` for executed poses (k, 4, 4)."""
    grid = np.linspace(0, 1, 601)
    table = poses_of(grid)
    weight = 0.02e-3 / np.radians(0.002)

    def errors(path):
        far = np.linalg.norm(path[..., :3, 3] - poses[:, None, :3, 3], axis=-1)
        norm = np.linalg.norm(path[..., :3, :3] - poses[:, None, :3, :3], axis=(-2, -1))
        return far, 2 * np.arcsin(np.minimum(norm / np.sqrt(8), 1))

    answers = []
    row = np.arange(len(poses))
    for turns in (0.0, weight):
        far, angle = errors(table[None])
        best, width = grid[np.argmin(far**2 + (turns * angle) ** 2, axis=1)], grid[1]
        for _ in range(11):
            s = np.clip(best[:, None] + np.linspace(-width, width, 9), 0, 1)
            far, angle = errors(poses_of(s.ravel()).reshape(*s.shape, 4, 4))
            i = np.argmin(far**2 + (turns * angle) ** 2, axis=1)
            best, width = s[row, i], width / 3
        answers.append((far[row, i].max(), angle[row, i].max()))
    return answers[0][0], np.array(answers[1])
