"""Work on many items, on the cores of this machine or on the workers of a scheduler.

Results come in the order of the items, and are the same bytes wherever the work ran. A worker that is killed
costs the items that it had: they are given to others, and an item that kills two workers is `Lost`.
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
"""Number of items from which they are shared among processes, because each process imports everything once.
"""


class Place(NamedTuple):
    """Place at which work is done.

    Attributes:
        processes: number of processes on this machine; None for one a core.
        scheduler: address of a dask scheduler, such as `tcp://HOST:8786`; empty for this machine.
    """

    processes: int | None = None
    scheduler: str = ""


Work = Callable[[Sequence[T]], Iterator[R | Lost]]
"""Yields the result for each item, in order; to be called as often as there are items."""

RacingWork = Callable[[Sequence[T]], Iterator[tuple[int, R | Lost]]]
"""Yields for each item its place and its result, in any order."""


def spread(
    work: Callable[[T], R], items: Sequence[T], place: Place, files: Callable[[T], Sequence[Path]]
) -> Iterator[R | Lost]:
    """Yield the result of `work` for each item, in order; arguments and errors as for `workers`."""
    number = min(_processes(place), len(items)) if len(items) >= _MANY else 1
    with workers(work, place if place.scheduler else Place(number), files) as do:
        yield from do(items)


@contextmanager
def workers(
    work: Callable[[T], R], place: Place, files: Callable[[T], Sequence[Path]]
) -> Iterator[Work[T, R]]:
    """Give a function that does `work` for items, with workers that stay until the end of this block.

    Args:
        work: a function of a module, or a `partial` of one. It reads files only through consulted.py.
        place: where it is done.
        files: returns the files that only one item needs, by what is known in advance.

    Raises:
        UnreachableError: the scheduler can't be used.
    """
    with _crew(work, place, files) as crew:
        yield crew.results


@contextmanager
def racing_workers(
    work: Callable[[T], R], place: Place, files: Callable[[T], Sequence[Path]]
) -> Iterator[RacingWork[T, R]]:
    """Give a function that does `work` for items and yields each result as soon as it is there; else as `workers`."""
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
    """This process alone."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        self._work = work

    def results(self, items: Sequence[Any]) -> Iterator[Any]:
        return map(self._work, items)

    def ended(self, items: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        return enumerate(map(self._work, items))


def _processes(place: Place) -> int:
    return cores() if place.processes is None else place.processes


def own_file(path: str) -> list[Path]:
    """Return the file of an item that is a path; none for standard input."""
    return [] if path == "-" else [Path(path)]
