"""Follow the workpieces of a cell during a recorded run. Grippers act at the times at which the robot reached
their SET commands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from yarclang.hir import (
    Assign,
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Hold,
    Loop,
    Motion,
    NextPass,
    Program,
    Step,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.pipeline.executed import Executed
from yarclang.report.carried import Carried, begins_in_text, carried_in_text
from yarclang.report.runs.log import RecordedRun
from yarclang.report.runs.tracking import Tracking
from yarclang.robot.model import Array
from yarclang.view.parts import Moment, ShownParts, shown_parts
from yarclang.ways import Turn

_BESIDE = 0.02
"""Largest difference between the program times of two samples that count as one rest of the robot [s]."""
_STANDS = 0.1
"""Shortest time of the run without progress in the program that counts as a rest [s]."""
_BESIDE_WAY = 0.12
"""Largest time from a sample to the end of a branch at which the sample may belong to steps outside of the
branch [s].
"""


@dataclass(frozen=True, slots=True, eq=False)
class RecordedParts:
    """The workpieces of a recorded run.

    Attributes:
        shown: the workpieces in the picture.
        carried: the workpieces during the last pass through the program.
    """

    shown: ShownParts
    carried: Carried


@dataclass(frozen=True, slots=True, eq=False)
class _Pass:
    """The recorded samples of one pass through the program.

    Attributes:
        real: (N,) times in the run [s].
        told: (N,) times in the program [s], never decreasing.
        is_whole: True if the pass reached its end.
    """

    real: Array
    told: Array
    is_whole: bool

    def when(self, time: float, *, leaves: bool) -> float | None:
        """Convert a time of the program to the time in the run at which the robot reached it [s]; None if it
        was never reached.

        Args:
            time: time in the program [s].
            leaves: if the robot rested at this time of the program, True for the end of the rest, False for
                its beginning.
        """
        if time > self.told[-1] + _BESIDE:
            return float(self.real[-1]) if self.is_whole else None
        first = int(np.searchsorted(self.told, time - _BESIDE, side="left"))
        last = int(np.searchsorted(self.told, time + _BESIDE, side="right")) - 1
        if last < 0:  # the pass began at a later time of the program
            return float(self.real[0])
        begins, ends = float(self.real[first]), float(self.real[last])
        if ends - begins > _STANDS:
            return ends if leaves else begins
        return float(np.interp(time, self.told, self.real))


def recorded_parts(
    run: RecordedRun, tracking: Tracking, does: Executed, program: Program | None
) -> RecordedParts | None:
    """Return the workpieces of a recorded run.

    Args:
        run: the log of the run.
        tracking: time in the program of each sample.
        does: motions of the run's controller text.
        program: the program of the controller text; None if it isn't known.

    Returns:
        None if the program isn't known, or its cell has no workpieces.
    """
    carried = carried_in_text(does, program)
    if carried is None or program is None:
        return None
    begins = begins_in_text(does, len(program.steps), counts_dwells=run.counts_dwells)
    moments = [Moment(-np.inf, carried.states[0])]
    for number, one in enumerate(_passes(run, tracking)):
        left_out = frozenset(_left_out(program.steps, begins, one))
        followed = carried_in_text(does, program, left_out)
        assert followed is not None  # known, as in the first call
        carried = followed
        if number:
            moments.append(Moment(float(one.real[0]), carried.states[0]))
        for state in carried.states[1:]:
            leaves = state.is_motion or _follows_wait(program.steps, state.step)
            when = one.when(begins[state.step], leaves=leaves)
            if when is None:
                break
            moments.append(Moment(max(when, moments[-1].begins), state))
    return RecordedParts(shown_parts(does.robot, moments, carried), carried)


def _passes(run: RecordedRun, tracking: Tracking) -> Iterator[_Pass]:
    passes = run.passes[tracking.rows]
    bounds = [0, *(np.flatnonzero(np.diff(passes)) + 1).tolist(), len(passes)] if len(passes) else []
    for first, behind in pairwise(bounds):
        rows = tracking.rows[first:behind]
        is_well = run.outcome is not None and run.outcome.well
        yield _Pass(run.times[rows], tracking.times[first:behind], is_whole=is_well or behind < len(passes))


def _follows_wait(steps: Sequence[Step], number: int) -> bool:
    """Return True if the robot waits for something between the previous motion and a step."""
    for step in reversed(steps[:number]):
        if isinstance(step, Motion):
            return False
        if isinstance(step, WaitInput | WaitUntil | Hold | Assign | Turn):
            return True
    return False


def _left_out(steps: Sequence[Step], begins: Sequence[float], one: _Pass) -> Iterator[int]:
    """Yield the program steps that a pass left out, and the steps that only mark branches and loops.

    These are: the branches of a WHEN that weren't taken, with their WHEN, ELSE and END; the skipped
    remainders of loops; and the steps at which loops begin and end. If both branches of a WHEN take no time,
    neither is yielded.
    """
    open_: list[tuple[int, int | None]] = []
    loops: list[list[int]] = []
    for number, step in enumerate(steps):
        match step:
            case When():
                open_.append((number, None))
            case Else():
                open_[-1] = (open_[-1][0], number)
            case EndWhen():
                when, other = open_.pop()
                middle = number if other is None else other
                first, second = (
                    _was_in(one, begins[when], begins[middle]),
                    _was_in(one, begins[middle], begins[number]),
                )
                if first is None and second is None:
                    continue
                yield from {when, middle, number}
                # A branch without duration was taken if the other branch wasn't.
                takes_first = first if first is not None else not second
                yield from range(middle, number) if takes_first else range(when, middle)
            case Loop():
                loops.append([])
                yield number
            case Exit() if loops:
                loops[-1].append(number)
                yield number
            case EndLoop() if loops:
                yield number
                for left in loops.pop():
                    if not _was_in(one, begins[left], begins[number]):
                        yield from range(left, number)
            case NextPass():
                yield number


def _was_in(one: _Pass, begins: float, ends: float) -> bool | None:
    """Return True if the robot was between two times of the program [s] during a pass; None if the two times
    are equal.
    """
    if ends <= begins:
        return None
    margin = min(_BESIDE_WAY, 0.4 * (ends - begins))
    return bool(((one.told > begins + margin) & (one.told < ends - margin)).any())
