"""Independent pieces of work on many cores: forked processes that see all that is there, and send back what they made.

A door says how many processes there may be (`on_cores`); what takes long below it hands out its pieces (`mapped`). What comes of them, and its order,
doesn't depend on that.

A fork has only the thread that forks, and locks of others stay locked in it: a door says so only where other threads do nothing that the work needs.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
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
    """Let work in this block use so many processes; None: as many as there are cores."""
    token = _PROCESSES.set(cores() if processes is None else processes)
    try:
        yield
    finally:
        _PROCESSES.reset(token)


def cores() -> int:
    """Return how many cores this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def mapped(work: Callable[[T], R], items: Sequence[T]) -> Iterator[R]:
    """Yield what `work` makes of each item, in their order.

    Args:
        work: must not change anything that others see, nor depend on what it did before: another process may do it.
        items: each takes long enough that it's worth while to send back what is made of it.
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
    # what a process was at that was killed
    for place in range(waited_for, len(items)):
        yield done.pop(place) if place in done else work(items[place])


@contextmanager
def _workers(work: Callable[[T], R], items: Sequence[T], number: int) -> Iterator[Iterator[tuple[int, R]]]:
    """Start processes, and let them end, whatever happens."""
    from multiprocessing import get_context

    context = get_context("fork")
    started: list[tuple[ForkProcess, Connection]] = []
    # pages that nobody writes on are there once for all
    gc.freeze()
    try:
        for _ in range(number):
            # where no more processes may be started, those that are there do it, or this one alone
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
    """Hand out places of items, and yield what comes back; a line that ends is one of a process that was killed."""
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
    """Do what is asked for, until nobody asks; nothing is flushed at the end, which is another's."""
    # the one who started us ends us
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    for other in others:
        other.close()
    with silent(), suppress(EOFError, OSError):
        while True:
            place = line.recv()
            try:
                answer: tuple[int, Any, BaseException | None] = (place, work(items[place]), None)
            except Exception as error:  # told where it can be told
                answer = (place, None, error)
            try:
                line.send(answer)
            except (PicklingError, AttributeError, TypeError) as error:
                line.send(
                    (place, None, RuntimeError(f"{answer[2] or answer[1]!r} can't be sent back: {error}"))
                )
