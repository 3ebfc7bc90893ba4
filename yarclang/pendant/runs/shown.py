"""Conversion of a run log to a message for pages. It runs in a process of its own, because a log may be
large or forged.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from yarclang.pendant.messages import runs as said
from yarclang.report.runs.course import outcome_text, spans_of
from yarclang.report.runs.log import RecordedRun, read_run
from yarclang.report.runs.panels import thinned
from yarclang.report.runs.planned import planned_motion
from yarclang.report.runs.signal_rows import signal_rows
from yarclang.report.runs.text import moments_of
from yarclang.report.runs.tracking import Tracking, tracking_of
from yarclang.robot.model import Array
from yarclang.runtime.notices import Remark
from yarclang.runtime.state import State

_INTERVALS = 1000
"""Number of time intervals into which a plotted curve is divided at most, for all passes of a repeated
program together. Two points are drawn for each interval.
"""
_FEWEST = 20
"""Number of time intervals into which the curve of a pass is divided at least, however many passes
there are.
"""
_MOST_ROWS = 1500
"""Largest number of recorded robot positions that are drawn as the path of a run."""
_MOST_EVENTS, _MOST_SPANS, _MOST_SIGNALS, _MOST_STRETCHES = 1000, 1000, 32, 1000
_LONGEST = 500
"""Longest text of an event [characters]."""

Window = tuple[float, float]
"""Start and end of the time range of plotted curves [s since the log was opened]."""


class CannotShow(Exception):  # noqa: N818 - it is an answer
    """Raised if a log can't be shown; the message is the reason."""


def shown(file: str, window: Window | None = None) -> said.RunShown:
    """Return the content of a run log.

    Args:
        file: path of the log.
        window: time range of the plotted curves [s since the log was opened]; None for the whole run.

    Raises:
        CannotShow: the file is no log of a run, or can't be read.
    """
    read = read_run(file)
    run, notes = read.value, [one.message for one in read.diagnostics]
    if run is None:
        what = read.diagnostics[0]
        raise CannotShow(f"{what.message}: {what.help}" if what.help else what.message)
    planned = planned_motion(run)
    notes += [one.message for one in planned.diagnostics]
    tracking = None if planned.value is None else tracking_of(run, planned.value)
    text, well = outcome_text(run)
    ended = run.outcome
    events = tuple(_events(run))
    return said.RunShown(
        program=run.program[:_LONGEST],
        robot=run.robot.name[:_LONGEST],
        controller=run.controller[:_LONGEST],
        version=run.version[:_LONGEST],
        started=run.started[:_LONGEST],
        pace=_finite(run.pace),
        end_s=_finite(run.end),
        outcome=text[:_LONGEST],
        well=well,
        code="" if ended is None else ended.code[:10],
        remedy="" if ended is None else ended.remedy[:_LONGEST],
        notes=tuple(one.replace(f"{file}: ", "").replace(file, "the log")[:_LONGEST] for one in notes),
        joints=_joints(run),
        lines=tuple(_lines(run, tracking, window)),
        planned=None
        if tracking is None or planned.value is None
        else _line(
            "Planned",
            run.robot.axis_unit_names[0],
            run.robot.joint_names,
            run.times[tracking.rows],
            planned.value.at(tracking.times)[0] / run.robot.axis_units,
            _breaks(tracking),
            window,
        ),
        states=_states(run, tracking),
        signals=_signals(run),
        events=events[:_MOST_EVENTS],
        more_events=max(0, len(events) - _MOST_EVENTS),
        way=_way(run),
    )


def _joints(run: RecordedRun) -> tuple[said.RunJoint, ...]:
    robot = run.robot
    rows = zip(
        robot.joint_names,
        robot.axis_unit_names,
        robot.lower / robot.axis_units,
        robot.upper / robot.axis_units,
        strict=True,
    )
    return tuple(
        said.RunJoint(
            name=name,
            unit=unit,
            lower=float(lower) if math.isfinite(lower) else None,
            upper=float(upper) if math.isfinite(upper) else None,
        )
        for name, unit, lower, upper in rows
    )


def _lines(run: RecordedRun, tracking: Tracking | None, window: Window | None) -> Iterator[said.RunLines]:
    robot = run.robot
    unit = " or ".join(dict.fromkeys(robot.axis_unit_names))
    names, motors = robot.joint_names, tuple(f"motor {one}" for one in robot.controller.motors)
    passes = [int(one) + 1 for one in np.flatnonzero(np.diff(run.passes))]
    yield _line("Positions", unit, names, run.times, run.actual / robot.axis_units, passes, window)
    if tracking is not None:
        times, breaks = run.times[tracking.rows], _breaks(tracking)
        yield _line("Actual − planned", unit, names, times, tracking.error / robot.axis_units, breaks, window)
        off = tracking.off_path / robot.axis_units
        yield _line("Commanded off the path", unit, names, times, off, breaks, window)
    yield _line("Following error", "counts", motors, run.times, run.following, passes, window)


def _breaks(tracking: Tracking) -> list[int]:
    return [int(one) for one in tracking.breaks]


def _line(
    title: str,
    unit: str,
    names: tuple[str, ...],
    times: Array,
    values: Array,
    breaks: list[int],
    window: Window | None,
) -> said.RunLines:
    """Return the curves of one plot. The points are thinned separately for each pass of a repeated
    program.
    """
    ends = [0, *(one for one in breaks if 0 < one < len(times)), len(times)]
    inside = np.ones(len(times), dtype=bool)
    if window is not None:
        inside = (times >= window[0]) & (times <= window[1])
    columns = max(_FEWEST, _INTERVALS // max(1, len(ends) - 1))
    lines_of_passes: list[tuple[Array, Array]] = []
    for a, b in list(pairwise(ends))[: _INTERVALS // _FEWEST]:
        rows = a + np.flatnonzero(inside[a:b])
        if len(rows):
            lines_of_passes.append(thinned(times[rows], values[rows], columns))
    lines_made = (
        [_clean(np.concatenate(each)) for each in zip(*lines_of_passes, strict=True)]
        if lines_of_passes
        else []
    )
    starts = np.cumsum([len(each) for each, _ in lines_of_passes])[:-1] if lines_of_passes else ()
    return said.RunLines(
        title=title,
        unit=unit,
        names=names,
        times=tuple(lines_made[0].round(4).tolist()) if lines_of_passes else (),
        values=tuple(tuple(column) for column in lines_made[1].T.round(5).tolist())
        if lines_of_passes
        else ((),) * len(names),
        breaks=tuple(int(one) for one in starts),
    )


def _states(run: RecordedRun, tracking: Tracking | None) -> tuple[said.RunSpan, ...]:
    if tracking is None:
        empty = np.empty(0)
        tracking = Tracking(np.empty(0, dtype=np.int64), empty, empty, empty, np.empty(0, dtype=np.int64))
    spans = spans_of(run, tracking)[:_MOST_SPANS]
    return tuple(
        said.RunSpan(state=one.state.value, from_s=_finite(one.start), to_s=_finite(one.end))
        for one in spans
        if one.state in (State.HOLD, State.FAULT, State.DISCONNECTED)
    )


def _signals(run: RecordedRun) -> tuple[said.RunSignal, ...]:
    return tuple(
        said.RunSignal(
            name=one.name[:_LONGEST],
            is_input=one.is_input,
            stretches=tuple(
                said.RunStretch(from_s=_finite(a), to_s=_finite(b), value=_finite(value))
                for a, b, value in one.stretches[:_MOST_STRETCHES]
            ),
            waits=tuple(
                said.RunWait(from_s=_finite(a), to_s=_finite(b), met=met)
                for a, b, met in one.waits[:_MOST_STRETCHES]
            ),
        )
        for one in signal_rows(run)[:_MOST_SIGNALS]
    )


def _events(run: RecordedRun) -> Iterator[said.RunEvent]:
    warned = {one.time for one in run.told if isinstance(one, Remark) and one.warning}
    for one in moments_of(run):
        if one.line:
            yield said.RunEvent(
                time_s=_finite(one.time), text=one.line[:_LONGEST], warning=one.time in warned
            )


def _way(run: RecordedRun) -> said.RunWay:
    """Return the recorded joint positions, thinned to at most `_MOST_ROWS` times."""
    count = len(run.times)
    if not count:
        return said.RunWay(times=(), joints=())
    rows = np.unique(np.linspace(0, count - 1, min(count, _MOST_ROWS)).astype(np.intp))
    joints = _clean(run.actual[rows] / run.robot.axis_units)
    return said.RunWay(
        times=tuple(_clean(run.times[rows]).round(4).tolist()),
        joints=tuple(tuple(row) for row in joints.round(4).tolist()),
    )


def _clean(values: Array) -> Array:
    """Return values without non-finite and very large numbers. A forged log may contain such numbers, and
    JSON can't represent non-finite ones.
    """
    found: Array = np.nan_to_num(values, nan=0.0, posinf=1e12, neginf=-1e12).clip(-1e12, 1e12)
    return found


def _finite(value: float) -> float:
    return round(value, 5) if math.isfinite(value) else 0.0


def as_json(file: str, window: Window | None = None) -> str:
    """Return the content of a run log as JSON. If the log can't be shown, the JSON object has only the key
    `refused`, with the reason.

    Args:
        file: path of the log.
        window: time range of the plotted curves [s since the log was opened]; None for the whole run.
    """
    try:
        return shown(file, window).model_dump_json()
    except CannotShow as why:
        refused = str(why).replace(file, "the log")
    except MemoryError:
        refused = "the log needs more memory than allowed here"
    except Exception as error:  # forged numbers may raise any exception in numerics
        refused = f"the log has contradictory content ({type(error).__name__})"
    return json.dumps({"refused": refused})


def main() -> None:
    """Write the content of a run log to standard output, as JSON. The first argument of the command line
    is the path of the log. Two optional arguments are the start and the end of the time range of the
    plotted curves [s].
    """
    file, *given = sys.argv[1:]
    sys.stdout.write(as_json(file, (float(given[0]), float(given[1])) if given else None))
