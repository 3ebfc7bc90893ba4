"""Timetables, and the motions that they define."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import BPoly, CubicSpline

from yarclang.independent.arm import Array


@dataclass
class Timetable:
    """Timetable of a program, in deg (mm) and s: the position `start` (n,) before the first row, the `times`
    (k,) of the rows, the positions `rows` (k, n), and their derivatives, if the program states them.
    """

    start: Array
    times: Array
    rows: Array
    velocities: Array | None
    accelerations: Array | None

    def text(self, options: str = "") -> str:
        """Return a program that moves to the start, and then along the table."""
        return (
            "DEFAULT (mm,deg,s)\n"
            f"P0010 MOVEJ {numbers(self.start)} [MIN]\n"
            f"P0020 MOVEJ_TIMED {self.way()}{options}\n"
        )

    def way(self) -> str:
        """Return the rows of the table as text for a command."""
        points = []
        for number, (q, time) in enumerate(zip(self.rows, self.times, strict=True)):
            point = f"{numbers(q)} [{time:.4f}]"
            if self.velocities is not None:
                point += f" VEL {numbers(self.velocities[number])}"
            if self.accelerations is not None:
                point += f" ACC {numbers(self.accelerations[number])}"
            points.append(point)
        return "; ".join(points)

    def asked(self, stretch: float = 1.0) -> Any:
        """Return the required motion as a function of time, with derivatives."""
        times = np.concatenate(([0.0], self.times)) * stretch
        q = np.concatenate((self.start[None], self.rows))
        if self.velocities is None:
            return CubicSpline(times, q, bc_type="clamped")
        parts = [q, np.concatenate((np.zeros((1, q.shape[1])), self.velocities)) / stretch]
        if self.accelerations is not None:
            parts.append(np.concatenate((np.zeros((1, q.shape[1])), self.accelerations)) / stretch**2)
        return BPoly.from_derivatives(times, np.stack(parts, axis=1))


def numbers(values: Iterable[float]) -> str:
    """Return numbers as text for a program."""
    return " ".join(f"{value:.4f}" for value in values)
