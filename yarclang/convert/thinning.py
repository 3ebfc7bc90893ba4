"""Reduce the number of targets of a motion: select targets that are sufficient for a tolerance.

The algorithm is that of Douglas and Peucker (Cartographica 10, 1973, 112-122). A chord from the first to the
last target is divided at the target farthest from it. This is repeated for both parts of the motion until no
target is farther away than the tolerance. If the program follows a spline, the first targets are chosen with
chords and a coarse tolerance; then distances are measured to the spline.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.convert.course import Course, Form
from yarclang.hir import Array
from yarclang.motion.paths.spline import distinct, through
from yarclang.robot.model import Robot

_SAMPLES = 16
"""Number of chords that approximate the spline between two kept targets."""
_COARSE = 50
"""The first targets of a spline are chosen as for straight lines, with the tolerance times this factor,
because a spline needs far fewer targets than straight lines do.
"""


def thinned(course: Course, every: int, tolerance: float | None, robot: Robot, form: Form) -> Course:
    """Return a course (a motion) with fewer targets. The first and the last target are always kept.

    The tolerance applies to all joints together (root of the sum of squares), or to position and orientation
    of a pose together. Distances are measured to the path that the program will follow. For joint values in
    the form `spline`, this is the spline in joint space; in the form `timed`, it is the position on the path
    at the target's time. Otherwise, it is the straight lines from target to target.

    Args:
        course: the course.
        every: n to keep each n-th target.
        tolerance: largest distance of omitted targets from the path [deg and mm]; None to keep all targets.
        robot: the robot.
        form: the form of the motion.
    """
    if every > 1:
        kept = np.unique(np.append(np.arange(0, course.size, every), course.size - 1))
        course = course.only(kept)
    if tolerance is None or course.size < 3:
        return course
    points = _points(course)
    if form == "timed":
        return course.only(_in_time(course, tolerance))
    if form == "spline" and course.target == "JOINTS":
        keep = _along_spline(points, _peucker(points, _COARSE * tolerance), tolerance, robot)
    else:
        keep = _peucker(points, tolerance)
    return course.only(np.flatnonzero(keep))


def _in_time(course: Course, tolerance: float) -> NDArray[np.intp]:
    """Return the indices (m,) of targets to keep in a course with times. At the time of each omitted target,
    the path through the kept targets is within the tolerance of the omitted target.
    """
    assert course.times is not None
    kept = np.array([0, course.size - 1])
    while True:
        off = np.linalg.norm(path_in_time(course.only(kept), course.times) - course.values, axis=1)
        off[kept] = 0.0
        if (off <= tolerance).all():
            return kept
        # Between each two kept targets, find the target that exceeds the tolerance most.
        leg = np.searchsorted(kept, np.arange(course.size), side="right")
        order = np.lexsort((-off, leg))
        worst = order[np.unique(leg[order], return_index=True)[1]]
        kept = np.union1d(kept, worst[off[worst] > tolerance])


def path_in_time(course: Course, times: Array) -> Array:
    """Return the joint values (m, n) [deg, mm] at `times` (m,) [s] on the path that MOVEJ_TIMED follows
    through a course.

    With accelerations the path is quintic; with velocities only, it is cubic. Otherwise it is a cubic spline
    in time that is at rest at both ends. The path begins at the first target of the course. If the first
    target's time is later than 0, the path before it isn't known.
    """
    from scipy.interpolate import BPoly, CubicHermiteSpline, CubicSpline

    assert course.times is not None
    if course.velocities is None:
        path = CubicSpline(course.times, course.values, bc_type="clamped")
    elif course.accelerations is None:
        path = CubicHermiteSpline(course.times, course.values, course.velocities)
    else:
        rows = np.stack((course.values, course.velocities, course.accelerations), axis=1)
        path = BPoly.from_derivatives(course.times, rows)
    values: Array = path(times)
    return values


def way_shares(points: Array) -> Array:
    """Return the path length up to each of `points` (w, k), relative to the whole length: (w,) from 0 to 1.
    These values are the knots of a spline.
    """
    way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    shares: Array = way / way[-1]
    return shares


def _points(course: Course) -> Array:
    """Return targets as points of a space in which distances are in deg and mm.

    Points are joint values or, for poses, positions and twice the quaternions in deg. A chord between two
    quaternions runs inside the arc between them; distances of rotations are therefore slightly overestimated.
    """
    if course.target == "JOINTS":
        return course.values
    turn = course.values[:, 3:]
    quaternions = turn if course.target == "QUAT" else _quaternions(np.deg2rad(turn))
    flips = np.sign(np.sum(quaternions[1:] * quaternions[:-1], axis=1))
    signs = np.concatenate(([1.0], np.cumprod(np.where(flips == 0, 1.0, flips))))
    return np.hstack((course.values[:, :3], np.rad2deg(2.0 * quaternions * signs[:, None])))


def _quaternions(rpy: Array) -> Array:
    """Return the quaternions x y z w (w, 4) of Rz(yaw) Ry(pitch) Rx(roll), for `rpy` (w, 3) [rad]."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy.T / 2.0), np.cos(rpy.T / 2.0)
    return np.stack(
        (
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        ),
        axis=1,
    )


def _peucker(points: Array, tolerance: float) -> NDArray[np.bool_]:
    """Return a mask (w,) of the `points` (w, k) that the algorithm of Douglas and Peucker keeps."""
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    waiting = [(0, len(points) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        distances = _to_chords(points[first + 1 : last], points[None, first], points[None, last])
        farthest = int(np.argmax(distances))
        if distances[farthest] > tolerance:
            middle = first + 1 + farthest
            keep[middle] = True
            waiting += [(first, middle), (middle, last)]
    return keep


def _along_spline(
    points: Array, keep: NDArray[np.bool_], tolerance: float, robot: Robot
) -> NDArray[np.bool_]:
    """Return a mask of targets to keep: those of the mask `keep`, and further targets. These are added until
    the natural spline through all kept targets is within the tolerance of all omitted targets.
    """
    units = robot.axis_units
    keep = keep.copy()
    while True:
        kept = np.flatnonzero(keep)
        left = np.flatnonzero(~keep)
        chosen = points[kept] * units
        if len(left) == 0 or len(distinct(chosen)) < len(chosen):
            return keep
        path = through(chosen, robot.chain.is_prismatic)
        knots = way_shares(chosen)
        share = np.linspace(0.0, 1.0, _SAMPLES + 1)
        s = knots[:-1, None] + np.diff(knots)[:, None] * share
        curve = (path.joints(s.ravel()) / units).reshape(*s.shape, -1)
        leg = np.searchsorted(kept, left) - 1
        distances = np.full(len(left), np.inf)
        for sample in range(_SAMPLES):
            ends = curve[leg, sample], curve[leg, sample + 1]
            distances = np.minimum(distances, _to_chords(points[left], *ends))
        if (distances <= tolerance).all():
            return keep
        # Between each two kept targets, find the target that exceeds the tolerance most.
        order = np.lexsort((-distances, leg))
        worst = order[np.unique(leg[order], return_index=True)[1]]
        keep[left[worst[distances[worst] > tolerance]]] = True


def _to_chords(points: Array, begins: Array, ends: Array) -> Array:
    """Return the distance of each of `points` (w, k) from its chord, as (w,). The chords run from `begins` to
    `ends` (w or 1, k).
    """
    way = ends - begins
    length = np.sum(way**2, axis=1)
    share = np.sum((points - begins) * way, axis=1) / np.where(length > 0, length, 1.0)
    nearest = begins + np.clip(share, 0.0, 1.0)[:, None] * way
    distances: Array = np.linalg.norm(points - nearest, axis=1)
    return distances
