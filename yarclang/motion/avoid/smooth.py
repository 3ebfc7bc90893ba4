"""Turn a joint-space polyline into waypoints whose natural spline is proved to be free of collisions. The
natural spline has a continuous acceleration.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.collision.course import Course
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.avoid.room import Room
from yarclang.motion.natural import NaturalSpline
from yarclang.motion.paths.spline import distinct, through

GRID = 0.01
"""Grid to which waypoints are rounded [deg or mm], so that they can be written with two decimals."""

_ROUNDS = 14
"""Largest number of rounds in which waypoints are added to a curve that collides."""

_SHORTEST = 0.01
"""Least distance between neighbouring waypoints [rad or m]. A shorter leg isn't divided further, since
additional waypoints wouldn't help.
"""

_MOST = 60
"""The largest number of waypoints."""

_PIECES = 4
"""Number of pieces into which a leg is divided for the proof; the largest speed is determined for each
piece.
"""


@frozen(eq=False)
class Bend:
    """The surroundings of a curve in joint space, and the clearance that the curve must keep.

    `free` is a function that returns True for joint positions without collision; positions are checked about
    `step` (n,) apart [rad or m]. `more` (K,) is the distance that pairs of bodies are proved to keep in
    addition to their margins [m].
    """

    room: Room
    free: Callable[[Array], bool]
    step: Array
    more: Array

    def curve(self, points: Array) -> NaturalSpline:
        """Return the natural spline through waypoints (w, n), the first of which is the start."""
        return through(points, self.room.robot.chain.is_prismatic).spline

    def seen(self, curve: NaturalSpline) -> Array:
        """Return places s (T,) at which samples of a curve are beyond joint limits. If none is, return places
        at which samples collide.
        """
        beyond = _swings_out(self.room, curve)
        return beyond if len(beyond) else _hits(curve, self.free, self.step)

    def doubts(self, curve: NaturalSpline) -> Array:
        """Return places s (T,) at which a curve isn't proved to be free of collisions."""
        return self.room.doubts(course_of(curve), self.more)


def smooth(bend: Bend, corners: Array) -> Array | None:
    """Return waypoints (k, n), without the start, whose natural spline is proved to be free of collisions;
    None if none are found.

    Args:
        bend: the clearance to keep.
        corners: (w, n) the corners [rad or m] of a joint-space polyline that is free of collisions.
    """
    unit = bend.room.robot.axis_units * GRID
    points = corners.copy()
    points[1:-1] = np.round(points[1:-1] / unit) * unit
    points = distinct(points)
    for _ in range(_ROUNDS):
        curve = bend.curve(points)
        wrong = bend.seen(curve)
        if not len(wrong):
            fewer = _fewer(bend, points)
            if not len(bend.doubts(bend.curve(fewer))):
                return fewer[1:]
            wrong = bend.doubts(curve)
        if not len(wrong):
            return points[1:]
        finer = _between(points, curve, wrong, unit)
        if len(finer) == len(points) or len(finer) > _MOST:
            return None
        points = finer
    return None


def _fewer(bend: Bend, points: Array) -> Array:
    """Return fewer waypoints (w, n), the start included, with which the curve still avoids all obstacles.

    A waypoint is removed if samples show that the curve stays free without it. Each remaining waypoint is
    moved towards the straight line between its neighbours if the curve stays free. This makes the curve
    shorter, with fewer bends.
    """
    at = 1
    while at < len(points) - 1 and len(points) > 3:
        # Removing a waypoint changes the spline everywhere, so the whole curve is sampled.
        candidate = np.delete(points, at, axis=0)
        if len(bend.seen(bend.curve(candidate))):
            at += 1
        else:
            points = candidate
    unit = bend.room.robot.axis_units * GRID

    def tried(at: int, q: Array) -> Array | None:
        candidate = points.copy()
        candidate[at] = np.round(q / unit) * unit
        if len(distinct(candidate)) < len(points) or len(bend.seen(bend.curve(candidate))):
            return None
        return candidate

    for at in range(1, len(points) - 1):
        for joint in np.argsort(bend.step)[::-1]:  # the joint that moves bodies least comes first
            q = points[at].copy()
            q[joint] = _straight(points, at)[joint]
            found = tried(at, q)
            points = points if found is None else found
        for part in _PULLS:
            found = tried(at, points[at] + part * (_straight(points, at) - points[at]))
            if found is not None:
                points = found
                break
    return points


def _straight(points: Array, at: int) -> Array:
    """Return the place (n,) for a waypoint on the straight line between its neighbours in joint space."""
    before, behind = points[at - 1], points[at + 1]
    chord = behind - before
    share = float((points[at] - before) @ chord / max(float(chord @ chord), 1e-12))
    place: Array = before + np.clip(share, 0.2, 0.8) * chord
    return place


_PULLS = (0.75, 0.5, 0.25)
"""Shares of a waypoint's distance from the straight line between its neighbours by which the waypoint is
moved towards this line.
"""


def course_of(curve: NaturalSpline) -> Course:
    """Return a spline as a timed motion for the collision proof: the parameter of the spline, from 0 to 1, is
    the time [s].
    """
    width = np.diff(curve.knots)
    begin = (curve.knots[:-1, None] + width[:, None] * np.arange(_PIECES) / _PIECES).ravel()
    h = np.repeat(width / _PIECES, _PIECES)
    leg = np.repeat(np.arange(len(width)), _PIECES)
    # y'' is linear on a leg: its slope is the jerk, and its value at the start of each piece follows from it.
    jerk = (np.diff(curve.bends, axis=0) / width[:, None])[leg]
    bend = curve.bends[leg] + (begin - curve.knots[leg])[:, None] * jerk
    slope = curve.slope_at(begin)
    # The slope is a parabola, which is largest at an end or at its vertex.
    end = slope + h[:, None] * (bend + h[:, None] * jerk / 2.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.where(jerk != 0.0, -bend / jerk, -1.0)
    inside = (turn > 0.0) & (turn < h[:, None])
    # At the vertex t = -bend / jerk the slope is slope - bend^2 / (2 jerk).
    top = np.where(inside, slope + turn * bend / 2.0, slope)
    peaks = np.maximum.reduce([np.abs(slope), np.abs(end), np.abs(top)])
    return Course.of(curve.at(begin), slope, bend, jerk, h, peaks)


def straight_course(start: Array, goal: Array) -> Course:
    """Return the straight motion in joint space between two joint positions (n,), with a duration of 1 s."""
    way = (goal - start)[None]
    return Course.of(start[None], way, np.zeros_like(way), np.zeros_like(way), np.ones(1), np.abs(way))


def _swings_out(room: Room, curve: NaturalSpline) -> Array:
    """Return places s (T,) at which samples of a curve are beyond joint limits."""
    low, low_at, high, high_at = curve.extremes()
    limits, slack = room.robot.limits, 1e-9 * room.robot.axis_units
    return np.concatenate([low_at[low < limits.lower - slack], high_at[high > limits.upper + slack]])


def _hits(curve: NaturalSpline, free: Callable[[Array], bool], step: Array) -> Array:
    """Return places s (T,) at which samples of a curve collide. Samples are at most about `step` (n,)
    apart.
    """
    legs = np.abs(np.diff(curve.values, axis=0)) / step
    counts = np.clip(np.ceil(1.2 * np.sqrt(np.square(legs).sum(axis=1))), 2, 400).astype(np.int64)
    s = np.concatenate(
        [
            curve.knots[leg] + (curve.knots[leg + 1] - curve.knots[leg]) * (np.arange(count) + 0.5) / count
            for leg, count in enumerate(counts.tolist())
        ]
    )
    # The two ends of the curve aren't among the samples, since they are given.
    return s[[not free(q) for q in curve.at(s)]]


def _between(points: Array, curve: NaturalSpline, wrong: Array, unit: Array) -> Array:
    """Return the waypoints, with a new one in the middle of each leg on which the curve collides."""
    legs = np.unique(np.clip(np.searchsorted(curve.knots, wrong, side="right") - 1, 0, len(points) - 2))
    legs = legs[np.linalg.norm(points[legs + 1] - points[legs], axis=1) > 2.0 * _SHORTEST]
    middles = np.round((points[legs] + points[legs + 1]) / 2.0 / unit) * unit
    return np.insert(points, legs + 1, middles, axis=0)
