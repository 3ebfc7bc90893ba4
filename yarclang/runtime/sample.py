"""The position of a robot, as reported by its controller."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.robot.actuation import from_counts
from yarclang.robot.model import Array, Robot


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """The position of a robot at one time.

    Attributes:
        time: time on the host's clock [s].
        program_time: progress of the program [s], counting both branches of each WHEN, one after the other.
            It is computed from the number of lines in the buffer; its error is a segment or two.
        actual: (n,) positions of the motors [counts].
        following: (n,) following errors of the motors [counts].
        clock: progress of the program [s]. Of each WHEN that the robot has already passed, only the longer
            branch is counted. None if the program has no branches.
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
