"""Find the straight motions by which a robot approaches a workpiece and leaves it. Bodies that touch while
the workpiece is taken or put down may also touch during these motions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

from yarclang.cell.model import Grip
from yarclang.frozen import frozen
from yarclang.hir import (
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Finish,
    Gap,
    LineMove,
    Loop,
    Motion,
    NextPass,
    SetOutput,
    Step,
    Stop,
    When,
)


@frozen
class Lead:
    """A SET of a gripper that a motion approaches or leaves, directly or with other straight motions in
    between.

    Attributes:
        to: the step of the SET.
        between: the steps of the motions that come next on the way to the SET, one for each branch; empty if
            the motion itself begins or ends at the SET on some branch.
    """

    to: int
    between: tuple[int, ...] = ()


@frozen(eq=False)
class Runs:
    """The SETs of grippers that each motion approaches and leaves.

    A motion has several SETs if branches of a WHEN come from different SETs or lead to different SETs.

    Attributes:
        towards: by the step of a motion, the SETs that the motion approaches; missing if it approaches none
            on one of its branches.
        away: by the step of a motion, the SETs that the motion leaves; missing if it leaves none on one of
            its branches.
        leaves: by the step of a motion, the SETs from which the robot is still departing, on every branch
            that comes from the SET. Until it has departed, the places of the workpieces that these SETs took
            stay empty: the next workpieces come later.
    """

    towards: Mapping[int, tuple[Lead, ...]]
    away: Mapping[int, tuple[Lead, ...]]
    leaves: Mapping[int, frozenset[int]]


NO_RUNS = Runs({}, {}, {})

BEFORE = -1
"""Step number of all SETs in lines of a session before a program. SETs in lines after the program have the
number of steps of the program as their step number.
"""


def runs_of(
    steps: Sequence[Step], grippers: Mapping[str, Grip], *, leaves: bool = False, goes_on: bool = False
) -> Runs:
    """Find the motions by which the robot approaches and leaves each SET of a gripper: a single motion of any
    kind, or several linear motions.

    Args:
        steps: steps of a program.
        grippers: grippers by the variables of their outputs.
        leaves: True if a SET precedes the program.
        goes_on: True if a SET may follow the program.
    """
    if not grippers:
        return NO_RUNS
    closing = tuple((variable, grip.value) for variable, grip in grippers.items())
    return _runs_of(tuple(steps), closing, leaves, goes_on)


@lru_cache(maxsize=16)
def _runs_of(
    steps: tuple[Step, ...], closing: tuple[tuple[str, float], ...], leaves: bool, goes_on: bool
) -> Runs:
    values = dict(closing)
    away = _along(steps, range(len(steps)), values, BEFORE if leaves else None)
    towards = _along(steps, range(len(steps) - 1, -1, -1), values, len(steps) if goes_on else None)
    still = {
        at: frozenset(one.set for one in ways if one.set is not None and not one.left)
        - {one.set for one in ways if one.left}
        for at, ways in away.items()
    }
    return Runs(_leads(towards), _leads(away), still)


@frozen
class _Way:
    """A control-flow path on which a step is reached.

    Attributes:
        set: the last SET of a gripper on this path; None if there is none.
        motion: the last motion since the SET; None if there was no motion yet.
        left: True if the straight motions that belong to the SET are over.
    """

    set: int | None = None
    motion: int | None = None
    left: bool = False


_NOWHERE = frozenset({_Way(left=True)})


def _along(
    steps: tuple[Step, ...], numbers: range, closing: Mapping[str, float], first: int | None
) -> dict[int, frozenset[_Way]]:
    """Return the control-flow paths on which each motion is reached.

    Args:
        steps: steps of a program.
        numbers: numbers of the steps, in the order of traversal; descending numbers search backwards.
        closing: the values that close grippers, by the variables of their outputs.
        first: the SET that precedes the first of these steps, or None.
    """
    opens, ends = (When, EndWhen) if numbers.step > 0 else (EndWhen, When)
    now = behind = _NOWHERE if first is None else frozenset({_Way(first)})
    around: list[tuple[frozenset[_Way], frozenset[_Way] | None]] = []
    found: dict[int, frozenset[_Way]] = {}
    for at in numbers:
        step = steps[at]
        if isinstance(step, opens):
            around.append((now, None))
        elif isinstance(step, Else | ends):
            # the WHEN may be missing if the steps are a part of a program
            before, other = around.pop() if around else (_NOWHERE, None)
            if isinstance(step, Else):
                around.append((before, now))
                now = before
            else:
                now |= before if other is None else other
        elif isinstance(step, Finish):
            # in a forward search, no step follows on this path; in a backward search, the path begins after
            # the program
            now = frozenset() if numbers.step > 0 else behind
        elif isinstance(step, Stop | Gap | Loop | NextPass | Exit | EndLoop):
            # straight motions don't continue from one pass of a loop to the next, or out of the loop
            now = _NOWHERE
        elif isinstance(step, SetOutput) and step.output.variable in closing:
            now = frozenset(_after_set(steps, at, closing, now, forwards=numbers.step > 0))
        elif isinstance(step, Motion):
            is_line = isinstance(step, LineMove)
            found[at] = frozenset(
                _Way(one.set, one.motion, one.left or (one.motion is not None and not is_line)) for one in now
            )
            now = frozenset(
                _Way(one.set, left=True) if one.left or not is_line else _Way(one.set, at)
                for one in found[at]
            )
    return found


def _after_set(
    steps: tuple[Step, ...],
    at: int,
    closing: Mapping[str, float],
    ways: Iterable[_Way],
    *,
    forwards: bool,
) -> Iterable[_Way]:
    """Yield the control-flow paths after a SET. A SET that repeats the last one has no effect."""
    for one in ways:
        last = steps[one.set] if forwards and one.set is not None and 0 <= one.set < len(steps) else None
        again = isinstance(last, SetOutput) and _does(last, closing) == _does(steps[at], closing)
        yield one if again else _Way(at)


def _does(step: Step, closing: Mapping[str, float]) -> tuple[str, bool]:
    assert isinstance(step, SetOutput)  # only such steps move grippers
    return step.output.variable, step.value == closing[step.output.variable]


def _leads(found: Mapping[int, frozenset[_Way]]) -> dict[int, tuple[Lead, ...]]:
    """Return the SETs that each motion approaches or leaves on all paths, by the motion's step."""
    leads: dict[int, tuple[Lead, ...]] = {}
    for at, ways in found.items():
        if any(one.left or one.set is None for one in ways):
            continue
        between: dict[int, set[int | None]] = {}
        for one in ways:
            assert one.set is not None  # checked above
            between.setdefault(one.set, set()).add(one.motion)
        leads[at] = tuple(
            Lead(number, () if None in motions else tuple(sorted(one for one in motions if one is not None)))
            for number, motions in sorted(between.items())
        )
    return leads
