"""The course of a run: its states as spans of time, and what is worth marking on them."""

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
"""States that nobody planned."""

_AT_ONCE = 0.1
"""Things that are nearer to each other are told as one [s]."""


@frozen
class Span:
    """A state from `start` to `end` [s of the run], and from `begins` to `ends` [s of the program]; None where the program
    hadn't begun.
    """

    state: State
    start: float
    end: float
    begins: float | None
    ends: float | None


@frozen
class Mark:
    """Something worth knowing, at `time` [s of the run] and `at` [s of the program], if it had begun."""

    time: float
    at: float | None
    text: str


def spans_of(run: RecordedRun, tracking: Tracking) -> tuple[Span, ...]:
    """The states, one behind the other."""
    first: list[tuple[State, float]] = []
    for one in run.told:
        # the same state may be told of again, with another reason
        if isinstance(one, Changed) and not (first and first[-1][0] is one.state):
            first.append((one.state, one.time))
    times = [time for _, time in first] + [max(run.end, first[-1][1] if first else 0.0)]
    return tuple(
        Span(state, start, end, _program_time(run, tracking, start), _program_time(run, tracking, end))
        for (state, _), (start, end) in zip(first, pairwise(times), strict=True)
    )


def marks_of(run: RecordedRun, tracking: Tracking) -> tuple[Mark, ...]:
    """Remarks, orders, and what led into a state that nobody planned; what comes at once is one mark."""
    found: list[Mark] = []
    for one in run.told:
        if isinstance(one, Remark):
            text = one.text
        elif isinstance(one, Changed) and one.state in TROUBLED and one.why:
            text = f"{one.state.value}: {one.why}"
        else:
            continue
        if found and one.time - found[-1].time < _AT_ONCE:
            found[-1] = replace(found[-1], text=f"{found[-1].text}; {text}")
        else:
            found.append(Mark(one.time, _program_time(run, tracking, one.time), text))
    return tuple(found)


def outcome_text(run: RecordedRun) -> tuple[str, bool | None]:
    """How the run has ended, and whether that is well; None where nobody knows."""
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
    """When in the program something happened; None before its first sample and, but for a moment, behind the last."""
    times = run.times[tracking.rows]
    if not len(times) or not times[0] - 0.5 <= time <= times[-1] + 15.0:
        return None
    behind = int(np.searchsorted(times, time, side="right"))
    if behind in tracking.breaks and behind:
        return float(tracking.times[behind - 1])
    return float(np.interp(time, times, tracking.times))
