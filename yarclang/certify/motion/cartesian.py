"""Deviation of the moving frame from its programmed path, and the frame's speed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.blends.flows import covered_by_balls
from yarclang.certify.motion.bounds import (
    HERMITE,
    JUMP,
    Cubics,
    catch_up,
    hermite_bezier,
    path_fourth,
    segment_max,
)
from yarclang.certify.motion.pieces import Pieces, arm_bounds, frame_motion, hull
from yarclang.certify.motion.pose import angle_of_chord
from yarclang.certify.motion.programmed import Bounds, FramePaths, Motion, Poses, Rows
from yarclang.certify.motion.speed import (
    Programmed,
    Speeds,
    finer_for_speed,
    judged,
    speed_bounds,
    turn_bounds,
)
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Robot

REMAINDER_SHARE = 0.02
"""Fraction of the tolerance that the remainder of the proof (the bound of the error between sampled points)
should not exceed. It determines the number of pieces.
"""
_AT_ONCE = 8_192
"""Number of pieces that are bounded in one step, so that memory does not grow with the length of a motion."""
MOST_PIECES = 32
"""Largest number of pieces of a segment. A motion that needs more is far beyond any limit."""


@frozen(eq=False)
class Stretch:
    """The executed segments of C consecutive Cartesian commands, with the requirements on them.

    Attributes:
        cubics: the segments of all commands.
        first: (C,) index of the first segment of each command.
        follow: (C, 2) range of the segments that follow the programmed path; the others belong to a blend.
        free: (C, 2) True in the first column if a blend joins the path after its start, and in the second
            column if a blend leaves the path before its end.
        tolerance: (C,) tolerance of the position [m]. The number of pieces is chosen so that the remainder of
            the Hermite interpolation is a small fraction of the tolerance, `REMAINDER_SHARE`.
        angle: (C,) tolerance of the angle [rad], used in the same way as `tolerance`.
        speed: the programmed speeds of the C commands.
    """

    cubics: Cubics
    first: Rows
    follow: Rows
    free: NDArray[np.bool_]
    tolerance: Array
    angle: Array
    speed: Programmed


@frozen(eq=False)
class Followed:
    """Proved deviations and speeds of C commands.

    Attributes:
        position: (C,) largest deviations in position [m].
        angle: (C,) largest deviations in angle [rad].
        rest: (C,) part of `position` that bounds the error between sampled points [m].
        angle_rest: (C,) part of `angle` that bounds the error between sampled points [rad].
        covered: (C, 2) range of the path's parameter that was followed.
        speeds: speeds of the frame.
    """

    position: Array
    angle: Array
    rest: Array
    angle_rest: Array
    covered: Array
    speeds: Speeds


def follow(
    stretch: Stretch,
    paths: FramePaths,
    robot: Robot,
    claims: tuple[Array, int] | None = None,
    *,
    is_way: bool = False,
) -> Followed:
    """Bound the deviation of moving frames from their programmed paths.

    Notation: q(t) are the executed joint positions; p(q) and R(q) are the position and the rotation matrix of
    the moving frame; P(s) and R*(s) are the position and the rotation matrix of the programmed path at its
    parameter s; primes are derivatives; d is the duration of a piece of a segment.

    For any parameter s(t) that grows from 0 to 1, the distance at equal t bounds the distance between the
    paths. Here s(t) is piecewise cubic. At the points between pieces, s is the projection of the executed
    pose onto the programmed path, with position and angle weighted by their tolerances. On a piece, s(t) is
    the cubic Hermite interpolation of these values.

    On a piece, e(t) = p(q(t)) - P(s(t)) is at most its largest Bezier point plus the remainder d^4/384 M4. M4
    is the sum of the bounds for the fourth derivatives of p(q(t)) and of P(s(t)); for a line, the second
    bound is zero. Where s passes a jump of P''', e''' jumps by s'^3 times that jump. For the rotation, D =
    R(q(t)) - R*(s(t)) has the Frobenius norm 2 sqrt 2 sin(angle/2), and pieces are bounded in that norm.

    If a blend precedes or follows a command, s runs only from where the blend joins the path to where the
    next blend leaves it.

    Args:
        stretch: the segments of all C commands.
        paths: the programmed paths.
        robot: the arm.
        claims: for a single command, control values of a B-spline s(t) to try instead of the projection, and
            the index of the segment in which the B-spline begins.
        is_way: True if the values of `claims` are not s, but fractions of the path length of the frame's
            origin. They are then only the first guess of the projection.

    Returns:
        The deviations and speeds of all C commands.
    """
    cubics = stretch.cubics
    arm = _arm_bounds(stretch, paths, robot)
    # The remainder d^4/384 M4, with d = h / pieces and the bound M4 of the fourth derivative, falls with the
    # fourth power of the number of pieces. Find the number for which it is `REMAINDER_SHARE` of the
    # tolerance.
    need = HERMITE * cubics.h**4 / REMAINDER_SHARE * arm.need
    pieces = np.clip(np.ceil(need**0.25), 1, MOST_PIECES).astype(np.int64)
    pieces = finer_for_speed(pieces, cubics.h, arm.origin, arm.rotation, stretch.speed, arm.command)
    law = _Law(claims, is_way)
    followed = _followed(stretch, paths, robot, arm, pieces, law)
    # If a bound fails and the remainder takes a large part of it, try once with more pieces.
    need_more = np.maximum(followed.rest / stretch.tolerance, followed.angle_rest / stretch.angle)
    beyond = (followed.position > stretch.tolerance) | (followed.angle > stretch.angle)
    again = np.flatnonzero(paths.lawful & beyond & (need_more > 2.0 * REMAINDER_SHARE))
    if len(again) and not (pieces == MOST_PIECES).all():
        factor = np.ones(len(stretch.first))
        factor[again] = np.minimum(need_more[again] / REMAINDER_SHARE, 1e6) ** 0.25
        pieces = np.clip(np.ceil(pieces * factor[arm.command]), 1, MOST_PIECES).astype(np.int64)
        followed = _followed(stretch, paths, robot, arm, pieces, law)
    return followed


@frozen(eq=False)
class _Law:
    """The planner's claim about s(t) of a motion: `claims` and `is_way` as in `follow`."""

    claims: tuple[Array, int] | None
    is_way: bool


@frozen(eq=False)
class _Arm:
    """Bounds of the arm's motion on N segments, from which the number of pieces follows.

    Attributes:
        command: (N,) command of each segment.
        origin: (N,) bounds of the fourth derivative of the frame's origin [m/s^4].
        rotation: (N,) bounds of the fourth derivative of the frame's rotation matrix [1/s^4].
        need: (N,) fourth derivatives in units of the tolerance, which determine the number of pieces [1/s^4].
    """

    command: Rows
    origin: Array
    rotation: Array
    need: Array


def _arm_bounds(stretch: Stretch, paths: FramePaths, robot: Robot) -> _Arm:
    cubics, first = stretch.cubics, stretch.first
    command = np.repeat(np.arange(len(first)), np.diff(np.append(first, len(cubics.h))))
    origin, rotation = arm_bounds(cubics, command, paths.flange_from_moving, robot)
    # A rotation difference has a norm of about sqrt 2 times the angle. The programmed rotation adds about as
    # much as the executed one, hence the factor 2.
    turn = 2.0 * rotation / np.sqrt(2.0) / stretch.angle[command]
    return _Arm(command, origin, rotation, np.maximum(origin / stretch.tolerance[command], turn))


def _followed(
    stretch: Stretch,
    paths: FramePaths,
    robot: Robot,
    arm: _Arm,
    pieces: Rows,
    law: _Law,
) -> Followed:
    cut = Pieces.cut(stretch.cubics, arm.command, pieces)
    go_on()
    motion = frame_motion(robot.chain, cut, paths.flange_from_moving)
    go_on()
    speeds = _speeds(stretch, arm, cut, motion)
    go_on()
    count = len(stretch.first)
    position, angle, rest, angle_rest = (np.zeros(count) for _ in range(4))
    covered = np.tile([0.0, 1.0], (count, 1))
    # If blends cover a whole path, no part of it is followed. The ball of each blend must then contain a
    # fixed fraction of the path.
    nothing = stretch.follow[:, 0] >= stretch.follow[:, 1]
    covered[nothing] = covered_by_balls(stretch.free[nothing])[:, None]
    if nothing.any() or stretch.free.any():
        # Only pieces outside of blends are compared with the path.
        rows = cut.segment >= stretch.follow[cut.command, 0]
        rows &= cut.segment < stretch.follow[cut.command, 1]
        cut, motion = _only(cut, motion, rows)
    if len(cut.d):
        there = np.unique(cut.command)
        bounds = _bounds(stretch, paths, arm, cut, motion, law)
        position[there], angle[there], rest[there], angle_rest[there], covered[there] = bounds
    position[~paths.lawful] = angle[~paths.lawful] = np.inf
    return Followed(position, angle, rest, angle_rest, covered, speeds)


def _speeds(stretch: Stretch, arm: _Arm, cut: Pieces, motion: Motion) -> Speeds:
    wanted = stretch.speed
    low, high = speed_bounds(motion, cut.left, cut.d, arm.origin[cut.segment])
    go_on()
    if wanted.turns.any():
        turns = wanted.turns[cut.command]
        low_turn, high_turn = turn_bounds(motion, cut.left, cut.d, arm.rotation[cut.segment])
        low, high = np.where(turns, low_turn, low), np.where(turns, high_turn, high)
    return judged(low, high, cut.command, cut.segment, stretch.follow, wanted)


def _only(cut: Pieces, motion: Motion, rows: NDArray[np.bool_]) -> tuple[Pieces, Motion]:
    """Return some pieces, contiguous for each command, with the points between them."""
    left = cut.left[rows]
    points = np.zeros(len(cut.q), dtype=np.bool_)
    points[left] = points[left + 1] = True
    place = np.cumsum(points) - 1
    kept = Pieces(
        cut.segment[rows],
        cut.d[rows],
        cut.command[rows],
        place[left],
        cut.owner[points],
        cut.q[points],
        cut.rate[points],
    )
    p, velocity = motion.p[points], motion.velocity[points]
    return kept, Motion(p, velocity, motion.rotation[points], motion.angular[points], kept.d)


def _bounds(
    stretch: Stretch,
    paths: FramePaths,
    arm: _Arm,
    cut: Pieces,
    motion: Motion,
    law: _Law,
) -> tuple[Array, Array, Array, Array, Array]:
    """Bound the deviations of those commands that have pieces outside of blends.

    Returns:
        Deviations of position and angle, their remainders, and the range of the path that was followed.
    """
    claimed = None if law.claims is None else _claimed(*law.claims, cut, stretch.cubics.h)
    if claimed is None:
        s, s_rate = paths.project(motion, cut.owner, stretch.tolerance, stretch.angle)
    elif law.is_way:
        s, s_rate = paths.project(motion, cut.owner, stretch.tolerance, stretch.angle, claimed[0])
    else:
        s, s_rate = claimed
    left, right, d = cut.left, cut.left + 1, cut.d
    bezier_s = np.stack(hermite_bezier(s[left], s_rate[left], s[right], s_rate[right], d), axis=1)
    # The pieces of a command are consecutive: find the first and the last one.
    begins = np.flatnonzero(np.diff(cut.command, prepend=-1))
    ends = np.append(begins[1:], len(d)) - 1
    there = cut.command[begins]
    free = stretch.free[there]
    # The followed range of the path is from s = 0 to 1. Where a blend joins or leaves the path, the range
    # begins or ends instead at the s of the motion's first or last point.
    covered = np.clip(np.stack([bezier_s[begins, 0], bezier_s[ends, 3]], axis=1), 0.0, 1.0)
    covered = np.where(free, covered, [0.0, 1.0])
    group = np.repeat(np.arange(len(begins)), ends - begins + 1)
    lag = catch_up(bezier_s, group, covered=covered)
    parts = [
        _bounds_of(paths, arm, cut, motion, (s, s_rate), bezier_s, lag, slice(begin, begin + _AT_ONCE))
        for begin in range(0, len(d), _AT_ONCE)
    ]
    position, angle, rest, angle_rest = (
        segment_max(np.nan_to_num(np.concatenate(x), nan=np.inf), begins) for x in zip(*parts, strict=True)
    )
    return position, angle, rest, angle_rest, covered


def _bounds_of(
    paths: FramePaths,
    arm: _Arm,
    cut: Pieces,
    motion: Motion,
    law: tuple[Array, Array],
    bezier_s: Array,
    lag: Array,
    which: slice,
) -> tuple[Array, Array, Array, Array]:
    """Bound the deviations of position and angle, and their remainders, on some consecutive pieces.

    Args:
        paths: the programmed paths.
        arm: bounds of the arm's part of the remainder.
        cut: all pieces.
        motion: the frames at the points between the pieces.
        law: s and its rate at these points, (N,) each.
        bezier_s: (P, 4) Bezier points of s on all pieces.
        lag: (P,) distances of s from a parameter that never decreases, by `catch_up`.
        which: the pieces to bound.
    """
    # Select the points between these pieces.
    first = cut.left[which.start]
    left, segment, command = (x[which] for x in (cut.left, cut.segment, cut.command))
    d = cut.d[which]
    points = slice(first, left[-1] + 2)
    left = left - first
    right, bezier_s, lag = left + 1, bezier_s[which], lag[which]
    s, s_rate = (x[points] for x in law)
    go_on()
    path = paths.at(cut.owner[points], s)
    go_on()
    frames = Motion(
        motion.p[points], motion.velocity[points], motion.rotation[points], motion.angular[points], d
    )
    e, e_rate, turn, turn_rate = _errors(frames, path, s_rate)
    go_on()
    # By the hull property, s stays between its least and largest Bezier point on a piece.
    low, high = bezier_s.min(axis=1), bezier_s.max(axis=1)
    steep = paths.bounds(command, low, high)
    go_on()
    # Below, the lag is multiplied by a bound of the path's slope. This bound must also hold between s and the
    # non-decreasing parameter of `catch_up`.
    lifted = steep
    if not steep.everywhere:
        least = np.maximum(low - lag, np.minimum(low, 0.0))
        most = np.minimum(high + lag, np.maximum(high, 1.0))
        lifted = paths.bounds(command, least, most)
    go_on()
    # Add up the remainders of the Hermite interpolation: those of the path and those of the arm.
    rest, chord_rest = _remainders(bezier_s, d, steep)
    rest = rest + HERMITE * d**4 * arm.origin[segment]
    chord_rest = chord_rest + HERMITE * d**4 * arm.rotation[segment]
    # Add the distance at equal s and the length of path by which s may lag behind a non-decreasing parameter.
    position = hull(e, e_rate, left, right, d) + rest + lag * lifted.position[:, 0]
    chord = hull(turn, turn_rate, left, right, d)
    # The Frobenius norm of a rotation's derivative is sqrt 2 times its angular speed.
    angle_lag = lag * lifted.rotation[:, 0] / np.sqrt(2.0)
    angle = np.minimum(angle_of_chord(chord + chord_rest) + angle_lag, np.pi)
    angle_rest = angle_of_chord(chord + chord_rest) - angle_of_chord(chord)
    return position, angle, rest, angle_rest


def _errors(motion: Motion, path: Poses, s_rate: Array) -> tuple[Array, Array, Array, Array]:
    """Return the errors of position (N, 3) and rotation (N, 9), executed minus programmed, and their
    rates.
    """
    e = motion.p - path.p
    # By the chain rule, the position P(s) on the path changes at the rate s' P'(s). The columns of the
    # frame's rotation change at the rate omega x column, with the angular velocity omega.
    e_rate = motion.velocity - s_rate[:, None] * path.along
    turn = motion.rotation - path.rotation
    turn_rate = np.cross(motion.angular[:, :, None], motion.rotation, axis=1)
    turn_rate -= s_rate[:, None, None] * path.spin
    return e, e_rate, turn.reshape(-1, 9), turn_rate.reshape(-1, 9)


def _remainders(bezier_s: Array, d: Array, steep: Bounds) -> tuple[Array, Array]:
    """Return the remainders of position and rotation (P,) as far as the programmed path causes them."""
    # Compute the Bezier points of s' and s'', and s''', which is constant since s(t) is a cubic.
    ds = np.diff(bezier_s, axis=1) * (3.0 / d)[:, None]
    dds = np.diff(ds, axis=1) * (2.0 / d)[:, None]
    s3 = np.abs(np.diff(dds, axis=1)[:, 0]) / d
    s1, s2 = np.abs(ds).max(axis=1), np.abs(dds).max(axis=1)
    scale = HERMITE * d**4
    position = np.zeros(len(d)) if steep.straight else scale * path_fourth(steep.position, s1, s2, s3)
    rotation = scale * path_fourth(steep.rotation, s1, s2, s3)
    # The cubic s(t) takes a value once, or at most three times if it turns back.
    passes = np.where((ds.min(axis=1) < 0.0) & (ds.max(axis=1) > 0.0), 3.0, 1.0)
    if steep.position_jump is not None:
        position = position + JUMP * passes * (d * s1) ** 3 * steep.position_jump
    if steep.rotation_jump is not None:
        rotation = rotation + JUMP * passes * (d * s1) ** 3 * steep.rotation_jump
    return position, rotation


def _claimed(control: Array, begins: int, cut: Pieces, h: Array) -> tuple[Array, Array]:
    """Return the values and derivatives of a claimed cubic B-spline s(t) at the points between pieces.

    Args:
        control: control values of the B-spline.
        begins: number of the segment at which the B-spline begins.
        cut: the pieces.
        h: durations of the segments [s].
    """
    # Each point between pieces is in segment k, at the fraction u of its duration; the last point is a
    # segment's end.
    k = np.append(cut.segment, cut.segment[-1]) - begins
    start = np.append(np.flatnonzero(np.diff(cut.segment, prepend=-1)), len(cut.segment))
    size = np.diff(start)
    number = np.arange(len(cut.segment)) - np.repeat(start[:-1], size)
    # Compute u: the number of the piece within its segment, divided by the number of pieces of that segment.
    u = np.append(number / np.repeat(size, size), 1.0)
    # Use the basis functions of the uniform cubic B-spline at u in [0, 1], times 6, and their derivatives,
    # times 2.
    w = 1.0 - u
    f0, f1, f2, f3 = (control[k + i] for i in range(4))
    s = (
        w**3 * f0 + (3 * u**3 - 6 * u**2 + 4) * f1 + (-3 * u**3 + 3 * u**2 + 3 * u + 1) * f2 + u**3 * f3
    ) / 6.0
    rate = w**2 * (f1 - f0) + (1 + 2 * u - 2 * u**2) * (f2 - f1) + u**2 * (f3 - f2)
    return s, rate / (2.0 * h[cut.segment[0]])
