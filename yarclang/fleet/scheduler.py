"""Work on the workers of a dask scheduler, on machines that share no disk with this one.

The first item is done in this process, to find the questions about files that the work asks (consulted.py).
Each further item is sent with the answers to these questions and with the contents of the files; the content
of a file is sent only once to each worker that needs it. If the work on an item asks a question without an
answer, the worker returns the item with the question. The item is then sent again with the answer.
"""

from __future__ import annotations

import threading
from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from yarclang.consulted import (
    CONTENT,
    Answers,
    Bundle,
    NotBundledError,
    Question,
    answer_now,
    bundled,
    content_now,
    question_of,
    recorded,
)
from yarclang.fleet.installation import Installation, this_installation
from yarclang.fleet.outcome import Lost, UnreachableError
from yarclang.fleet.packing import packed, unpacked

_PATIENCE = 10.0
"""Longest wait for a scheduler, and for its first worker [s]."""

_LARGEST_CHUNK = 16
_CHUNKS_EACH = 4
"""Smallest number of chunks per thread of the workers into which the items are divided, so that the last
chunk doesn't take long.
"""

_UNDER_WAY = 3
"""Number of chunks per thread that are given to the scheduler at the same time."""

_MOST_QUESTIONS = 10_000
"""Largest number of questions about files that one item may ask."""

_DEATHS = 2

_ONE_AT_A_TIME = threading.Lock()
"""Lock of a worker's process: only one of its threads works at a time, because the work isn't thread-safe."""


class Scheduler:
    """Connection to a dask scheduler whose workers do the work.

    Args:
        work: a module's function, or a `partial` of one, so that it can be sent to other processes. It may
            read files only through consulted.py.
        address: address of the scheduler.
        files: function that returns the files that only this item needs, as far as they are known in advance.

    Raises:
        UnreachableError: there is no scheduler, it has no workers, or they have another installation.
    """

    def __init__(
        self, work: Callable[[Any], Any], address: str, files: Callable[[Any], Sequence[Path]]
    ) -> None:
        self._work, self._files = work, files
        self._client = _connected(address)
        try:
            self._threads = _check_workers(self._client, address)
        except BaseException:
            self._client.close()
            raise
        self._common: Answers = {}

    def results(self, items: Sequence[Any]) -> Iterator[Any]:
        """Yield the results for items in order."""
        kept: dict[int, Any] = {}
        wanted = 0
        for number, result in self.ended(items):
            kept[number] = result
            while wanted in kept:
                yield kept.pop(wanted)
                wanted += 1

    def ended(self, items: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield the number of each item and its result as soon as the result is available, in any order."""
        done = 0
        if items and not self._common:
            with recorded() as answers:
                result = self._work(items[0])
            own = {question_of(CONTENT, path) for path in self._files(items[0])}
            self._common = {question: answer for question, answer in answers.items() if question not in own}
            done = 1
            yield 0, result
        rest = _Rest(self._client, self._work, items[done:], self._common, self._threads, self._files)
        try:
            for number, result in rest.ended():
                yield number + done, result
        finally:
            rest.cancel()

    def end(self) -> None:
        """End the connection."""
        self._client.close()


def _connected(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        message = "--scheduler needs the library distributed: pip install 'yarclang[fleet]'"
        raise UnreachableError(message) from None
    try:
        return Client(address, timeout=_PATIENCE, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TimeoutError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        message = f"no scheduler answers at {address}: {reason}; start one with `dask scheduler`"
        raise UnreachableError(message) from None


def _check_workers(client: Any, address: str) -> int:
    """Check that the scheduler has workers with the same yarclang as this machine. Return the number of
    threads of all workers.

    Raises:
        UnreachableError: there are no workers, or one of them has another installation.
    """
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except TimeoutError:
        message = f"the scheduler at {address} has no workers: start some with `dask worker {address}`"
        raise UnreachableError(message) from None
    ours = this_installation()
    try:
        installed = client.run(_installed, on_error="return")
    except Exception as error:  # dask raises the exceptions of the workers
        raise UnreachableError(f"the workers of {address} don't answer: {error}") from None
    for worker, theirs in sorted(installed.items()):
        if not isinstance(theirs, tuple):
            raise UnreachableError(f"worker {worker} has no usable yarclang: {theirs}")
        if difference := ours.difference(Installation(*theirs)):
            raise UnreachableError(f"worker {worker} would give other results: {difference}")
    threads: dict[str, int] = client.nthreads()
    return max(1, sum(threads.values()))


def _installed() -> tuple[Any, ...]:
    """Return the installation of a worker, as a plain tuple."""
    return tuple(this_installation())


class _Rest:
    """The items that the workers do: all except the first one, which this process does."""

    def __init__(
        self,
        client: Any,
        work: Callable[[Any], Any],
        items: Sequence[Any],
        common: Answers,
        threads: int,
        files: Callable[[Any], Sequence[Path]],
    ) -> None:
        self._client, self._work, self._items, self._files = client, packed(work), items, files
        self._do = work
        self._common = common
        self._own: dict[int, Answers] = defaultdict(dict)
        self._asked: dict[Question, int] = {}
        self._contents: dict[str, Any] = {}
        self._waiting = deque(range(len(items)))
        self._deaths: dict[int, int] = {}
        self._done: dict[int, Any] = {}
        self._under_way: dict[Any, list[int]] = {}
        self._limit = _UNDER_WAY * threads
        self._size = max(1, min(_LARGEST_CHUNK, len(items) // (_CHUNKS_EACH * threads)))
        for question, answer in common.items():
            self._offer(question, answer)

    def ended(self) -> Iterator[tuple[int, Any]]:
        """Yield numbers of items and results, as soon as they are available."""
        from distributed import wait

        for _ in self._items:
            while not self._done:
                self._hand_out()
                with self._client.as_current():
                    wait(list(self._under_way), return_when="FIRST_COMPLETED")  # type: ignore[no-untyped-call]
                for future in [one for one in self._under_way if one.done()]:
                    self._take(future)
            yield self._done.popitem()

    def cancel(self) -> None:
        """Cancel the chunks that are being worked on."""
        if self._under_way:
            self._client.cancel(list(self._under_way), force=True)

    def _hand_out(self) -> None:
        while self._waiting and len(self._under_way) < self._limit:
            # An item that may have killed a worker is sent alone.
            chunk = [self._waiting.popleft()]
            while (
                self._waiting
                and len(chunk) < self._size
                and not self._deaths.get(chunk[0])
                and not self._deaths.get(self._waiting[0])
            ):
                chunk.append(self._waiting.popleft())
            self._submit(chunk)

    def _submit(self, chunk: list[int]) -> None:
        entries, needed = [], set()
        for number in chunk:
            for path in self._files(self._items[number]):
                question = question_of(CONTENT, path)
                if question not in self._own[number]:
                    self._own[number][question] = self._answer(question)
            answers = self._common | self._own[number]
            needed |= {answer for question, answer in answers.items() if question.kind == CONTENT}
            entries.append((number, packed(self._items[number]), packed(answers)))
        contents = {one: self._contents[one] for one in sorted(needed & self._contents.keys())}
        future = self._client.submit(_do, self._work, entries, contents, pure=False, retries=0)
        self._under_way[future] = chunk

    def _take(self, future: Any) -> None:
        """Handle a finished chunk of items: receive the results, answer the questions in it, or notice that
        its workers were killed.
        """
        chunk = self._under_way.pop(future)
        if future.status != "finished":
            error = future.exception() if future.status == "error" else None
            self._bury(chunk, error)
            return
        for number, kind, content in future.result():
            if kind == "result":
                self._done[number] = unpacked(content)
            elif kind == "here":
                self._done[number] = self._do(self._items[number])
            elif kind == "question":
                self._learn(number, Question(*content))
                self._waiting.appendleft(number)
            else:
                raise RuntimeError(content)

    def _learn(self, number: int, question: Question) -> None:
        """Answer a question about a file that the work on an item has asked. If a second item asks the same
        question, the answer is sent with all further items.
        """
        if len(self._own[number]) > _MOST_QUESTIONS:
            raise RuntimeError(f"{question.path} is requested again and again")
        answer = self._answer(question)
        self._own[number][question] = answer
        if self._asked.setdefault(question, number) != number:
            self._common[question] = answer

    def _answer(self, question: Question) -> str:
        answer = content_now(Path(question.path))[0] if question.kind == CONTENT else answer_now(question)
        self._offer(question, answer)
        return answer

    def _offer(self, question: Question, answer: str) -> None:
        """Give the content of a file to the scheduler, as the result of a task on which the work on items
        depends. If the worker that holds this result ends, the scheduler repeats the task on another worker.
        """
        if question.kind == CONTENT and answer not in self._contents:
            now, content = content_now(Path(question.path))
            if now == answer:
                self._contents[answer] = self._client.submit(bytes, content, key=f"yarclang-{answer}")

    def _bury(self, chunk: list[int], error: BaseException | None) -> None:
        for number in chunk:
            if len(chunk) == 1 or self._deaths.get(number):
                self._deaths[number] = self._deaths.get(number, 0) + 1
            else:
                self._deaths[number] = 1
            if self._deaths[number] > _DEATHS:
                self._done[number] = Lost(f"the workers that worked on it were stopped: {error or 'lost'}")
            else:
                self._waiting.appendleft(number)


def _do(
    work: bytes, entries: Sequence[tuple[int, bytes, bytes]], contents: dict[str, bytes]
) -> list[tuple[int, str, Any]]:
    """Do the work for a chunk of items. This function runs on a worker.

    Returns:
        For each item: its number, the kind of its outcome, and the outcome: its result, its question, an
            error, or nothing if the item must be done by the process that has sent it.
    """
    from yarclang.progress import silent

    do: Callable[[Any], Any] = unpacked(work)
    done: list[tuple[int, str, Any]] = []
    for number, item, answers in entries:
        try:
            with _ONE_AT_A_TIME, silent(), bundled(Bundle(unpacked(answers), contents)):
                result = packed(do(unpacked(item)))
            # A result that contains the worker's working folder is wrong on the sender, which has another
            # working folder. The sender does this item itself.
            is_elsewhere = str(Path.cwd()).encode() in result
            done.append((number, "here", None) if is_elsewhere else (number, "result", result))
        except NotBundledError as error:
            done.append((number, "question", tuple(error.question)))
        except Exception as error:  # reported by the process that has sent the item
            done.append((number, "error", f"{type(error).__name__}: {error}"))
    return done
