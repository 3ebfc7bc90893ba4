"""Follow a state (such as the robot's position) through a program with branches, loops and early ends."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Generic, TypeVar

from yarclang.frozen import frozen
from yarclang.hir import Else, EndLoop, EndWhen, Exit, Finish, Loop, NextPass, Step, When

T = TypeVar("T")

Turn = When | Else | EndWhen | Finish | Loop | NextPass | Exit | EndLoop
"""Steps after which a program doesn't always continue with the next step."""


@frozen(eq=False)
class Open(Generic[T]):
    """A WHEN or a loop whose end hasn't been reached yet, with the states that some analysis follows.

    Attributes:
        step: the When or Loop that opened it.
        before: the state before the step.
        other: for a WHEN, the state at the end of its first branch (None while still in it). For a loop, the
            merged state of its EXITs so far (None: no EXIT yet).
        ends: True if the first branch never reaches its end.
    """

    step: When | Loop
    before: T
    other: tuple[T] | None = None
    ends: bool = False


@frozen(eq=False)
class Ways(Generic[T]):
    """An analysis's state between two steps of a program, such as where the robot is, with the open WHENs and
    loops around them.

    Attributes:
        state: the state that is followed.
        ends: True if this place cannot be reached.
        open: the open WHENs and loops, outermost first.
    """

    state: T
    ends: bool = False
    open: tuple[Open[T], ...] = ()

    def turned(self, step: Turn, meet: Callable[[T, T, Turn], T]) -> Ways[T]:
        """Return the state after a step.

        Args:
            step: the step at which branches split, merge or end, or a loop begins or repeats. A step without
                a matching open WHEN or loop changes nothing.
            meet: merges two states. Its arguments are the state of the branch that comes first in the
                program, the state of the other branch, and the step that began both (or the NextPass that
                repeats a loop). `meet` itself handles states that can't be merged.
        """
        top = self.open[-1] if self.open else None
        match step:
            case When() | Loop():
                return replace(self, open=(*self.open, Open(step, self.state)))
            case Finish():
                return replace(self, ends=True)
            case Else() if top is not None:
                parted = replace(top, other=(self.state,), ends=self.ends)
                return Ways(top.before, False, (*self.open[:-1], parted))
            case EndWhen() if top is not None:
                return self._met(top, meet)
            case NextPass():
                if not self.ends and (loop := self._loop()) is not None:
                    meet(self.open[loop].before, self.state, step)
                return replace(self, ends=True)
            case Exit():
                return replace(self, ends=True, open=self._left(meet))
            case EndLoop() if top is not None:
                outer = self.open[:-1]
                if top.other is None:
                    return replace(self, open=outer)
                (left,) = top.other
                return Ways(left if self.ends else meet(left, self.state, top.step), False, outer)
        return self

    def _met(self, top: Open[T], meet: Callable[[T, T, Turn], T]) -> Ways[T]:
        outer = self.open[:-1]
        if top.ends:
            return replace(self, open=outer)
        (other,) = top.other or (top.before,)
        return Ways(other if self.ends else meet(other, self.state, top.step), False, outer)

    def _loop(self) -> int | None:
        """Return the index of the innermost loop in `open`; None if there is none."""
        return next(
            (at for at in range(len(self.open) - 1, -1, -1) if isinstance(self.open[at].step, Loop)), None
        )

    def _left(self, meet: Callable[[T, T, Turn], T]) -> tuple[Open[T], ...]:
        at = self._loop()
        if at is None or self.ends:
            return self.open
        loop = self.open[at]
        left = self.state if loop.other is None else meet(loop.other[0], self.state, loop.step)
        return (*self.open[:at], replace(loop, other=(left,)), *self.open[at + 1 :])


def line_to(steps: Iterable[Step]) -> list[Step]:
    """Return one sequence of steps without branches that leads to the last step. It has no When, Else or
    other steps that only mark branches and loops.

    For a WHEN that has ended, the sequence follows the first branch whose end can be reached. For a WHEN that
    hasn't ended yet, it follows the branch of the last step. For a loop, it follows one pass up to its first
    EXIT.
    """
    line: list[Step] = []
    walked = Ways[tuple[Step, ...]](())
    for step in steps:
        if isinstance(step, Turn):
            had = Ways((*walked.state, *line), walked.ends, walked.open)
            walked, line = had.turned(step, lambda first, _, __: first), []
        elif not walked.ends:
            line.append(step)
    return [*walked.state, *line]
