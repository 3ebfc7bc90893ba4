"""Proof that a blend stays inside a ball round the programmed corner.

Two things are proved for each blend. First, the executed motion stays in the ball from where it leaves the
first path to where it joins the second one. Second, the parts of both paths that the executed motion does not
follow stay in the ball as well. The distance from the corner is |e| with e(t) = p(q(t)) - c, where p is the
position of the moving frame and c the corner. Segments are cut into pieces. On a piece of duration d, |e| is
at most the largest Bezier point of e's Hermite cubic, plus d^4/384 M4 with a bound M4 of |e''''| (see
`yarclang.certify.motion.bounds`). If the ball is an allowed distance of each joint, no such bound is needed,
since the extremes of a joint on a segment are known in closed form.

The frame may rotate in a blend. Its angle from the corner's orientation is at most the sum of two angles: the
rotation of the first motion from where its path is left to the corner, and the rotation of the second motion
from the corner to where its path is joined. A motion in joint space rotates the frame by at most the sum of
the rotations of its joints. On the path itself, rotations of two joints may cancel each other; in the blend,
they need not.
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
"""Number of pieces per segment: `_COARSE` first, and `_FINE` if the first bound exceeds the ball."""
_SAMPLES = 513
"""Number of points at which a path of the moving frame is sampled."""
_STEPS = 16
"""Least number of cubics into which a section of a path in joint space is cut."""


@frozen(eq=False)
class Balls:
    """Balls round the corners of B blends, each with the moving frame that must stay in it.

    Attributes:
        flange_from_moving: (B, 4, 4) moving frames, relative to the flange.
        corner: (B, 4, 4) poses of the moving frames in the corners.
        radius: (B,) allowed distances from the corners [m].
        angle: (B,) allowed angles from the orientations in the corners [rad].
    """

    flange_from_moving: Array
    corner: Array
    radius: Array
    angle: Array


def farthest(cubics: Cubics, owner: Rows, balls: Balls, robot: Robot) -> tuple[Array, Array]:
    """Bound the distances (B,) [m] and angles (B,) [rad] of moving frames from their corners, at any instant.

    If a bound exceeds the radius or angle of the ball, a sharper one is computed from shorter pieces.

    Args:
        cubics: N segments.
        owner: (N,) index of the ball of each segment, in ascending order; every ball has at least one
            segment.
        balls: the balls.
        robot: the arm.
    """
    position, angle = _away(cubics, owner, balls, robot, _COARSE)
    # If the rough bound of a segment exceeds the ball, cut the segment into shorter pieces. Both bounds are
    # valid, so take the smaller one.
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
    """Bound the distances (N,) [m] and angles (N,) [rad] from the corners, with `pieces` per segment."""
    count = len(cubics.h)
    origin, rotation = arm_bounds(cubics, owner, balls.flange_from_moving, robot)
    cut = Pieces.cut(cubics, np.arange(count), np.full(count, pieces))
    ball = owner[cut.owner]
    motion = frame_motion(robot.chain, cut, balls.flange_from_moving[owner])
    corner = balls.corner[ball]
    rest = HERMITE * cut.d**4
    left, right = cut.left, cut.left + 1
    # Bound the distance by the largest Bezier point, plus the Hermite remainder. The difference of the
    # rotations is bounded in the same way.
    position = hull(motion.p - corner[:, :3, 3], motion.velocity, left, right, cut.d)
    # The columns of a rotation R that turns with the angular velocity omega change at the rate omega x
    # column. The turn is measured by the Frobenius norm of R - R_corner.
    spin = np.cross(motion.angular[:, :, None], motion.rotation, axis=1).reshape(-1, 9)
    turn = (motion.rotation - corner[:, :3, :3]).reshape(-1, 9)
    chord = hull(turn, spin, left, right, cut.d) + rest * rotation[cut.segment]
    position = position + rest * origin[cut.segment]
    begins = np.arange(count) * pieces
    return segment_max(position, begins), segment_max(angle_of_chord(chord), begins)


@frozen(eq=False)
class Away:
    """Largest distance and angle from a corner on a part of a programmed path.

    Attributes:
        position: upper bound of the distance from the corner [m].
        angle: largest angle from the corner's orientation at sampled points, a lower bound of the real one
            [rad].
    """

    position: float
    angle: float


def away_on_path(
    paths: FramePaths, own: int, part: tuple[float, float], corner: Array, moving_from_frame: Array
) -> Away:
    """Bound the distance from the corner on the part of a programmed Cartesian path that the blend cuts off.

    The path is at most F2 step^2 / 8 from the polygon through its sampled points, where F2 bounds the path's
    second derivative.

    Args:
        paths: programmed paths.
        own: index of the path in `paths`.
        part: range of the path's parameter in the part that is cut off.
        corner: (4, 4) pose of the blend's frame in the corner.
        moving_from_frame: (4, 4) the blend's frame, relative to the path's moving frame.
    """
    offset = moving_from_frame[:3, 3]
    lever = float(np.linalg.norm(offset))
    count = 2 if isinstance(paths, Lines) and lever == 0.0 else _SAMPLES
    s = np.linspace(*part, count)
    owner = np.full(count, own)
    poses = paths.at(owner, s)
    # The blend's frame is rigidly attached to the path's frame, at `offset`.
    p = poses.p + poses.rotation @ offset
    most = np.linalg.norm(p - corner[:3, 3], axis=1).max()
    bend = 0.0
    if count > 2:
        bounds = paths.bounds(owner[:1], np.array([part[0]]), np.array([part[1]]))
        # For a point at the distance `lever` from the frame's origin, |p''| is at most that of the origin
        # plus `lever` times that of the rotation. A line without an offset is its own chord and needs no
        # bound.
        bend = bounds.position[0, 1] + lever * bounds.rotation[0, 1]
    step = (part[1] - part[0]) / (count - 1)
    rotation = poses.rotation @ moving_from_frame[:3, :3]
    # The difference of two rotations has the Frobenius norm 2 sqrt 2 sin(angle / 2), their chord.
    turned = np.linalg.norm((rotation - corner[:3, :3]).reshape(count, -1), axis=1)
    # A curve leaves its chord by at most step^2 / 8 times its second derivative.
    return Away(float(most + bend * step**2 / 8.0), float(angle_of_chord(turned).max()))


def cubics_of(spline: NaturalSpline, low: float, high: float) -> Cubics:
    """Return a section of a path in joint space as cubics over the path's parameter. `low` and `high` are the
    section's start and end, as fractions (0 to 1) of the parameter's range.
    """
    end = spline.s[-1]
    # Include the waypoints, where the third derivative jumps, so that each piece is one cubic.
    inner = spline.s[(spline.s > low * end) & (spline.s < high * end)]
    s = np.unique(np.concatenate([np.linspace(low, high, _STEPS + 1) * end, inner]))
    s, step = s[:-1], np.diff(s)
    y, slope = spline.at(s)
    # On each span y'' is linear, so y''' is constant: the difference quotient of y'' at the waypoints.
    third = np.diff(spline.bend, axis=0) / np.diff(spline.s)[:, None]
    return Cubics(y, slope, spline.bends(s), third[spline.span(s)], step)


def away_in_joints(spline: NaturalSpline, end: int, share: float, ball: Balls, robot: Robot) -> Away:
    """Bound the distance from the corner on the part of a path in joint space that the blend cuts off.

    The frame rotates by at most the sum of the rotations of the revolute joints.

    Args:
        spline: the path.
        end: 0 for the part at the path's start, 1 for the part at its end.
        share: fraction of the path's parameter range at which the cut-off part ends (`end` 0) or begins
            (`end` 1).
        ball: the ball round the corner, as `Balls` with a single entry.
        robot: the arm.
    """
    cubics = cubics_of(spline, *((0.0, share) if end == 0 else (share, 1.0)))
    if not len(cubics.h):
        return Away(0.0, 0.0)
    position, _ = farthest(cubics, np.zeros(len(cubics.h), dtype=np.int64), ball, robot)
    q = np.concatenate([cubics.x, cubics.at(cubics.h)[0][-1:]])
    turned = joint_turn(q, spline.y[-end], robot)
    return Away(float(position[0]), float(turned.max()))


def joint_turn(q: Array, corner: Array, robot: Robot) -> Array:
    """Return, for each joint position in `q` (N, n), the sum (N,) [rad] of the angles by which the revolute
    joints differ from the corner (n,).
    """
    turned: Array = np.abs(q - corner)[:, ~robot.chain.is_prismatic].sum(axis=1)
    return turned


def radii(blend: hir.Reading, robot: Robot) -> Array:
    """Return the allowed distances (n,) of the joints from the corner of two joint motions [rad or m]."""
    length, angle = blend.length or 0.0, blend.angle or 0.0
    return np.where(robot.chain.is_prismatic, length, angle)


def joint_distances(cubics: Cubics, corner: Array) -> Array:
    """Bound the distance of each joint (n,) from the corner (n,) [rad or m], at any instant."""
    if not len(cubics.h):
        return np.zeros_like(corner)
    lower, upper = cubics.position_range()
    away: Array = np.maximum(upper - corner, corner - lower).max(axis=0)
    return away
