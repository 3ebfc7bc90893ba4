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
"""Share of the tolerance that the remainder of the proof (the bound of the error between sampled points) may
take. It determines the number of pieces.
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
            the proof is a small share of it, `REMAINDER_SHARE`.
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
    bound is zero. Where s passes a jump of P''', e''' jumps by s'^3 times that jump. For the turn, D =
    R(q(t)) - R*(s(t)) has the Frobenius norm 2 sqrt 2 sin(angle/2), and pieces are bounded in that norm.

    If a blend precedes or follows a command, s runs only from where the blend joins the path to where the
    next blend leaves it.

    Args:
        stretch: the segments of all C commands.
        paths: the programmed paths.
        robot: the arm.
        claims: for a single command, control values of s over time to try instead of the projection, and the
            index of the segment in which that B-spline begins.
        is_way: True if `claims` are shares of the path length of the frame's origin, not s. The projection
            then starts from them.

    Returns:
        The deviations and speeds of all C commands.
    """
    cubics = stretch.cubics
    arm = _arm_bounds(stretch, paths, robot)
    # The remainder falls with the fourth power of the number of pieces.
    need = HERMITE * cubics.h**4 / REMAINDER_SHARE * arm.need
    pieces = np.clip(np.ceil(need**0.25), 1, MOST_PIECES).astype(np.int64)
    pieces = finer_for_speed(pieces, cubics.h, arm.origin, arm.rotation, stretch.speed, arm.command)
    law = _Law(claims, is_way)
    found = _followed(stretch, paths, robot, arm, pieces, law)
    # If a bound fails and the remainder takes a large part of it, try once with more pieces.
    need_more = np.maximum(found.rest / stretch.tolerance, found.angle_rest / stretch.angle)
    beyond = (found.position > stretch.tolerance) | (found.angle > stretch.angle)
    again = np.flatnonzero(paths.lawful & beyond & (need_more > 2.0 * REMAINDER_SHARE))
    if len(again) and not (pieces == MOST_PIECES).all():
        factor = np.ones(len(stretch.first))
        factor[again] = np.minimum(need_more[again] / REMAINDER_SHARE, 1e6) ** 0.25
        pieces = np.clip(np.ceil(pieces * factor[arm.command]), 1, MOST_PIECES).astype(np.int64)
        found = _followed(stretch, paths, robot, arm, pieces, law)
    return found


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
    # A rotation difference has a norm of about sqrt 2 times the angle; the programmed turn adds about as much
    # again, hence the factor 2.
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
    # A motion whose path is covered by its blends follows no part of it; the balls then cover fixed shares.
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
    # A motion with a free end joins or leaves the path at the s of its first or last point. Otherwise it must
    # cover the path up to its end.
    covered = np.clip(np.stack([bezier_s[begins, 0], bezier_s[ends, 3]], axis=1), 0.0, 1.0)
    covered = np.where(free, covered, [0.0, 1.0])
    group = np.repeat(np.arange(len(begins)), ends - begins + 1)
    behind = catch_up(bezier_s, group, covered=covered)
    parts = [
        _bounds_of(paths, arm, cut, motion, (s, s_rate), bezier_s, behind, slice(begin, begin + _AT_ONCE))
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
    behind: Array,
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
        behind: (P,) distances of s from a parameter that never decreases, by `catch_up`.
        which: the pieces to bound.
    """
    # Take only the points of these pieces.
    first = cut.left[which.start]
    left, segment, command = (x[which] for x in (cut.left, cut.segment, cut.command))
    d = cut.d[which]
    points = slice(first, left[-1] + 2)
    left = left - first
    right, bezier_s, behind = left + 1, bezier_s[which], behind[which]
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
    # The lag of s is measured along the path between s and the non-decreasing parameter of `catch_up`.
    lifted = steep
    if not steep.everywhere:
        least = np.maximum(low - behind, np.minimum(low, 0.0))
        most = np.minimum(high + behind, np.maximum(high, 1.0))
        lifted = paths.bounds(command, least, most)
    go_on()
    # Remainders of the Hermite interpolation: the path's part and the arm's part.
    rest, chord_rest = _remainders(bezier_s, d, steep)
    rest = rest + HERMITE * d**4 * arm.origin[segment]
    chord_rest = chord_rest + HERMITE * d**4 * arm.rotation[segment]
    # Distance at equal s, plus the length of path by which s may lag behind a non-decreasing parameter.
    position = hull(e, e_rate, left, right, d) + rest + behind * lifted.position[:, 0]
    chord = hull(turn, turn_rate, left, right, d)
    # The Frobenius norm of a rotation's derivative is sqrt 2 times its angular speed.
    lag = behind * lifted.rotation[:, 0] / np.sqrt(2.0)
    angle = np.minimum(angle_of_chord(chord + chord_rest) + lag, np.pi)
    angle_rest = angle_of_chord(chord + chord_rest) - angle_of_chord(chord)
    return position, angle, rest, angle_rest


def _errors(motion: Motion, path: Poses, s_rate: Array) -> tuple[Array, Array, Array, Array]:
    """Return the errors of position (N, 3) and rotation (N, 9), executed minus programmed, and their
    rates.
    """
    e = motion.p - path.p
    # Chain rule: d/dt P(s(t)) = s' P'(s), and R' = [omega]x R.
    e_rate = motion.velocity - s_rate[:, None] * path.along
    turn = motion.rotation - path.rotation
    turn_rate = np.cross(motion.angular[:, :, None], motion.rotation, axis=1)
    turn_rate -= s_rate[:, None, None] * path.spin
    return e, e_rate, turn.reshape(-1, 9), turn_rate.reshape(-1, 9)


def _remainders(bezier_s: Array, d: Array, steep: Bounds) -> tuple[Array, Array]:
    """Return the remainders of position and rotation (P,) as far as the programmed path causes them."""
    # Bezier points of s' and s'', and the constant s''' of the cubic s(t).
    ds = np.diff(bezier_s, axis=1) * (3.0 / d)[:, None]
    dds = np.diff(ds, axis=1) * (2.0 / d)[:, None]
    s3 = np.abs(np.diff(dds, axis=1)[:, 0]) / d
    s1, s2 = np.abs(ds).max(axis=1), np.abs(dds).max(axis=1)
    scale = HERMITE * d**4
    position = np.zeros(len(d)) if steep.straight else scale * path_fourth(steep.position, s1, s2, s3)
    rotation = scale * path_fourth(steep.rotation, s1, s2, s3)
    # A cubic passes a place once, or at most three times if it turns back.
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
    # Each point between pieces is at the share u of segment k; the last point ends its segment.
    k = np.append(cut.segment, cut.segment[-1]) - begins
    start = np.append(np.flatnonzero(np.diff(cut.segment, prepend=-1)), len(cut.segment))
    size = np.diff(start)
    number = np.arange(len(cut.segment)) - np.repeat(start[:-1], size)
    u = np.append(number / np.repeat(size, size), 1.0)
    # Basis functions of the uniform cubic B-spline at u in [0, 1], times 6, and their derivatives, times 2.
    w = 1.0 - u
    f0, f1, f2, f3 = (control[k + i] for i in range(4))
    s = (
        w**3 * f0 + (3 * u**3 - 6 * u**2 + 4) * f1 + (-3 * u**3 + 3 * u**2 + 3 * u + 1) * f2 + u**3 * f3
    ) / 6.0
    rate = w**2 * (f1 - f0) + (1 + 2 * u - 2 * u**2) * (f2 - f1) + u**2 * (f3 - f2)
    return s, rate / (2.0 * h[cut.segment[0]])
