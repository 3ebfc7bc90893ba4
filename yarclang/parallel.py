"""Distribute independent tasks to many cores, in forked processes that see all data and send back their
results.

A command sets the number of processes (`on_cores`), and long computations inside it distribute their tasks
(`mapped`). Results and their order don't depend on the number.

A fork contains only the thread that forks, and locks that other threads hold stay locked in it. A command
therefore sets the number only if the work needs no lock that another thread may hold.
"""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pickle import PicklingError
from typing import TYPE_CHECKING, Any, TypeVar

from yarclang.progress import silent

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import ForkProcess

T = TypeVar("T")
R = TypeVar("R")

_PROCESSES: ContextVar[int] = ContextVar("processes", default=1)


@contextmanager
def on_cores(processes: int | None = None) -> Iterator[None]:
    """Set the number of processes for the work inside this `with` block; None for one per core."""
    token = _PROCESSES.set(cores() if processes is None else processes)
    try:
        yield
    finally:
        _PROCESSES.reset(token)


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def mapped(work: Callable[[T], R], items: Sequence[T]) -> Iterator[R]:
    """Yield the result of `work` for each item, in order.

    Args:
        work: function of an item. It must neither change shared data nor depend on earlier calls, because it
            may run in another process.
        items: the items. The work for each must take longer than sending back its result.
    """
    number = min(_PROCESSES.get(), len(items))
    if number < 2 or not hasattr(os, "fork"):
        yield from map(work, items)
        return
    done: dict[int, R] = {}
    waited_for = 0
    with _workers(work, items, number) as made:
        for place, result in made:
            done[place] = result
            while waited_for in done:
                yield done.pop(waited_for)
                waited_for += 1
    # The items of killed processes are computed in this process.
    for place in range(waited_for, len(items)):
        yield done.pop(place) if place in done else work(items[place])


@contextmanager
def _workers(work: Callable[[T], R], items: Sequence[T], number: int) -> Iterator[Iterator[tuple[int, R]]]:
    """Start processes, and always end them."""
    from multiprocessing import get_context

    context = get_context("fork")
    started: list[tuple[ForkProcess, Connection]] = []
    # Keep the garbage collector from writing to memory pages that the processes share.
    gc.freeze()
    try:
        for _ in range(number):
            # If no further process can be started, the existing processes do the work, or else this process
            # alone.
            with suppress(OSError):
                ours, theirs = context.Pipe()
                others = [*(line for _, line in started), ours]
                process = context.Process(target=_serve, args=(work, items, theirs, others), daemon=True)
                process.start()
                theirs.close()
                started.append((process, ours))
        yield _results([line for _, line in started], len(items))
    finally:
        for process, line in started:
            line.close()
            process.terminate()
        for process, _ in started:
            process.join()
        gc.unfreeze()


def _results(lines: list[Connection], count: int) -> Iterator[tuple[int, Any]]:
    """Distribute the indices of items to the processes, and yield their results. If a connection ends, its
    process was killed.
    """
    from multiprocessing.connection import wait

    waiting = iter(range(count))
    busy: list[Connection] = []
    for line in lines:
        _hand_out(line, waiting, busy)
    while busy:
        ready = wait(busy)
        for line in [one for one in busy if one in ready]:
            busy.remove(line)
            try:
                place, result, error = line.recv()
            except (EOFError, OSError):
                continue
            if error is not None:
                raise error
            _hand_out(line, waiting, busy)
            yield place, result


def _hand_out(line: Connection, waiting: Iterator[int], busy: list[Connection]) -> None:
    """Give a process the next item, if there is one."""
    place = next(waiting, None)
    if place is not None:
        with suppress(OSError):
            line.send(place)
            busy.append(line)


def _serve(
    work: Callable[[Any], Any], items: Sequence[Any], line: Connection, others: list[Connection]
) -> None:
    """Process the requests of the parent process until there are no more. Buffers aren't flushed at the end,
    since they belong to the parent.
    """
    # Ignore Ctrl-C: the parent receives it too, and ends this process.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    for other in others:
        other.close()
    with silent(), suppress(EOFError, OSError):
        while True:
            place = line.recv()
            try:
                answer: tuple[int, Any, BaseException | None] = (place, work(items[place]), None)
            except Exception as error:  # reported by the parent
                answer = (place, None, error)
            try:
                line.send(answer)
            except (PicklingError, AttributeError, TypeError) as error:
                line.send(
                    (place, None, RuntimeError(f"{answer[2] or answer[1]!r} can't be sent back: {error}"))
                )
