"""Moves of a motion program: the modal state of the program, and the steps that moves yield (TSRM 98, 189,
463, 476).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.simulator.language.arithmetic import Data, value_of
from yarclang.simulator.language.statements import AXES
from yarclang.simulator.motion.axes import Axes, axes_of
from yarclang.simulator.motion.pieces import Array
from yarclang.simulator.motion.steps import Step
from yarclang.simulator.programs.surroundings import Surroundings
from yarclang.simulator.state.registers import Seen

_QUANTUM = 1e-3 / 4096.0
_LONGEST = 4096e-3
_LONGEST_LINEAR = 8388.0
_PLACES = {axis: place for place, axis in enumerate(AXES)}
_SPLINES = ("SPLINE1", "SPLINE2", "PVT")


class Moves:
    """Modal state of a coordinate system's program (mode, TM, TA, TS, F, ABS or INC), and the calculated
    positions.

    Attributes:
        system: number of the coordinate system.
        scope: the variables as the coordinate system sees them.
        outside: the machine.
        axes: axis definitions of the motors.
        position: positions of the axes (9,) after the last calculated move.
        counted: positions of the motors (n,) after the last calculated move [counts].
        mode: LINEAR, RAPID, SPLINE1, SPLINE2, PVT or a CIRCLE.
        pvt_time: time of a PVT move [ms].
        feed: True if a speed (F) determines moves, False if a time (TM) does.
        incremental: axes in INC mode.
        vector: axes whose combined distance the speed F refers to (FRAX).
    """

    def __init__(self, system: int, scope: Seen, outside: Surroundings, fail: Callable[[], None]) -> None:
        self.system = system
        self.scope = scope
        self.outside = outside
        self._fail = fail
        self.clear()

    def clear(self) -> None:
        """Return to the state at power-up: no axes."""
        self.connect(axes_of([]))
        self.position: Array = np.zeros(len(AXES))
        self.mode = "LINEAR"
        self.pvt_time = 0.0
        self.feed = False
        self.incremental: set[str] = set()
        self.vector: frozenset[str] = frozenset("XYZ")

    def connect(self, axes: Axes) -> None:
        """Use other axis definitions from now on."""
        self.axes = axes
        self.counted: Array = np.zeros(len(axes.motors))

    def match(self, counts: Array) -> None:
        """Execute PMATCH: compute axis positions from the motors' commanded positions (n,) [counts]."""
        self.position = self.axes.matched(counts, self.position)
        self.counted = counts

    def attribute(self, name: str, value: float) -> None:
        """Set TM, TA, TS or F. TM and F are stored in Isx89, TA in Isx87 and TS in Isx88 (TSRM 189)."""
        number = {"TM": 89, "F": 89, "TA": 87, "TS": 88}[name]
        self.scope.write("I", 5000 + 100 * self.system + number, max(value, 0.0))
        if name in ("TM", "F"):
            self.feed = name == "F"

    def frame(self, name: str, axes: str) -> None:
        """Execute ABS, INC or FRAX for `axes`, or NOFRAX."""
        match name:
            case "ABS":
                self.incremental -= set(axes)
            case "INC":
                self.incremental |= set(axes)
            case "FRAX":
                self.vector = frozenset(axes) & frozenset(AXES)
            case _:
                self.vector = frozenset()

    def relabel(self, axis: str, value: float) -> None:
        """Execute PSET: give an axis a new position by changing its offset. The motors don't move."""
        place = _PLACES[axis]
        change = value - self.position[place]
        offset = self.axes.offset - self.axes.matrix[:, place] * change
        self.axes = Axes(self.axes.motors, self.axes.matrix, offset)
        self.position = self.position.copy()
        self.position[place] = value

    def step(self, words: tuple[tuple[str, Data, Data | None], ...]) -> Step:
        """Return the step of a move.

        Args:
            words: for each programmed axis: its letter, its position or distance, and for PVT its velocity.
        """
        position = self.position.copy()
        velocity: Array | None = None
        for axis, data, speed in words:
            place = _PLACES[axis]
            value = data(self.scope) if callable(data) else data
            position[place] = position[place] + value if axis in self.incremental else value
            if speed is not None:
                velocity = np.zeros(len(AXES)) if velocity is None else velocity
                velocity[place] = value_of(speed, self.scope)
        before, self.position = self.position, position
        target = self.axes.counts(position)
        step = Step("move", "LINEAR", target)
        if self.mode in _SPLINES:
            self._timed(step, velocity)
        elif self.mode == "RAPID":
            step.mode = "RAPID"
        else:
            self._linear(step, position - before)
        self.counted = target
        return step

    def _variable(self, number: int) -> float:
        return self.scope.variables.i[5000 + 100 * self.system + number]

    def _timed(self, step: Step, velocity: Array | None) -> None:
        """Set time and velocity of a SPLINE or PVT step (TSRM 463, 476).

        The time of a PVT step is that of the mode. The time of a SPLINE step is TM, or TA with I42=1. It is
        rounded to a multiple of 1/4096 ms and stays below 4096 ms; with I42=1, it is rounded to an integer
        number of ms.

        Args:
            step: the step to complete.
            velocity: (9,) velocities of the axes; None without velocities.
        """
        i42 = self.scope.variables.i[42] == 1.0
        time = self.pvt_time if self.mode == "PVT" else self._variable(87 if i42 else 89)
        time = (
            round(time) * 1e-3 if i42 else min(round(time * 1e-3 / _QUANTUM) * _QUANTUM, _LONGEST - _QUANTUM)
        )
        if time < self.outside.interrupt:
            # With such a short move, the next move couldn't be calculated in time (TSRM 476).
            self._fail()
            time = self.outside.interrupt
        step.time = time
        step.mode = "PVT" if self.mode == "PVT" else "SPLINE1"
        if step.mode == "PVT" and velocity is not None:
            unit = max(self._variable(90), 1e-3) * 1e-3
            step.velocity = self.axes.matrix @ velocity / unit

    def _linear(self, step: Step, way: Array) -> None:
        """Set the times of a LINEAR step from TM or F, TA and TS, within the limits Ixx16 and Ixx17 (TSRM 98,
        189).

        Args:
            step: the step to complete.
            way: (9,) change of the axis positions.
        """
        ramp = max(self._variable(87), 2.0 * self._variable(88)) * 1e-3
        time = self._variable(89) * 1e-3
        if self.feed:
            feed = max(self._variable(89), 1e-6) / (max(self._variable(90), 1e-3) * 1e-3)
            chosen = [_PLACES[axis] for axis in self.vector]
            distance = float(np.linalg.norm(way[chosen])) if chosen else 0.0
            time = (distance or float(np.abs(way).max())) / feed
        speed = np.abs(step.target - self.counted)
        fastest = np.array([self.scope.read("I", 100 * motor + 16) for motor in self.axes.motors]) * 1e3
        steepest = np.array([self.scope.read("I", 100 * motor + 17) for motor in self.axes.motors]) * 1e6
        if len(speed):
            time = max(time, float((speed / np.maximum(fastest, 1e-6)).max()))
        time = min(max(time, ramp, 0.5e-3), _LONGEST_LINEAR)
        if len(speed):
            ramp = max(ramp, float((speed / time / np.maximum(steepest, 1e-6)).max()))
        ramp = min(ramp, _LONGEST_LINEAR)
        step.ramp, step.s_ramp = ramp, min(self._variable(88) * 1e-3, ramp / 2.0)
        step.time = max(time, ramp)
