"""Distribution of work for many items to the cores of this machine, or to the workers of a scheduler.

Results come in the order of the items, and are the same, byte for byte, wherever the work is done. If a
worker is killed, its items are given to other workers. An item that kills two workers is `Lost`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from yarclang.fleet.outcome import Lost
from yarclang.fleet.packing import packed
from yarclang.fleet.pool import Pool
from yarclang.parallel import cores

if TYPE_CHECKING:
    from yarclang.fleet.scheduler import Scheduler

T = TypeVar("T")
R = TypeVar("R")

_MANY = 4
"""Least number of items for which several processes are used. For fewer items one process is faster, because
each new process first has to import everything.
"""


class Place(NamedTuple):
    """Processes or machines that do the work.

    Attributes:
        processes: number of processes on this machine; None for one per core.
        scheduler: address of a dask scheduler, such as `tcp://HOST:8786`; empty for this machine.
    """

    processes: int | None = None
    scheduler: str = ""


Work = Callable[[Sequence[T]], Iterator[R | Lost]]
"""Function that yields the result for each item, in order. It can be called several times."""

RacingWork = Callable[[Sequence[T]], Iterator[tuple[int, R | Lost]]]
"""Function that yields the number of each item and its result, in any order."""


def spread(
    work: Callable[[T], R], items: Sequence[T], place: Place, files: Callable[[T], Sequence[Path]]
) -> Iterator[R | Lost]:
    """Yield the result of `work` for each item, in order. Arguments and errors are those of `workers`."""
    number = min(_processes(place), len(items)) if len(items) >= _MANY else 1
    with workers(work, place if place.scheduler else Place(number), files) as do:
        yield from do(items)


@contextmanager
def workers(
    work: Callable[[T], R], place: Place, files: Callable[[T], Sequence[Path]]
) -> Iterator[Work[T, R]]:
    """Yield a function that does `work` for items. The processes that work for it run until the end of the
    context.

    Args:
        work: a module's function, or a `partial` of one, so that it can be sent to other processes. It may
            read files only through consulted.py.
        place: processes or machines that do the work.
        files: function that returns the files that only this item needs, as far as they are known in advance.

    Raises:
        UnreachableError: the scheduler can't be used.
    """
    with _crew(work, place, files) as crew:
        yield crew.results


@contextmanager
def racing_workers(
    work: Callable[[T], R], place: Place, files: Callable[[T], Sequence[Path]]
) -> Iterator[RacingWork[T, R]]:
    """Yield a function that does `work` for items. It yields each result as soon as the result is available,
    while the function of `workers` keeps the order of the items. Arguments and errors are those of `workers`.
    """
    with _crew(work, place, files) as crew:
        yield crew.ended


@contextmanager
def _crew(
    work: Callable[[T], R], place: Place, files: Callable[[T], Sequence[Path]]
) -> Iterator[_Here | Pool | Scheduler]:
    if place.scheduler:
        from yarclang.fleet.scheduler import Scheduler

        scheduler = Scheduler(work, place.scheduler, files)
        try:
            yield scheduler
        finally:
            scheduler.end()
        return
    number = _processes(place)
    if number < 2:
        yield _Here(work)
        return
    pool = Pool(packed(work), number)
    try:
        yield pool
    finally:
        pool.end()


class _Here:
    """Does the work in this process."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        self._work = work

    def results(self, items: Sequence[Any]) -> Iterator[Any]:
        return map(self._work, items)

    def ended(self, items: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        return enumerate(map(self._work, items))


def _processes(place: Place) -> int:
    return cores() if place.processes is None else place.processes


def own_file(path: str) -> list[Path]:
    """Return the file that an item names, for items that are paths; empty for `-`, standard input."""
    return [] if path == "-" else [Path(path)]
