"""The way that the controller's lines lead, and how far off it the motors are commanded to be. No I/O.

A line can't be read back out of a rotary. So what is compared is what the controller makes of its lines: where it commands the motors to be (actual
position and following error together), and the points that it was sent. A spline of `SPLINE1` is at most a sixth of the points' second difference
away from the lines between them (it is just that at the knots, TUM 290). A digit that was changed on its way, lines of somebody else, another axis
definition: each of them leads off that way.
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
"""Points in front of and behind those that may be executed."""
_KEPT = 512
"""Points that are kept behind the robot, at least."""
_ALLOWED = 8.0
"""How far off the motors may be commanded [counts], besides the spline's own distance."""
_NUMBER = re.compile(r"-?\d+\.?\d*")


class Course:
    """The points that a controller was sent.

    Args:
        robot: its axes, gears and couplings.
        start: (n,) where the motion begins [rad or m].
        slack: (n,) how far from there it may begin [rad or m].
        segment: the shortest time between two points [s].
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
        """These lines follow."""
        rows = [row for row, line in enumerate(lines) if self._move.fullmatch(line)]
        if rows:
            values = [_NUMBER.findall(lines[row]) for row in rows]
            joints = np.array(values, dtype=np.float64) * self._robot.axis_units
            self._points = np.concatenate((self._points, to_counts(self._robot, joints)))
            self._lines = np.concatenate((self._lines, np.array(rows) + self._sent))
        self._sent += len(lines)

    def forget(self, executed: int) -> None:
        """Keep what may still be asked for, when so many lines have been executed."""
        behind = int(np.searchsorted(self._lines, executed)) - _KEPT
        if behind > _KEPT:
            self._points, self._lines = self._points[behind:], self._lines[behind:]

    def off(self, found: Sample, executed: tuple[int, int], spent: float) -> tuple[float, int]:
        """Return how far off the way the motors are commanded to be.

        Positions and following errors are asked one after the other: where they are as the robot was at two instants, they may be off by as much as the
        following error, or as it has changed since they were asked before.

        Args:
            found: their positions and following errors.
            executed: how many lines have been executed at least and at most.
            spent: how long it took to ask for them [s].

        Returns:
            The distance [counts] and the row of the motor that is furthest; 0 and 0 where all are where they should be.
        """
        first = max(int(np.searchsorted(self._lines, executed[0])) - _AROUND, 0)
        last = int(np.searchsorted(self._lines, executed[1])) + _AROUND
        points = self._points[first:last]
        bends = np.abs(np.diff(points, 2, axis=0)).max(axis=0, initial=0.0)
        errors = np.abs(np.array((found.following, found.following - self._following)))
        allowed = _ALLOWED + bends / 6.0 + errors.max(axis=0)
        self._following = found.following
        if self._groups > 1:  # asked one after the other
            allowed += np.abs(np.diff(points, axis=0)).max(axis=0, initial=0.0) / self._segment * spent
        if first == 0:
            allowed += self._slack
        place = found.commanded / allowed
        off = np.abs(place - _nearest(points / allowed, place))
        # where all motors are within what is allowed at one instant, the nearest point is no further
        if (off**2).sum() <= len(off):
            return 0.0, 0
        row = int(np.argmax(off))
        return float(off[row] * allowed[row]), row


def _nearest(points: Array, place: Array) -> Array:
    """The point of the lines between points (N, n) that is nearest to a place (n,)."""
    begins = points[:-1] if len(points) > 1 else points
    ways = np.diff(points, axis=0) if len(points) > 1 else np.zeros_like(points)
    lengths = np.maximum((ways**2).sum(axis=1), 1e-12)
    shares = np.clip(((place - begins) * ways).sum(axis=1) / lengths, 0.0, 1.0)
    feet = begins + shares[:, None] * ways
    nearest: Array = feet[np.argmin(((feet - place) ** 2).sum(axis=1))]
    return nearest
