"""Recorder of the motions of motors, which can be evaluated at any past time."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from yarclang.simulator.motion.pieces import Array, Motion, Standing


class Recorder:
    """Records all motions of all motors, for tests, plots and training. Memory grows with the motions."""

    def __init__(self) -> None:
        self._times: dict[int, list[float]] = {}
        self._motions: dict[int, list[tuple[Motion, int]]] = {}

    def note(self, time: float, motor: int, motion: Motion, index: int) -> None:
        """Record a motion of a motor.

        Args:
            time: start [s].
            motor: number of the motor.
            motion: the motion.
            index: index of the motor in the motion.
        """
        times = self._times.setdefault(motor, [])
        motions = self._motions.setdefault(motor, [])
        if times and times[-1] == time:
            motions[-1] = motion, index
        else:
            times.append(time)
            motions.append((motion, index))

    def stands(self, time: float, motor: int, position: float) -> None:
        """Record that a motor stands at a position [counts] from `time` [s] on."""
        self.note(time, motor, Standing(np.array([position])), 0)

    def positions(self, motor: int, times: Array) -> Array:
        """Return the commanded positions (N,) [counts] of a motor at `times` (N,) [s]."""
        return self._look(motor, times, 0)

    def velocities(self, motor: int, times: Array) -> Array:
        """Return the commanded velocities (N,) [counts/s] of a motor at `times` (N,) [s]."""
        return self._look(motor, times, 1)

    def _look(self, motor: int, times: Array, number: int) -> Array:
        changes = self._times.get(motor, [])
        motions = self._motions.get(motor, [])
        if not changes:
            raise ValueError(f"nothing is recorded for motor {motor}")
        result = np.empty(len(times))
        for row, time in enumerate(times):
            motion, index = motions[max(bisect_right(changes, time) - 1, 0)]
            result[row] = motion.at(float(time))[number][index]
        return result
