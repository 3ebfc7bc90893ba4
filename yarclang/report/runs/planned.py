"""The motion that a log's controller text plans: exact cubics, as its strict reader and the certificate have them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.bounds import Cubics
from yarclang.certify.read import read
from yarclang.certify.text import ControllerText, Unreadable
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.report.runs.log import RecordedRun
from yarclang.robot.model import Array
from yarclang.runtime.live import MADE_ON_THE_WAY
from yarclang.units import MS


@frozen(eq=False)
class Planned:
    """Where a program is to be at each of its times.

    Attributes:
        cubics: its segments, one behind the other [rad or m, s].
        begins: (N + 1,) when each of them begins, and when the last ends [s].
        stand: (n,) where it starts [rad or m].
    """

    cubics: Cubics
    begins: Array
    stand: Array

    @property
    def duration(self) -> float:
        """Of the whole program [s]."""
        return float(self.begins[-1])

    def at(self, times: Array) -> tuple[Array, Array]:
        """Positions [rad or m] and velocities, (M, n) each, at times (M,) of the program [s]; before and behind it, those of its ends."""
        if len(self.begins) == 1:
            stand = np.tile(self.stand, (len(times), 1))
            return stand, np.zeros_like(stand)
        rows = self._rows(times)
        return self.cubics.take(rows).at(np.clip(times, 0.0, self.duration) - self.begins[rows])

    def segment_times(self, times: Array) -> Array:
        """The segment times (M,) [s] at times (M,) of the program [s]."""
        return self.cubics.h[self._rows(times)] if len(self.begins) > 1 else np.zeros(len(times))

    def _rows(self, times: Array) -> NDArray[np.int64]:
        """The segments that times (M,) are in, the first and the last for those before and behind."""
        return np.clip(np.searchsorted(self.begins, times, side="right") - 1, 0, len(self.begins) - 2)


def planned_motion(run: RecordedRun) -> Result[Planned]:
    """Rebuild the planned motion of a run.

    Returns:
        None, with a finding, where the reader doesn't take the text.
    """
    if run.text.startswith(f"; {MADE_ON_THE_WAY}"):
        message = (
            f"{run.file}: this was a jog, or a master that was followed: there was no plan to draw it beside"
        )
        return Result(None, (Diagnostic("Y1404", message, help="`yarc replay` shows what happened"),))
    content = read(run.text, run.robot.controller)
    if isinstance(content, Unreadable):
        return _refused(run, f"line {content.line} {content.reason}")
    if content.start.rapid is None:
        return _refused(run, "it isn't for the rotary buffer, so that it was never streamed")
    return Result(_planned(content, content.start.rapid, run.robot.axis_units))


def _refused(run: RecordedRun, reason: str) -> Result[Planned]:
    message = f"{run.file}: the controller text in it can't be read: {reason}"
    help_ = f"read the log with yarclang {run.version}, which wrote it"
    return Result(None, (Diagnostic("Y1404", message, help=help_),))


def _planned(content: ControllerText, start: Array, units: Array) -> Planned:
    """The segments of all sequences (TUM 289: S, S, S, c1 ... cM, cM, cM), from `start` (n,) in axis units."""
    stand = start
    control, at, time = [np.empty((0, len(units)))], [np.empty(0, dtype=np.int64)], [np.empty(0)]
    base = 0
    for run in content.runs:
        sequence = np.concatenate([np.tile(stand, (3, 1)), run.points, np.tile(run.points[-1], (2, 1))])
        count = len(run.points) + 2
        control.append(sequence)
        at.append(base + np.arange(count))
        time.append(np.full(count, run.segment_ms * MS))
        stand, base = run.points[-1], base + len(sequence)
    times = np.concatenate(time)
    cubics = Cubics.of_spline(np.concatenate(control) * units, np.concatenate(at), times)
    return Planned(cubics, np.concatenate(([0.0], np.cumsum(times))), start * units)
