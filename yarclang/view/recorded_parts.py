"""The parts of a cell during a recorded run: at the times at which the robot got to the SETs that move them."""

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
"""A sample's time in the program may be off by this while the robot stands [s]."""
_STANDS = 0.1
"""If the robot is at a time of the program for longer than this [s], it stands there."""
_BESIDE_WAY = 0.12
"""A time in the program that is nearer to the end of a way may be outside [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class RecordedParts:
    """The parts of a run: as they are shown, and as they were followed through the last pass."""

    shown: ShownParts
    carried: Carried


@dataclass(frozen=True, slots=True, eq=False)
class _Pass:
    """Samples of one pass: at `real` (N,) [s of the run] the robot was at `told` (N,) [s of the program], which never falls; `is_whole` says that it came to its end."""

    real: Array
    told: Array
    is_whole: bool

    def when(self, time: float, *, leaves: bool) -> float | None:
        """Return when the robot was at a time of the program [s of the run]; None if it never got there.

        Args:
            time: in the program [s].
            leaves: if the robot stands there for a while, return when it goes on, not when it has come.
        """
        if time > self.told[-1] + _BESIDE:
            return float(self.real[-1]) if self.is_whole else None
        first = int(np.searchsorted(self.told, time - _BESIDE, side="left"))
        last = int(np.searchsorted(self.told, time + _BESIDE, side="right")) - 1
        if last < 0:  # it began later in the program
            return float(self.real[0])
        begins, ends = float(self.real[first]), float(self.real[last])
        if ends - begins > _STANDS:
            return ends if leaves else begins
        return float(np.interp(time, self.told, self.real))


def recorded_parts(
    run: RecordedRun, tracking: Tracking, does: Executed, program: Program | None
) -> RecordedParts | None:
    """Show the parts of a run.

    Args:
        run: the log.
        tracking: when in the program each sample was taken.
        does: what the text of the run does.
        program: the program that the text was made from; None if that isn't known.

    Returns:
        None if the program isn't known, or its cell has no parts.
    """
    carried = carried_in_text(does, program)
    if carried is None or program is None:
        return None
    begins = begins_in_text(does, len(program.steps), counts_dwells=run.counts_dwells)
    moments = [Moment(-np.inf, carried.states[0])]
    for number, one in enumerate(_passes(run, tracking)):
        left_out = frozenset(_left_out(program.steps, begins, one))
        followed = carried_in_text(does, program, left_out)
        assert followed is not None  # as before
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
    """Return True if the robot waits for something between the motion before a step and the step."""
    for step in reversed(steps[:number]):
        if isinstance(step, Motion):
            return False
        if isinstance(step, WaitInput | WaitUntil | Hold | Assign | Turn):
            return True
    return False


def _left_out(steps: Sequence[Step], begins: Sequence[float], one: _Pass) -> Iterator[int]:
    """Yield the steps of the ways that a pass didn't take, and their WHEN, ELSE and END; also what a pass of a loop left out, and where loops begin and end. Of a WHEN whose ways both take no time none is known."""
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
                # a way that takes no time was taken if the other one wasn't
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
    """Return True if a pass was within two times of the program [s]; None if they are the same time."""
    if ends <= begins:
        return None
    margin = min(_BESIDE_WAY, 0.4 * (ends - begins))
    return bool(((one.told > begins + margin) & (one.told < ends - margin)).any())
