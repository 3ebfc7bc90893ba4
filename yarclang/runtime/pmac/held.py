"""State of a run with barriers that is stored in this computer, not in the controller; and the titles of
barriers. No I/O.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from yarclang.decisions import Register
from yarclang.runtime.job import Barrier, Job

COUNTED = ("REPEAT", "LOOP")
"""Words of barriers whose condition and register count the passes of a loop."""


@dataclass(slots=True)
class Passes:
    """A loop of the program that is being repeated.

    Attributes:
        ways: number of WHENs that the run had passed before the first pass.
        barriers: number of barriers that the run had passed before the first pass.
        number: number of the current pass.
        moved: True once something was sent to the controller in the current pass.
    """

    ways: int
    barriers: int
    number: int = 1
    moved: bool = False


@dataclass(slots=True)
class Held:
    """State of a run that is stored in this computer, not in the controller: registers, the inputs that the
    last decision has read, and loops.
    """

    registers: dict[str, int]
    inputs: dict[str, float]
    loops: dict[int, Passes] = field(default_factory=dict)
    """Loops, by the number of the leg before them."""
    flags: frozenset[str] = frozenset()
    """Registers in which the runtime records whether searches and OFFSETs succeeded. The program's text
    doesn't mention these registers.
    """
    said: dict[str, str] = field(default_factory=dict)
    """For each place in the program, the last remark since the last motion, so that it isn't repeated."""
    outside: dict[str, Register] = field(default_factory=dict)
    """Registers that other programs fill, by their names."""

    @classmethod
    def of(cls, job: Job) -> Held:
        """Return the state at the beginning of a run."""
        flags = frozenset(one.flag for one in job.searches)
        barriers = (leg.barrier for leg in job.legs)
        flags |= {one.offset.flag for one in barriers if one is not None and one.offset is not None}
        outside = {one.name: one for one in job.registers if one.outside}
        return cls({one.name: one.first for one in job.registers}, {}, flags=flags, outside=outside)

    @property
    def told(self) -> tuple[tuple[str, int], ...]:
        """Return the names and values of the registers."""
        return tuple(self.registers.items())

    def in_words(self) -> str:
        """Return the registers as the log prints them; empty if the program names no registers."""
        told = [f"{name} is {value}" for name, value in self.registers.items() if name not in self.flags]
        return f"registers: {', '.join(told)}" if told else ""


def title(barrier: Barrier) -> str:
    """Return a barrier's name for people: `P0010 WAIT`."""
    return f"{barrier.label or f'line {barrier.source_line}:'} {barrier.word or barrier.kind.upper()}"
