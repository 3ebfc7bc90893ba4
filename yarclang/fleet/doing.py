"""Do the same work for many items. Earlier results are reused if possible; the work on all other items is
distributed to processes or machines.
"""

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
        place: processes or machines that do the work.
        reuse: finds and stores earlier results; None to do everything anew, and store nothing.
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
            work: a module's function, or a `partial` of one, so that it can be sent to other processes. It
                may read files only through consulted.py.
            items: arguments of the work.
            files: function that returns the files that only this item needs, as far as they are known in
                advance.
            name: function that returns a key for the work on an item. The key must contain everything on
                which the result depends, except the contents of files.
            is_lasting: function that returns True if a result may be reused, because the same work would have
                the same result the next time.

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
                outcome = _with_answers(work, item)  # the store has dropped it since then
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
    """Return the result for an item, and the answers to the questions about files on which the result
    depends.
    """
    with recorded() as answers:
        return work(item), answers
