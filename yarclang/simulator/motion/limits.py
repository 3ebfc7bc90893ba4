"""When a motor trips on a piece: at a limit, or by its following error."""

from __future__ import annotations

import numpy as np

from yarclang.simulator.motion.motors import LAG, Motor, first_trip
from yarclang.simulator.motion.pieces import Array, Piece

_PIECES = 4
"""How many pieces the control points of a spline reach: so many are looked at closely behind one that may trip."""


class Watch:
    """Looks whether the motors of a coordinate system trip on its pieces. Most pieces are far from anything."""

    def __init__(self, motors: list[Motor]) -> None:
        self.motors = motors
        self._bounds: tuple[Array, Array, Array] | None = None
        self._suspect = 0

    def look_again(self) -> None:
        """What may trip a motor has changed."""
        self._bounds = None
        self._suspect = _PIECES

    def first_trip(self, piece: Piece) -> tuple[float, Motor, str] | None:
        """The first time [s] within a piece at which a motor trips, which, and why."""
        least, most, fastest = self._bounds or self._bound()
        low, high, speed = piece.reach()
        if ((low < least) | (high > most) | (speed > fastest)).any():
            self._suspect = _PIECES
        if not self._suspect:
            return None
        self._suspect -= 1
        return first_trip(piece, self.motors)

    def _bound(self) -> tuple[Array, Array, Array]:
        """Positions [counts] and speeds [counts/s] (n,) at which nothing trips: least, most, fastest."""
        limits = [motor.limits() for motor in self.motors]
        slack = [
            motor.fatal_limit() - abs(motor.disturbance) if not any(motor.switches.values()) else 0.0
            for motor in self.motors
        ]
        margin = np.minimum(np.abs(slack), 1e9)
        self._bounds = (
            np.array([least for least, _ in limits]) + margin,
            np.array([most for _, most in limits]) - margin,
            np.array(slack) / LAG,
        )
        return self._bounds
