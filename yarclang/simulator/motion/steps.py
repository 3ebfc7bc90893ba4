"""What the calculation of a program yields: steps, one for each move, pause or end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from yarclang.simulator.motion.pieces import Array

StepKind = Literal["move", "dwell", "home", "stop", "end"]


@dataclass(slots=True)
class Step:
    """One calculated step of a motion program.

    For a move: its `mode` (LINEAR, RAPID, SPLINE1, PVT, DELAY), `target` (n,) [counts], and for PVT the
    `velocity` there (n,) [counts/s]. `time` [s] is that of the move or of the pause; `ramp` [s] and
    `s_ramp` [s] are TA and TS. `events` happen when the move begins to blend in: synchronous assignments.
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
        """Whether nothing behind it is calculated before it is done (TUM 341)."""
        return self.kind != "move" or self.mode == "RAPID"
