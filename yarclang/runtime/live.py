"""Live motions: motions whose lines are computed while the robot moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from yarclang.robot.model import Array
from yarclang.runtime.job import Job

MADE_ON_THE_WAY = "live motion: its lines were made on the way"
"""First comment in the controller text of a live motion. The text doesn't contain the lines of the motion."""


class Source(Protocol):
    """Generator of the lines of a live motion. Each line is proved before it is returned."""

    ended: bool
    """True once the motion has ended at rest and no lines can follow."""

    @property
    def end(self) -> Array:
        """Return the joint positions (n,) at the end of the last line that was returned so far [rad or m]."""

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

    Attributes:
        job: the robot, the setup of the controller and the start position, but no lines.
        opening: lines before the first move.
        lead: number of lines that the buffer has to be ahead of the execution.
        source: generator of the lines.
    """

    job: Job
    opening: tuple[str, ...]
    lead: int
    source: Source
