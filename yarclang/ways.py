"""A state that is followed through a program whose ways part, meet, end and come again."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Generic, TypeVar

from yarclang.frozen import frozen
from yarclang.hir import Else, EndLoop, EndWhen, Exit, Finish, Loop, NextPass, Step, When

T = TypeVar("T")

Turn = When | Else | EndWhen | Finish | Loop | NextPass | Exit | EndLoop
"""Steps at which a program doesn't simply go on to the next one."""


@frozen(eq=False)
class Open(Generic[T]):
    """A WHEN or a loop that isn't ended.

    `before` is the state in front of it. `other` is, of a WHEN, that at the end of its first way (None in front of its second), and of a loop that at its EXITs (None: there was none yet).
    `ends` says that the program doesn't come to the end of the first way.
    """

    step: When | Loop
    before: T
    other: tuple[T] | None = None
    ends: bool = False


@frozen(eq=False)
class Ways(Generic[T]):
    """The state between two steps, and what is open around it. `ends`: no way leads here."""

    state: T
    ends: bool = False
    open: tuple[Open[T], ...] = ()

    def turned(self, step: Turn, meet: Callable[[T, T, Turn], T]) -> Ways[T]:
        """Return what is known behind a step.

        Args:
            step: where ways part, meet, end or come again. One that doesn't belong to what is open changes nothing.
            meet: makes one state of two that meet: that of the way that comes first in the program, that of the other one, and the step that began both, or the
                step at which a loop begins anew. Two states that can't be one are its business.
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
        """Return the place of the innermost loop among what is open."""
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
    """Return steps that lead to the last of them in one line, without those at which ways part or meet.

    Of the ways of a WHEN it is the first by which the program goes on; of one that is open, its last; of a loop one pass up to where it is left.
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
