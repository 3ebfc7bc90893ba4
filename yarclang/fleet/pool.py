"""Processes on this machine that do the same work for many items."""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from yarclang.fleet.outcome import Lost
from yarclang.fleet.packing import packed, unpacked
from yarclang.progress import silent

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import SpawnProcess

_AHEAD = 16
"""Largest number of items per worker that are handed out ahead of the oldest item without a result."""

_DEATHS = 2
"""Number of killed workers after which an item is given up."""


class Pool:
    """Processes on this machine. They are started when they are needed for the first time."""

    def __init__(self, work: bytes, number: int) -> None:
        self._work, self._number = work, number
        self._items: Sequence[Any] = ()
        self._waiting: deque[int] = deque()
        self._workers: dict[Connection, tuple[SpawnProcess, Connection]] = {}
        """The processes. Each key is the connection on which a process sends results; its value is the
        process and the connection on which the process gets items.
        """
        self._busy: dict[Connection, int] = {}
        self._deaths: dict[int, int] = {}
        self._done: dict[int, Any] = {}
        self._until = 0
        """Items from this number on aren't handed out until earlier results have been fetched."""

    def results(self, items: Sequence[Any]) -> Iterator[Any]:
        """Yield the results of the work for items, in order. All results of an earlier call must have been
        fetched.
        """
        made = self._made(items)
        self._until = _AHEAD * self._number
        kept: dict[int, Any] = {}
        for wanted in range(len(items)):
            while wanted not in kept:
                number, result = next(made)
                kept[number] = result
            self._until = wanted + 1 + _AHEAD * self._number
            yield kept.pop(wanted)

    def ended(self, items: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield the number of each item and its result as soon as the result is available, in any order. All
        results of an earlier call must have been fetched.
        """
        self._until = len(items)
        return self._made(items)

    def _made(self, items: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        from multiprocessing.connection import wait

        self._items, self._waiting, self._deaths, self._done = items, deque(range(len(items))), {}, {}
        for _ in items:
            while not self._done:
                self._hand_out()
                for line in wait(list(self._busy)):
                    self._take(line)  # type: ignore[arg-type]
            yield self._done.popitem()

    def end(self) -> None:
        """End all processes."""
        for answers, (process, items) in self._workers.items():
            answers.close()
            items.close()
            process.terminate()
        for process, _ in self._workers.values():
            process.join()

    def _hand_out(self) -> None:
        """Give items to idle processes, as long as the items aren't too far ahead."""
        while self._waiting and self._waiting[0] < self._until:
            idle = next((line for line in self._workers if line not in self._busy), None)
            if idle is None:
                if len(self._workers) >= self._number:
                    return
                idle = self._started()
            number = self._waiting.popleft()
            self._busy[idle] = number
            with suppress(OSError):  # the process has ended: reading its connection shows this
                self._workers[idle][1].send(packed(self._items[number]))

    def _started(self) -> Connection:
        from multiprocessing import get_context

        # Processes are spawned, not forked: in a fork, a library with running threads may wait for them
        # forever.
        context = get_context("spawn")
        # Two one-way pipes: a two-way pipe needs sockets, which not every system has.
        taken, items = context.Pipe(duplex=False)
        answers, given = context.Pipe(duplex=False)
        process = context.Process(target=_serve, args=(self._work, taken, given), daemon=True)
        # Ctrl-C is meant for this process. The processes that are started here ignore it while they import.
        heard = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            process.start()
        finally:
            signal.signal(signal.SIGINT, heard)
        taken.close()
        given.close()
        self._workers[answers] = process, items
        return answers

    def _take(self, line: Connection) -> None:
        """Receive a result, or notice that a process has ended."""
        number = self._busy.pop(line)
        try:
            content, error = line.recv()
        except (EOFError, OSError):
            self._bury(line, number)
            return
        if error is not None:
            raise error
        self._done[number] = unpacked(content)

    def _bury(self, line: Connection, number: int) -> None:
        process, items = self._workers.pop(line)
        line.close()
        items.close()
        process.join()
        self._deaths[number] = self._deaths.get(number, 0) + 1
        if self._deaths[number] < _DEATHS:
            self._waiting.appendleft(number)
        else:
            self._done[number] = Lost(_how_it_ended(process.exitcode))


def _how_it_ended(status: int | None) -> str:
    """Return, in words, how the processes that worked on an item have ended."""
    if status is not None and status < 0:
        with suppress(ValueError):
            name = signal.Signals(-status).name
            hint = "; is there enough memory?" if name == "SIGKILL" else ""
            return f"two processes that worked on it were killed by {name}{hint}"
    return f"two processes that worked on it exited, the last one with status {status}"


def _serve(work: bytes, items: Connection, answers: Connection) -> None:
    """Do the work for items until there are no more items."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    do: Callable[[Any], Any] = unpacked(work)
    with silent(), suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            item = unpacked(items.recv())
            try:
                answer: tuple[bytes, BaseException | None] = packed(do(item)), None
            except Exception as error:  # reported by the parent process
                answer = b"", RuntimeError(f"{type(error).__name__}: {error}")
            answers.send(answer)
