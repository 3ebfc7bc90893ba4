"""The path of the lines that were sent to the controller, and the distance of the motors' commanded positions
from this path. No I/O.

Lines can't be read back from a rotary buffer. The positions that the controller computes from its lines are
therefore compared with the points that were sent. These commanded positions are the actual positions plus the
following errors. A spline of `SPLINE1` deviates from the straight lines between the points by at most a sixth
of the points' second difference (TUM 290); at the knots it deviates by exactly a sixth. A changed digit,
lines of another client, or a changed axis definition all make the motors leave this path.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from yarclang.robot.actuation import to_counts
from yarclang.robot.model import Array, Robot
from yarclang.runtime.pmac.feedback import groups_of
from yarclang.runtime.sample import Sample

_AROUND = 4
"""Number of points that are compared in addition, before and after the points that the controller may be
executing now.
"""
_KEPT = 512
"""Minimum number of points that are kept after the robot has passed them."""
_ALLOWED = 8.0
"""Allowed distance of a motor from the path [counts].

The distance by which the controller's spline misses its own points is allowed in addition: a uniform B-spline
doesn't pass through its control points.
"""
_NUMBER = re.compile(r"-?\d+\.?\d*")


class Course:
    """The path points that were sent to the controller.

    Args:
        robot: the robot with its axes, gears and couplings.
        start: (n,) joint position where the motion begins [rad or m].
        slack: (n,) allowed deviation of each joint from the start [rad or m].
        segment: shortest time between two points [s].
    """

    def __init__(self, robot: Robot, start: Array, slack: Array, segment: float) -> None:
        self._robot = robot
        self._segment = segment
        self._groups = len(groups_of(robot.controller.motors))
        axes = "".join(robot.controller.axes)
        self._move = re.compile(rf"(?:[{axes}]-?\d+\.?\d*){{{len(axes)}}}")
        self._points = to_counts(robot, start)[None, :]
        self._lines: npt.NDArray[np.int64] = np.array([-1])
        self._slack = np.abs(to_counts(robot, start + slack) - self._points[0])
        self._sent = 0
        self._following: Array = np.zeros(robot.size)

    def append(self, lines: Sequence[str]) -> None:
        """Add the points of further lines to the end of the path."""
        rows = [row for row, line in enumerate(lines) if self._move.fullmatch(line)]
        if rows:
            values = [_NUMBER.findall(lines[row]) for row in rows]
            joints = np.array(values, dtype=np.float64) * self._robot.axis_units
            self._points = np.concatenate((self._points, to_counts(self._robot, joints)))
            self._lines = np.concatenate((self._lines, np.array(rows) + self._sent))
        self._sent += len(lines)

    def forget(self, executed: int) -> None:
        """Drop points that no later comparison can need, once `executed` lines have been executed."""
        behind = int(np.searchsorted(self._lines, executed)) - _KEPT
        if behind > _KEPT:
            self._points, self._lines = self._points[behind:], self._lines[behind:]

    def off(self, measured: Sample, executed: tuple[int, int], spent: float) -> tuple[float, int]:
        """Return the distance of the motors' commanded positions from the path.

        Positions and following errors are asked for in sequence. If they belong to two different instants,
        the commanded positions may be wrong by the following error, or by its change since the last question.

        Args:
            measured: positions and following errors of the motors.
            executed: minimum and maximum number of executed lines.
            spent: duration of the questions [s].

        Returns:
            The distance [counts] and the row of the motor with the largest distance; 0 and 0 if all are on
            the path.
        """
        first = max(int(np.searchsorted(self._lines, executed[0])) - _AROUND, 0)
        last = int(np.searchsorted(self._lines, executed[1])) + _AROUND
        points = self._points[first:last]
        # A spline's distance from the straight lines between its points is at most a sixth of their second
        # difference.
        bends = np.abs(np.diff(points, 2, axis=0)).max(axis=0, initial=0.0)
        errors = np.abs(np.array((measured.following, measured.following - self._following)))
        allowed = _ALLOWED + bends / 6.0 + errors.max(axis=0)
        self._following = measured.following
        if self._groups > 1:  # the groups are asked in sequence
            allowed += np.abs(np.diff(points, axis=0)).max(axis=0, initial=0.0) / self._segment * spent
        if first == 0:
            allowed += self._slack
        # In units of the tolerance, the nearest point can be found for all motors together.
        place = measured.commanded / allowed
        off = np.abs(place - _nearest(points / allowed, place))
        # In these units, the tolerance is 1. If all n motors are within their tolerance of some point of the
        # path, the squared distance from this point is at most n, and so is that from the nearest point.
        if (off**2).sum() <= len(off):
            return 0.0, 0
        row = int(np.argmax(off))
        return float(off[row] * allowed[row]), row


def _nearest(points: Array, place: Array) -> Array:
    """Return the point nearest to `place` (n,) on the straight lines between `points` (N, n)."""
    begins = points[:-1] if len(points) > 1 else points
    ways = np.diff(points, axis=0) if len(points) > 1 else np.zeros_like(points)
    lengths = np.maximum((ways**2).sum(axis=1), 1e-12)
    shares = np.clip(((place - begins) * ways).sum(axis=1) / lengths, 0.0, 1.0)
    feet = begins + shares[:, None] * ways
    nearest: Array = feet[np.argmin(((feet - place) ** 2).sum(axis=1))]
    return nearest
