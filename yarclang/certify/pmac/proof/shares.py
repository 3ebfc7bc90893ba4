"""Path parameters s(t) for a proof: the fraction of its programmed path that a motion has covered at each
instant.

The checker accepts any s(t) that grows from 0 to 1; a good one gives sharp bounds.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from yarclang import hir
from yarclang.certify.motion.bounds import HERMITE, HERMITE_RATE, Cubics
from yarclang.certify.motion.pieces import Pieces, arm_bounds, frame_motion
from yarclang.certify.motion.posespline import PoseSpline
from yarclang.certify.motion.programmed import Arcs, Lines, Motion
from yarclang.certify.motion.project import guess_by_length, project
from yarclang.certify.motion.spline import NaturalSpline
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.verify.paths import SHARE

_REMAINDER = 0.2
"""Approximate fraction of the tolerance that the error between the ends of pieces may take up."""
_MOST_PIECES = 64
_BESIDE = 0.011
"""Least fraction of an arc between its via point and either end. The checker's own bound is slightly smaller.
"""
_OPEN = 1 / 250
"""Least angle by which an arc must be smaller than a full circle [rad]. The checker's own bound is slightly
smaller.
"""
_NEAREST = 2e-4
"""Least distance between waypoints of a spline [rad or m]. The checker's own bound is slightly smaller."""
_COARSE = 4.0
"""Approximate factor between the checker's bound of a pose spline's fourth derivative and the judge's bound.
"""
_SHARP = 2e-4
"""Approximate fraction of a programmed speed that the error between the ends of pieces may take up."""


@frozen(eq=False)
class Own:
    """The segments that follow the path of a motion, and their description in the proof.

    Attributes:
        cubics: the segments; the first and the last one are cut where a blend joins or leaves the path.
        ends: s at the first and at the last instant; None if a blend joins or leaves the path in its middle.
        told: the instants at which the path is joined and left, if these aren't the motion's start and end.
    """

    cubics: Cubics
    ends: tuple[float | None, float | None]
    told: dict[str, int]


def frame_proof(
    own: Own,
    motion: hir.LineMove | hir.ArcMove,
    start: Array,
    goal: Array,
    robot: Robot,
    tolerance: Tolerance,
) -> dict[str, Any] | str:
    """Return the proof of a line or an arc, or a string with the reason why there is none.

    There is no proof for an arc whose ends and via point are so close to each other that they don't define
    its circle exactly.

    Args:
        own: the segments that follow the motion's path.
        motion: the motion as programmed.
        start: (4, 4) base_from_moving at the start of the path.
        goal: (4, 4) base_from_moving at the end of the path.
        robot: the arm.
        tolerance: tolerance of this motion.
    """
    cubics, frame = own.cubics, motion.goal.flange_from_moving
    proof: dict[str, Any] = {}
    paths: Lines | Arcs
    if isinstance(motion, hir.ArcMove):
        paths = Arcs.through(start[None], motion.via[None], goal[None], frame[None])
        proof = _arc(paths, motion.via)
        if not _BESIDE < proof["via"] < 1.0 - _BESIDE:
            return "its path, an arc whose via point is beside one of its ends"
        if proof["sweep"] > 2.0 * np.pi - _OPEN:
            return "its path, an arc that is a full circle but for a little"
    else:
        paths = Lines.between(start[None], goal[None], frame[None])
    axis, angle = paths.turns.axis[0], float(paths.turns.theta[0])
    if not axis.any():
        axis, angle = np.array([0.0, 0.0, 1.0]), 0.0
    proof |= {"axis": axis.tolist(), "angle": angle, **own.told}
    if not len(cubics.h):  # blends take the whole path
        return proof | _nowhere(own)
    owner = np.zeros(len(cubics.h), dtype=np.int64)
    origin, rotation = arm_bounds(cubics, owner, frame[None], robot)
    # The factor sqrt 2 is 2 / sqrt 2: the programmed rotation adds as much to the error as the executed one,
    # and the checker measures rotations by chords, which are about sqrt 2 times the angle.
    need = np.maximum(origin / tolerance.position, math.sqrt(2.0) * rotation / tolerance.angle)
    count = _pieces(float((HERMITE * cubics.h**4 * need).max()))
    if (speed := motion.timing.speed) is not None and speed.length:
        # The error of a speed's bounds must be a small part of the tolerance of the speed.
        most = float((cubics.h * np.cbrt(HERMITE_RATE * origin / (_SHARP * speed.length))).max())
        count = min(max(count, math.ceil(most)), _MOST_PIECES)
    cut = Pieces.cut(cubics, owner, np.full(len(cubics.h), count))
    executed = frame_motion(robot.chain, cut, frame[None])
    s, rate = _projected(paths, executed, cut, tolerance)
    return proof | _growing(s, rate, cut.d, count, own.ends)


def pose_spline_proof(
    own: Own, poses: Array, frame: Array, robot: Robot, tolerance: Tolerance, timing: hir.Timing
) -> dict[str, Any] | str:
    """Return the proof of a spline of poses, or a string with the reason why there is none.

    Args:
        own: the segments that follow the motion's path.
        poses: (m, 4, 4) base_from_moving at the start and at the waypoints.
        frame: (4, 4) flange_from_moving.
        robot: the arm.
        tolerance: tolerance of this motion.
        timing: programmed duration or speed of this motion.
    """
    cubics = own.cubics
    spline = PoseSpline.through(poses, frame, (own.ends[0] is None, own.ends[1] is None))
    if spline is None or len(spline.spline.y) < len(poses) or np.diff(spline.spline.s).min() < _NEAREST:
        return "its path, a spline of poses with waypoints side by side"
    quaternions = spline.spline.y[:, 3:]
    apart = np.linalg.norm(np.diff(quaternions, axis=0), axis=1)
    # Unit quaternions a and b that differ by a rotation by theta have |a - b| = 2 sin(theta / 4).
    turns = (4.0 * np.arcsin(np.minimum(apart / 2.0, 1.0))).tolist()
    proof = {"quaternions": quaternions.tolist(), "turns": turns, **own.told}
    if not len(cubics.h):  # blends take the whole path
        return proof | _nowhere(own)
    owner = np.zeros(len(cubics.h), dtype=np.int64)
    origin, rotation = arm_bounds(cubics, owner, frame[None], robot)
    rough = Pieces.cut(cubics, owner, np.ones(len(cubics.h), dtype=np.int64))
    _, rate = _projected(spline, frame_motion(robot.chain, rough, frame[None]), rough, tolerance)
    # Estimate |s'| and |s''| from a rough projection, and the path's fourth derivative by Faa di Bruno's
    # formula.
    w, a = float(np.abs(rate).max()), float((np.abs(np.diff(rate)) / rough.d).max())
    # Scale the bounds from u to s = u / u_total: the k-th derivative gets the factor u_total^k.
    most = spline.cells.max(axis=0) * spline.total ** np.arange(1.0, 5.0)[:, None]
    along = _COARSE * (most[3] * w**4 + 6.0 * most[2] * w * w * a + 3.0 * most[1] * a * a)
    need = np.maximum(
        (origin + along[0]) / tolerance.position, math.sqrt(2.0) * (rotation + along[1]) / tolerance.angle
    )
    count = _pieces(float((HERMITE * cubics.h**4 * need).max()))
    if timing.speed is not None and timing.speed.length:
        sharp = float((cubics.h * np.cbrt(HERMITE_RATE * origin / (_SHARP * timing.speed.length))).max())
        count = min(max(count, math.ceil(sharp)), _MOST_PIECES)
    cut = Pieces.cut(cubics, owner, np.full(len(cubics.h), count))
    s, rate = _projected(spline, frame_motion(robot.chain, cut, frame[None]), cut, tolerance)
    return proof | _growing(s, rate, cut.d, count, own.ends)


def joint_proof(own: Own, start: Array, goal: Array, weights: Array) -> dict[str, Any]:
    """Return the proof of a straight joint motion.

    At the ends of pieces, s is the path parameter of the line's point that is nearest to the motion.

    Args:
        own: the segments that follow the motion's path.
        start: (n,) joint positions at the start of the path [rad or m].
        goal: (n,) joint positions at the end of the path [rad or m].
        weights: (n,) reciprocal of the tolerance of each joint.
    """
    cubics, way = own.cubics, (goal - start) * weights
    count = len(cubics.h)
    if not count:  # blends take the whole path
        return _nowhere(own)
    cut = Pieces.cut(cubics, np.zeros(count, dtype=np.int64), np.ones(count, dtype=np.int64))
    # Project the joint positions onto the line, with each joint in units of its tolerance.
    square = float(way @ way)
    if square > 0.0:
        s, rate = ((cut.q - start) * weights) @ way / square, (cut.rate * weights) @ way / square
    else:
        s, rate = np.linspace(0.0, 1.0, count + 1), np.zeros(count + 1)
    return own.told | _growing(s, rate, cut.d, 1, own.ends)


def corner_pieces(cubics: Cubics, frame: Array, robot: Robot, ball: float, angle: float) -> int:
    """Return the number of pieces into which each segment of a blend is cut.

    The bounds between the ends of pieces must be small compared with the blend's ball [m] and angle [rad].
    """
    origin, rotation = arm_bounds(cubics, np.zeros(len(cubics.h), dtype=np.int64), frame[None], robot)
    need = np.maximum(origin / ball, math.sqrt(2.0) * rotation / angle)
    return min(4 * _pieces(float((HERMITE * cubics.h**4 * need).max())), _MOST_PIECES)


def _arc(paths: Arcs, via: Array) -> dict[str, Any]:
    centre, spoke, side, sweep = paths.centre[0], paths.spoke[0], paths.side[0], float(paths.sweep[0])
    away = via - centre
    # Compute the angle of the via point about the arc's axis, counted from the spoke to the start, as a
    # fraction of the sweep.
    share = float(np.arctan2(away @ side, away @ spoke)) % (2.0 * np.pi) / sweep
    return {
        "centre": centre.tolist(),
        "spoke": spoke.tolist(),
        "side": side.tolist(),
        "sweep": sweep,
        "via": share,
    }


def _projected(
    paths: Lines | Arcs | PoseSpline, executed: Motion, cut: Pieces, tolerance: Tolerance
) -> tuple[Array, Array]:
    one = np.array([tolerance.position]), np.array([tolerance.angle])
    return paths.project(executed, cut.owner, *one)


def spline_proof(own: Own, points: Array, weights: Array, law: Array | None) -> dict[str, Any] | str | None:
    """Return the proof of a natural spline in joint space.

    The result is None if the spline has length zero. It is a string with the reason if two waypoints are too
    close to each other.

    Args:
        own: the segments that follow the motion's path.
        points: (m, n) start of the motion, and its waypoints [rad or m].
        weights: (n,) reciprocal of the tolerance of each joint.
        law: s(t) as the planner claims it, as control values of a cubic B-spline; it is used if it covers the
            segments.
    """
    spline = NaturalSpline.through(points)
    if len(spline.y) == 1:
        return None
    if len(points) > 2 and np.diff(spline.s).min() < _NEAREST:
        return "its path, a spline with waypoints side by side"
    cubics = own.cubics
    size = len(cubics.h)
    if not size:  # blends take the whole path
        return _nowhere(own)
    owner = np.zeros(size, dtype=np.int64)
    count = _pieces(_spline_need(cubics, spline, weights))
    cut = Pieces.cut(cubics, owner, np.full(size, count))
    if law is not None and law.shape == (size + 3,) and np.isfinite(law).all() and not own.told:
        shares = Cubics.of_spline(law[:, None], np.arange(size), cubics.h)
        along = Pieces.cut(shares, owner, np.full(size, count))
        return _growing(along.q[:, 0], along.rate[:, 0], cut.d, count)
    end = float(spline.s[-1])
    free = own.ends[0] is None, own.ends[1] is None
    guess, pace = guess_by_length(_Weighed(spline, weights), cut.q * weights, spline.s, free)
    s, rate = project(_Weighed(spline, weights), cut.q * weights, cut.rate * weights, guess, pace, cut.d)
    return own.told | _growing(s / end, rate / end, cut.d, count, own.ends)


def _nowhere(own: Own) -> dict[str, Any]:
    """Return the proof of a motion whose whole path is cut off by blends."""
    share = own.ends[0] if own.ends[0] is not None else own.ends[1]
    return own.told | {"pieces": 1, "s": [round((0.5 if share is None else share) * SHARE)], "rates": [0]}


class _Weighed:
    """A spline in joint coordinates that are divided by their tolerances."""

    def __init__(self, spline: NaturalSpline, weights: Array) -> None:
        self._spline, self._weights = spline, weights

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return the position y and its derivative y' at the path parameters `s` (N,)."""
        y, slope = self._spline.at(s)
        return y * self._weights, slope * self._weights


def _spline_need(cubics: Cubics, spline: NaturalSpline, weights: Array) -> float:
    """Return the approximate bound of the error between the ends of uncut segments, as a fraction of the
    tolerance.
    """
    # On each chord between two waypoints, take the slope of the joint that moves most there; then take the
    # smallest of these slopes.
    steepest = np.maximum(np.abs(np.diff(spline.y, axis=0)).max(axis=1) / np.diff(spline.s), 1e-3).min()
    w = cubics.velocity_peaks().max(axis=1) / steepest
    a = cubics.acceleration_peaks().max(axis=1) / steepest
    j = cubics.jerk_peaks().max(axis=1) / steepest
    bend = (np.abs(spline.bend) * weights).max()
    third = (np.abs(np.diff(spline.bend, axis=0)) / np.diff(spline.s)[:, None] * weights).max()
    # Estimate s', s'' and s''' from the joints' rates over the slope of the path. Faa di Bruno's formula then
    # gives the fourth derivative.
    fourth = 6.0 * w * w * a * third + (3.0 * a * a + 4.0 * w * j) * bend
    return float((HERMITE * cubics.h**4 * fourth + cubics.h**3 * w**3 * third / 96.0).max())


def _pieces(need: float) -> int:
    """Return the number of pieces of a segment that makes the bound `need` of an uncut segment small enough.

    The bound falls with the fourth power of this number.
    """
    return int(np.clip(math.ceil((need / _REMAINDER) ** 0.25), 1, _MOST_PIECES))


def _growing(
    s: Array, rate: Array, d: Array, pieces: int, ends: tuple[float | None, float | None] = (0.0, 1.0)
) -> dict[str, Any]:
    """Return s and s' as integers, changed slightly so that the cubics between them never decrease.

    Args:
        s: (P + 1,) path parameters at the ends of pieces.
        rate: (P + 1,) derivatives s' at the ends of pieces [1/s].
        d: (P,) durations of the pieces [s].
        pieces: number of pieces of each segment.
        ends: required s at the first and at the last instant; None to keep the value in `s`.
    """
    share = np.clip(s, 0.0, 1.0)
    share[0], share[-1] = (
        old if end is None else end for old, end in zip((share[0], share[-1]), ends, strict=True)
    )
    # Round s to integers that never decrease.
    share = np.round(np.maximum.accumulate(share) * SHARE)
    if ends[1] is not None:
        share = np.minimum(share, round(ends[1] * SHARE))
    # The inner Bezier points of a piece are in order if the sum of the rates at its ends, times a third of
    # its duration, is at most the increase of s.
    rate = np.maximum(rate, 0.0) * SHARE
    way, both = 3.0 * np.diff(share) / d, rate[:-1] + rate[1:]
    with np.errstate(over="ignore"):  # if both rates are 0, the quotient may be infinite
        allowed = np.minimum(1.0, way * (1.0 - 1e-12) / np.maximum(both, 1e-300))
    # Each rate belongs to the ends of two pieces and must be small enough for both.
    rate *= np.minimum(np.append(allowed, 1.0), np.append(1.0, allowed))
    return {
        "pieces": pieces,
        "s": [int(one) for one in share],
        "rates": [int(one) for one in np.floor(rate)],
    }
