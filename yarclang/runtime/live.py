"""A motion whose lines are made while it goes on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from yarclang.robot.model import Array
from yarclang.runtime.job import Job

MADE_ON_THE_WAY = "live motion: its lines were made on the way"
"""The first comment of a live motion's text, which has no lines."""


class Source(Protocol):
    """Makes the lines; each of them was proved."""

    ended: bool
    """Whether the text ends at rest, for good."""

    @property
    def end(self) -> Array:
        """(n,) where it ends so far [rad or m]."""

    def more(self, now: float, count: int) -> tuple[str, ...]:
        """`count` lines or a few more behind those that were given before; fewer only where the text ends."""

    def expired(self, now: float) -> bool:
        """Whether nobody has said for too long what is wanted."""

    def finish(self) -> None:
        """Come to rest, and end the text there."""


@dataclass(frozen=True, slots=True, eq=False)
class Live:
    """What is streamed: `job` has the robot, the setup and where it starts, but no lines; `opening` are those before the first move; `lead` lines
    are kept ahead; `source` makes them.
    """

    job: Job
    opening: tuple[str, ...]
    lead: int
    source: Source
