"""Where a robot is, as its controller has told it."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.robot.actuation import from_counts
from yarclang.robot.model import Array, Robot


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Where the robot is: `actual` and `following` (n,) [counts] of its motors, at `time` [s] of the host's clock.

    `program_time` [s] is how far the program is, as far as the buffer tells: to a segment or two. It has the ways of a WHEN one after the other; `clock`
    [s] has both at once (None: there are none).
    """

    time: float
    program_time: float
    actual: Array
    following: Array
    clock: float | None = None

    @property
    def reached(self) -> float:
        """How far the program is [s], with both ways of a WHEN at once: what people are told."""
        return self.program_time if self.clock is None else self.clock

    @property
    def commanded(self) -> Array:
        """(n,) [counts]."""
        return self.actual + self.following

    def joints(self, robot: Robot) -> Array:
        """The actual joint positions (n,) [rad or m]."""
        return from_counts(robot, self.actual)
