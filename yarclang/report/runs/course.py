"""Find the robot's states during a run, the notable events, and the outcome."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from yarclang.frozen import frozen
from yarclang.report.runs.log import RecordedRun
from yarclang.report.runs.messages import Outcome
from yarclang.report.runs.tracking import Tracking
from yarclang.runtime.job import clock_at
from yarclang.runtime.notices import Changed, Remark
from yarclang.runtime.state import State

TROUBLED = (State.HOLD, State.FAULT, State.DISCONNECTED)
"""States that aren't part of an undisturbed run."""

_AT_ONCE = 0.1
"""Events whose times differ by less become one mark [s]."""


@frozen
class Span:
    """An interval of a run in which the robot was in one state.

    Attributes:
        state: state of the robot.
        start: beginning of the interval [s of the run].
        end: end of the interval [s of the run].
        begins: beginning of the interval [s of the program]; None before the program has begun.
        ends: end of the interval [s of the program]; None before the program has begun.
    """

    state: State
    start: float
    end: float
    begins: float | None
    ends: float | None


@frozen
class Mark:
    """A notable event of a run.

    Attributes:
        time: time of the event [s of the run].
        at: time of the event [s of the program]; None before the program has begun.
        text: description.
    """

    time: float
    at: float | None
    text: str


def spans_of(run: RecordedRun, tracking: Tracking) -> tuple[Span, ...]:
    """Return the states in the order of time."""
    first: list[tuple[State, float]] = []
    for one in run.told:
        # the same state may be reported again, with another reason
        if isinstance(one, Changed) and not (first and first[-1][0] is one.state):
            first.append((one.state, one.time))
    times = [time for _, time in first] + [max(run.end, first[-1][1] if first else 0.0)]
    return tuple(
        Span(state, start, end, _program_time(run, tracking, start), _program_time(run, tracking, end))
        for (state, _), (start, end) in zip(first, pairwise(times), strict=True)
    )


def marks_of(run: RecordedRun, tracking: Tracking) -> tuple[Mark, ...]:
    """Return the notable events of a run: remarks, orders of users, and the causes of states that weren't
    planned. Events that are less than `_AT_ONCE` apart become one mark.
    """
    marks: list[Mark] = []
    for message in run.told:
        if isinstance(message, Remark):
            text = message.text
        elif isinstance(message, Changed) and message.state in TROUBLED and message.why:
            text = f"{message.state.value}: {message.why}"
        else:
            continue
        if marks and message.time - marks[-1].time < _AT_ONCE:
            marks[-1] = replace(marks[-1], text=f"{marks[-1].text}; {text}")
        else:
            marks.append(Mark(message.time, _program_time(run, tracking, message.time), text))
    return tuple(marks)


def outcome_text(run: RecordedRun) -> tuple[str, bool | None]:
    """Return the outcome of the run, and True if the run ended well; None if unknown."""
    outcome: Outcome | None = run.outcome
    if outcome is None:
        last = next((one.state for one in reversed(run.told) if isinstance(one, Changed)), None)
        state = f", {last.value} at last" if last else ""
        return f"the log doesn't say how it ended: {run.end:.1f} s of it are here{state}", None
    if outcome.well:
        return "came to its end", True
    done = clock_at(run.commands, outcome.done)
    where = f" ({outcome.command}, {done:.1f} s into the program)" if outcome.command else ""
    return f"{outcome.what}{where}", False


def _program_time(run: RecordedRun, tracking: Tracking, time: float) -> float | None:
    """Convert the time of an event in a run to the time of the program. None if the event is more than 0.5 s
    before the program's first sample, or more than 15 s after its last sample.
    """
    times = run.times[tracking.rows]
    if not len(times) or not times[0] - 0.5 <= time <= times[-1] + 15.0:
        return None
    behind = int(np.searchsorted(times, time, side="right"))
    if behind in tracking.breaks and behind:
        return float(tracking.times[behind - 1])
    return float(np.interp(time, times, tracking.times))
