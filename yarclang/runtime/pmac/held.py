"""What a run with barriers knows besides the controller, and how its barriers are called. No I/O."""

from __future__ import annotations

from dataclasses import dataclass, field

from yarclang.decisions import Register
from yarclang.runtime.job import Barrier, Job

COUNTED = ("REPEAT", "LOOP")
"""Words whose decisions and registers are the count of a loop."""


@dataclass(slots=True)
class Passes:
    """A loop that is gone through: the number of this pass; how many WHENs and barriers were passed in front of its first one; `moved` once something was sent in this one."""

    ways: int
    barriers: int
    number: int = 1
    moved: bool = False


@dataclass(slots=True)
class Held:
    """What a run knows besides the controller: its registers, what the last decision has read of the inputs, and how often its loops were gone through."""

    registers: dict[str, int]
    inputs: dict[str, float]
    loops: dict[int, Passes] = field(default_factory=dict)
    """By the number of the leg in front of it."""
    flags: frozenset[str] = frozenset()
    """Registers of searches, which no line names."""
    said: dict[str, str] = field(default_factory=dict)
    """What was told last of each place, since something has moved."""
    outside: dict[str, Register] = field(default_factory=dict)
    """The registers that other programs fill, by their names."""

    @classmethod
    def of(cls, job: Job) -> Held:
        """Return what is held when a run begins."""
        flags = frozenset(one.flag for one in job.searches)
        outside = {one.name: one for one in job.registers if one.outside}
        return cls({one.name: one.first for one in job.registers}, {}, flags=flags, outside=outside)

    @property
    def told(self) -> tuple[tuple[str, int], ...]:
        """The registers, by their names."""
        return tuple(self.registers.items())

    def in_words(self) -> str:
        """Return the registers as the log tells them; empty where the program names none."""
        told = [f"{name} is {value}" for name, value in self.registers.items() if name not in self.flags]
        return f"registers: {', '.join(told)}" if told else ""


def title(barrier: Barrier) -> str:
    """Return how people call a barrier: `P0010 WAIT`."""
    return f"{barrier.label or f'line {barrier.source_line}:'} {barrier.word or barrier.kind.upper()}"
