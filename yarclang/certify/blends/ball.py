"""What happens where one motion flows into the next: inside a ball round the programmed corner, and nowhere else.

A blend is proved in two halves. The executed motion, between the two places at which the programmed paths are left and joined,
stays in the ball; and so does what of both paths it doesn't follow. For the distance from the corner, e(t) = p(q(t)) - c
is at most its largest Bezier point plus d^4/384 M4, as along a path; joints have their extremes in closed form.

The frame may turn meanwhile: away from the corner's orientation by as much as the one motion has still to turn up to the corner,
and the other has turned behind it, together. A motion in joint space turns it by as much as its joints turn, added up: what of that
cancels out on its own path needn't in the blend.
"""

from __future__ import annotations

import numpy as np

from yarclang import hir
from yarclang.certify.motion.bounds import HERMITE, Cubics, segment_max
from yarclang.certify.motion.pieces import Pieces, arm_bounds, frame_motion, hull
from yarclang.certify.motion.pose import angle_of_chord
from yarclang.certify.motion.programmed import FramePaths, Lines, Rows
from yarclang.certify.motion.spline import NaturalSpline
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot

_COARSE, _FINE = 4, 32
"""Pieces a segment: first, and where that doesn't prove enough."""
_SAMPLES = 513
_STEPS = 16


@frozen(eq=False)
class Balls:
    """B balls, round the poses `corner` (B, 4, 4) of the frames at `flange_from_moving` (B, 4, 4): no more than `radius` (B,)
    [m] away, and turned by no more than `angle` (B,) [rad].
    """

    flange_from_moving: Array
    corner: Array
    radius: Array
    angle: Array


def farthest(cubics: Cubics, owner: Rows, balls: Balls, robot: Robot) -> tuple[Array, Array]:
    """How far the moving frames go from their corners, at any instant: (B,) [m] and (B,) [rad].

    Args:
        cubics: N segments.
        owner: (N,) whose each is, in order; every ball has some.
        balls: bounds that are sharp enough to be within them, where that is true, are sought.
        robot: the arm.
    """
    position, angle = _away(cubics, owner, balls, robot, _COARSE)
    (rough,) = np.nonzero((position > balls.radius[owner]) | (angle > balls.angle[owner]))
    if len(rough):
        finer = _away(cubics.take(rough), owner[rough], balls, robot, _FINE)
        position[rough], angle[rough] = (
            np.minimum(position[rough], finer[0]),
            np.minimum(angle[rough], finer[1]),
        )
    begins = np.flatnonzero(np.diff(owner, prepend=-1))
    return segment_max(position, begins), segment_max(angle, begins)


def _away(cubics: Cubics, owner: Rows, balls: Balls, robot: Robot, pieces: int) -> tuple[Array, Array]:
    """The bounds segment by segment."""
    count = len(cubics.h)
    origin, rotation = arm_bounds(cubics, owner, balls.flange_from_moving, robot)
    cut = Pieces.cut(cubics, np.arange(count), np.full(count, pieces))
    ball = owner[cut.owner]
    motion = frame_motion(robot.chain, cut, balls.flange_from_moving[owner])
    corner = balls.corner[ball]
    rest = HERMITE * cut.d**4
    left, right = cut.left, cut.left + 1
    position = hull(motion.p - corner[:, :3, 3], motion.velocity, left, right, cut.d)
    spin = np.cross(motion.angular[:, :, None], motion.rotation, axis=1).reshape(-1, 9)
    turn = (motion.rotation - corner[:, :3, :3]).reshape(-1, 9)
    chord = hull(turn, spin, left, right, cut.d) + rest * rotation[cut.segment]
    position = position + rest * origin[cut.segment]
    begins = np.arange(count) * pieces
    return segment_max(position, begins), segment_max(angle_of_chord(chord), begins)


@frozen(eq=False)
class Away:
    """How far a part of a programmed path is from the corner: at most `position` [m]; it turns by `angle` [rad] or more."""

    position: float
    angle: float


def away_on_path(
    paths: FramePaths, own: int, part: tuple[float, float], corner: Array, moving_from_frame: Array
) -> Away:
    """The part of a path of the moving frame between two shares of it, which the executed motion doesn't follow.

    The polygon through points of the path is at most F2 step^2 / 8 from it.

    Args:
        paths: programmed paths, of which
        own: is the number of the one that is meant.
        part: from where up to where.
        corner: (4, 4) the corner's pose of the frame that is meant,
        moving_from_frame: (4, 4) which sits there on the path's.
    """
    offset = moving_from_frame[:3, 3]
    far = float(np.linalg.norm(offset))
    count = 2 if isinstance(paths, Lines) and far == 0.0 else _SAMPLES
    s = np.linspace(*part, count)
    owner = np.full(count, own)
    poses = paths.at(owner, s)
    p = poses.p + poses.rotation @ offset
    most = np.linalg.norm(p - corner[:3, 3], axis=1).max()
    bend = 0.0
    if count > 2:
        bounds = paths.bounds(owner[:1], np.array([part[0]]), np.array([part[1]]))
        bend = bounds.position[0, 1] + far * bounds.rotation[0, 1]
    step = (part[1] - part[0]) / (count - 1)
    rotation = poses.rotation @ moving_from_frame[:3, :3]
    turned = np.linalg.norm((rotation - corner[:3, :3]).reshape(count, -1), axis=1)
    return Away(float(most + bend * step**2 / 8.0), float(angle_of_chord(turned).max()))


def cubics_of(spline: NaturalSpline, low: float, high: float) -> Cubics:
    """A part of a path in joint space, between two shares of it, as motions with constant jerk over its parameter."""
    end = spline.s[-1]
    inner = spline.s[(spline.s > low * end) & (spline.s < high * end)]
    s = np.unique(np.concatenate([np.linspace(low, high, _STEPS + 1) * end, inner]))
    s, step = s[:-1], np.diff(s)
    y, slope = spline.at(s)
    third = np.diff(spline.bend, axis=0) / np.diff(spline.s)[:, None]
    return Cubics(y, slope, spline.bends(s), third[spline.span(s)], step)


def away_in_joints(spline: NaturalSpline, end: int, share: float, ball: Balls, robot: Robot) -> Away:
    """The same of a path in joint space, at its start (`end` 0) or its end (1), for the frame of a single ball. It turns by as much as
    its revolute joints do, together.
    """
    cubics = cubics_of(spline, *((0.0, share) if end == 0 else (share, 1.0)))
    if not len(cubics.h):
        return Away(0.0, 0.0)
    position, _ = farthest(cubics, np.zeros(len(cubics.h), dtype=np.int64), ball, robot)
    q = np.concatenate([cubics.x, cubics.at(cubics.h)[0][-1:]])
    turned = joint_turn(q, spline.y[-end], robot)
    return Away(float(position[0]), float(turned.max()))


def joint_turn(q: Array, corner: Array, robot: Robot) -> Array:
    """By how much the revolute joints turn between `q` (N, n) and the corner (n,), added up (N,) [rad]."""
    turned: Array = np.abs(q - corner)[:, ~robot.chain.is_prismatic].sum(axis=1)
    return turned


def radii(blend: hir.Reading, robot: Robot) -> Array:
    """How far each joint (n,) may be from the corner between two joint motions [rad or m]."""
    length, angle = blend.length or 0.0, blend.angle or 0.0
    return np.where(robot.chain.is_prismatic, length, angle)


def joint_distances(cubics: Cubics, corner: Array) -> Array:
    """The most that each joint (n,) is away from the corner (n,) [rad or m], at any instant."""
    if not len(cubics.h):
        return np.zeros_like(corner)
    lower, upper = cubics.position_range()
    away: Array = np.maximum(upper - corner, corner - lower).max(axis=0)
    return away
