"""Reconstruct the planned motion of a run from the controller text in its log. The cubics are exact: the text
is read by the same strict parser as for the certificate.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.read.reader import reader_of
from yarclang.certify.read.text import Barred, ControllerText, Dwelt, Run, Stood, Unreadable
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.lasting import Lasting, Schedule
from yarclang.memory import NO_MEMORY
from yarclang.report.runs.log import RecordedRun
from yarclang.robot.model import Array
from yarclang.runtime.live import MADE_ON_THE_WAY


@frozen(eq=False)
class Planned:
    """Planned positions over the time of a program. This time includes motions and dwells, with the branches
    of a WHEN one after the other.

    Attributes:
        cubics: segments of the plan, in order [rad or m, s].
        begins: (N,) beginning of each segment [s]. If the next segment begins later than a segment ends, the
            robot rests in between.
        stand: (n,) position at the start [rad or m].
        duration: duration of the whole program [s].
        dwells: (D, 2) beginning and end of each dwell [s], in order.
        ways: (W, 3) for each WHEN: the time at which its branches part, the time at which the second branch
            begins, and the time at which the second branch ends [s]. A nested WHEN comes after the outer one.
            For each EXIT: the time at which the loop is left, and, twice, the time at which the loop ends.
        lasting: duration of a run of the program, in which only one branch of each WHEN is executed.
    """

    cubics: Cubics
    begins: Array
    stand: Array
    duration: float
    dwells: Array
    ways: Array
    lasting: Lasting

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return positions [rad or m] and velocities, (M, n) each, at times (M,) of the program [s]. At rest,
        the position is that at the end of the previous motion.
        """
        if not len(self.begins):
            stand = np.tile(self.stand, (len(times), 1))
            return stand, np.zeros_like(stand)
        rows = self._rows(times)
        return self.cubics.take(rows).at(np.clip(times - self.begins[rows], 0.0, self.cubics.h[rows]))

    def segment_times(self, times: Array) -> Array:
        """Return the segment times (M,) [s] at times (M,) of the program [s]."""
        return self.cubics.h[self._rows(times)] if len(self.begins) else np.zeros(len(times))

    def _rows(self, times: Array) -> NDArray[np.int64]:
        """Return for each of the times (M,) the number of the last segment that has begun; 0 before all of
        them.
        """
        return np.clip(np.searchsorted(self.begins, times, side="right") - 1, 0, len(self.begins) - 1)


def planned_motion(run: RecordedRun) -> Result[Planned]:
    """Reconstruct the planned motion of a run from its log.

    Returns:
        None, with a finding, if the parser rejects the controller text in the log.
    """
    if run.text.startswith(f"; {MADE_ON_THE_WAY}"):
        message = f"{run.file}: this run was a jog or followed a master, and has no plan to compare with"
        return Result(None, (Diagnostic("Y1404", message, help="`yarc replay` shows what happened"),))
    controller = run.robot.controller
    content = reader_of(controller).read(run.text, controller, NO_MEMORY)
    if isinstance(content, Unreadable):
        return _refused(run, f"line {content.line} {content.reason}")
    if content.start.printed is None:
        return _refused(run, "it isn't made for streaming, and was never carried out")
    return Result(
        _planned(content, content.start.printed, run.robot.axis_units, counts_dwells=run.counts_dwells)
    )


def _refused(run: RecordedRun, reason: str) -> Result[Planned]:
    message = f"{run.file}: the controller text in it can't be read: {reason}"
    help_ = f"read the log with yarclang {run.version}, which wrote it"
    return Result(None, (Diagnostic("Y1404", message, help=help_),))


def _planned(content: ControllerText, start: Array, units: Array, *, counts_dwells: bool) -> Planned:
    """Return the segments of all sequences of moves in a controller text. The control points of a sequence
    are S, S, S, c1 ... cM, cM, cM (TUM 289). The first sequence begins at `start` (n,) in axis units.
    """
    if not counts_dwells:
        content = replace(content, course=tuple(one for one in content.course if not isinstance(one, Dwelt)))
    schedule = content.schedule
    stand = start
    control, at, time = [np.empty((0, len(units)))], [np.empty(0, dtype=np.int64)], [np.empty(0)]
    begins: list[Array] = [np.empty(0)]
    base = 0
    dwells: list[tuple[float, float]] = []
    for item, begin, end in zip(content.course, schedule.places, schedule.places[1:], strict=False):
        match item:
            case Run():
                sequence = np.concatenate(
                    [np.tile(stand, (3, 1)), item.points, np.tile(item.points[-1], (2, 1))]
                )
                count = len(item.points) + 2
                control.append(sequence)
                at.append(base + np.arange(count))
                time.append(np.full(count, item.segment))
                begins.append(np.asarray(begin + item.segment * np.arange(count), dtype=np.float64))
                stand, base = item.points[-1], base + len(sequence)
            case Stood(point=point):
                stand = point
            case Dwelt() if end > begin:
                dwells.append((begin, end))
            case _:
                pass
    cubics = Cubics.of_spline(np.concatenate(control) * units, np.concatenate(at), np.concatenate(time))
    return Planned(
        cubics,
        np.concatenate(begins),
        start * units,
        schedule.places[-1],
        np.array(dwells, dtype=np.float64).reshape(-1, 2),
        np.array(_ways(content, schedule), dtype=np.float64).reshape(-1, 3),
        schedule.lasting,
    )


def _ways(content: ControllerText, schedule: Schedule) -> list[tuple[float, float, float]]:
    """Return for each WHEN the time at which its branches part, the time at which the second branch begins,
    and the time at which the second branch ends [s].

    The steps between an EXIT and the end of its loop also count as a branch. The parser has checked that
    every WHEN has an end.
    """
    open_: list[tuple[int, float, float | None]] = []
    ways: dict[int, tuple[float, float, float]] = {}
    loops: list[list[tuple[int, float]]] = []
    for number, (item, now) in enumerate(zip(content.course, schedule.places, strict=False)):
        match item:
            case Barred(kind="when"):
                open_.append((number, now, None))
            case Barred(kind="else") if open_:
                open_[-1] = (*open_[-1][:2], now)
            case Barred(kind="end") if open_:
                first, begins, second = open_.pop()
                ways[first] = (begins, now if second is None else second, now)
            case Barred(kind="loop"):
                loops.append([])
            case Barred(kind="exit") if loops:
                loops[-1].append((number, now))
            case Barred(kind="endloop") if loops:
                ways |= {exit_: (begins, now, now) for exit_, begins in loops.pop()}
            case _:
                pass
    return [ways[first] for first in sorted(ways)]
