"""The position of a robot, as reported by its controller."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.robot.actuation import from_counts
from yarclang.robot.model import Array, Robot


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """The position of a robot at one time: `actual` positions and `following` errors (n,) of its motors
    [counts], at `time` on the host's clock [s].

    `program_time` [s] is the progress of the program. It is computed from the lines in the buffer, and so
    accurate to a segment or two. It counts both branches of each WHEN, one after the other; `clock` [s]
    counts only the longer branch of each WHEN passed before (None: there are no branches).
    """

    time: float
    program_time: float
    actual: Array
    following: Array
    clock: float | None = None

    @property
    def reached(self) -> float:
        """Return the progress of the program [s], counting only the longer branch of each WHEN passed before,
        as reported to people.
        """
        return self.program_time if self.clock is None else self.clock

    @property
    def commanded(self) -> Array:
        """Return the commanded positions of the motors (n,) [counts]."""
        return self.actual + self.following

    def joints(self, robot: Robot) -> Array:
        """Return the actual joint positions (n,) [rad or m]."""
        return from_counts(robot, self.actual)
