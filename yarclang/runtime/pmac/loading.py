"""What a job for a rotary buffer has besides its lines."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.robot.model import Robot
from yarclang.runtime.job import Job


@dataclass(frozen=True, slots=True)
class Loading:
    """How a rotary buffer is loaded: `setup` are the lines before it is opened, one command each, `words` its size, `low` the lines below which the guard PLC
    holds (I16), `full` those from which it counts as full (I17).
    """

    setup: tuple[str, ...]
    words: int
    low: int
    full: int


def loading_of(job: Job) -> Loading:
    """Return how the rotary buffer of a job is loaded."""
    assert isinstance(job.own, Loading)
    return job.own


def capacity_of(robot: Robot, words: int) -> int:
    """Return how many lines surely fit into a rotary of so many words: a word an axis, and two for what stands between lines."""
    return words // (len(robot.controller.axes) + 2)
