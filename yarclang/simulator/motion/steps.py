"""Steps: the results of the calculation of a program, one for each move, pause or end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from yarclang.simulator.motion.pieces import Array

StepKind = Literal["move", "dwell", "home", "stop", "end"]


@dataclass(slots=True)
class Step:
    """One calculated step of a motion program: a move, a pause, or a home search.

    Attributes:
        kind: kind of the step.
        mode: for a move, LINEAR, RAPID, SPLINE1, PVT or DELAY.
        target: (n,) positions of the motors at the end of the step [counts].
        time: duration of the move or pause [s]; negative for HOMEZ.
        ramp: TA [s].
        s_ramp: TS [s].
        velocity: for PVT, the velocities at the end of the step (n,) [counts/s]; None for a stop.
        motors: numbers of the motors of a home step.
        events: synchronous assignments, which are made when the move begins to blend in.
    """

    kind: StepKind
    mode: str
    target: Array
    time: float = 0.0
    ramp: float = 0.0
    s_ramp: float = 0.0
    velocity: Array | None = None
    motors: tuple[int, ...] = ()
    events: tuple[Callable[[], None], ...] = ()

    @property
    def breaks(self) -> bool:
        """True if later steps may be calculated only after this step has been executed (TUM 341)."""
        return self.kind != "move" or self.mode == "RAPID"
