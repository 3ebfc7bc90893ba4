"""Live motions: motions whose lines are computed while the robot moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from yarclang.robot.model import Array
from yarclang.runtime.job import Job

MADE_ON_THE_WAY = "live motion: its lines were made on the way"
"""First comment of a live motion's text, which has no lines."""


class Source(Protocol):
    """Generator of the lines of a live motion. Each line is proved before it is returned."""

    ended: bool
    """True once the motion has ended at rest and no lines can follow."""

    @property
    def end(self) -> Array:
        """Return the joint positions at the end of the lines so far (n,) [rad or m]."""

    def more(self, now: float, count: int) -> tuple[str, ...]:
        """Return the next lines of the motion.

        Args:
            now: the host's clock [s].
            count: number of lines wanted. A few more may be returned; fewer are returned only if the motion
                ends.
        """

    def expired(self, now: float) -> bool:
        """Return True if too long a time has passed since the last order."""

    def finish(self) -> None:
        """Bring the motion to rest, and end its lines there."""


@dataclass(frozen=True, slots=True, eq=False)
class Live:
    """A live motion, ready to be streamed.

    `job` has the robot, the setup of the controller and the start position, but no lines. `opening` has the
    lines before the first move, `lead` is the number of lines to keep ahead of the execution, and `source`
    generates the lines.
    """

    job: Job
    opening: tuple[str, ...]
    lead: int
    source: Source
