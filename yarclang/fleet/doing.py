"""Work for many items: reused where it may be, spread over processes or machines where it is done."""

from __future__ import annotations

from collections.abc import Callable, Generator, Hashable, Sequence
from functools import partial
from pathlib import Path
from typing import TypeVar

from yarclang.consulted import Answers, recorded
from yarclang.fleet.outcome import Lost
from yarclang.fleet.reuse import Found, Reuse
from yarclang.fleet.spreading import Place, spread

T = TypeVar("T")
R = TypeVar("R")


class Doing:
    """Does the same work for many items.

    Args:
        place: where it is done.
        reuse: earlier results; None to do everything anew, and keep nothing.
    """

    def __init__(self, place: Place, reuse: Reuse | None = None) -> None:
        self._place, self._reuse = place, reuse
        self.reused = 0
        """Number of results that were reused."""

    def results(
        self,
        work: Callable[[T], R],
        items: Sequence[T],
        *,
        files: Callable[[T], Sequence[Path]],
        name: Callable[[T], Hashable],
        is_lasting: Callable[[R], bool],
    ) -> Generator[R | Lost, None, None]:
        """Yield the result of `work` for each item, in order.

        Args:
            work: a function of a module, or a `partial` of one, which reads files only through consulted.py.
            items: what it is done for.
            files: returns the files that only one item needs, by what is known in advance.
            name: returns all that distinguishes the work for an item from other work, besides the files.
            is_lasting: returns True for a result that would be the same the next time.

        Raises:
            UnreachableError: the scheduler can't be used.
        """
        found: dict[int, Found] = {}
        if self._reuse is not None:
            for number, item in enumerate(items):
                if (earlier := self._reuse.find(name(item))) is not None:
                    found[number] = earlier
        missing = [item for number, item in enumerate(items) if number not in found]
        made = spread(partial(_with_answers, work), missing, self._place, files)
        for number, item in enumerate(items):
            outcome: tuple[R, Answers] | Lost
            if number in found:
                if (loaded := found.pop(number).load()) is not None:
                    self.reused += 1
                    yield loaded[0]
                    continue
                outcome = _with_answers(work, item)  # dropped in the meantime
            else:
                outcome = next(made)
            if isinstance(outcome, Lost):
                yield outcome
                continue
            result, answers = outcome
            if self._reuse is not None and is_lasting(result):
                self._reuse.keep(name(item), answers, result)
            yield result


def _with_answers(work: Callable[[T], R], item: T) -> tuple[R, Answers]:
    """Return a result, and what it depends on."""
    with recorded() as answers:
        return work(item), answers
