"""Data of a job that only a rotary buffer needs."""

from __future__ import annotations

from dataclasses import dataclass

from yarclang.pmac.variables import OUTPUTS_PLC
from yarclang.robot.model import Robot
from yarclang.runtime.job import Job


@dataclass(frozen=True, slots=True)
class Loading:
    """Data for loading a rotary buffer.

    Attributes:
        setup: lines that are sent before the buffer is opened, one command each.
        words: size of the buffer [words].
        low: number of lines below which the guard PLC holds (I16).
        full: number of lines from which the buffer counts as full (I17).
    """

    setup: tuple[str, ...]
    words: int
    low: int
    full: int

    @property
    def preparing(self) -> tuple[str, ...]:
        """Return the lines that prepare the controller for the job: those of `setup`. If the job has no PLC
        for its outputs, the PLC of an earlier job is disabled, which would set that job's outputs after a
        hold by the guard.
        """
        if any(line.startswith(f"OPEN PLC {OUTPUTS_PLC} ") for line in self.setup):
            return self.setup
        return (*self.setup, f"DISABLE PLC {OUTPUTS_PLC}")


def loading_of(job: Job) -> Loading:
    """Return the data for loading a job into the rotary buffer."""
    assert isinstance(job.own, Loading)
    return job.own


def capacity_of(robot: Robot, words: int) -> int:
    """Return the number of lines that surely fit into a rotary buffer of `words` words. A line takes a word
    per axis, and two words for statements between the lines.
    """
    return words // (len(robot.controller.axes) + 2)
