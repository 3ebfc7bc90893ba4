"""Analyses of the open texts. They run in threads, the newest text first, and are cancelled if the text
changes.

Each version of a text is checked twice: first without planning, then completely. The second check reports the
findings of planning before it proves the motions. Each of the two checks has a thread of its own, so that the
first check of a text doesn't wait until motions of another text are planned. Requests are answered with the
results so far.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial

from yarclang.diagnostics import Diagnostic
from yarclang.findings import SYNTAX
from yarclang.lsp.carried import Planned, carried, planned_alone
from yarclang.lsp.checks import Checks
from yarclang.lsp.documents import Document
from yarclang.pipeline.checking import Checked

_SHOWN_BY = 0.1
"""Longest wait before a proof begins, in which the findings so far can be shown [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """The results of checking one version of a text that is open in the editor.

    Attributes:
        document: the text.
        generation: number of the check, counted over all versions of the text.
        checked: the results.
        is_whole: True if motions were planned and proved as well.
        carried: findings of earlier planning in unchanged lines, shown until motions are planned again.
        is_planned: True if motions are planned, whether proved or not.
        repeats: True if all findings were already shown before the proof.
    """

    document: Document
    generation: int
    checked: Checked
    is_whole: bool
    carried: tuple[Diagnostic, ...] = ()
    is_planned: bool = False
    repeats: bool = False

    @property
    def shown(self) -> tuple[Diagnostic, ...]:
        """Return the findings to show in the text."""
        return (*self.checked.diagnostics, *self.carried)


@dataclass(slots=True)
class _Desk:
    """A text that is open in the editor, with the state of its checks.

    Attributes:
        document: newest version of the text.
        generation: number of checks that were requested.
        analysis: the latest results.
        begun: results of the newest version without planning.
        planned: findings that only planning reports.
        early: results of the newest version before the proof.
        proved: findings that only a proof reports.
        whole: event that is set when all results are ready.
        some: event that is set when any results are ready.
        most: event that is set when all results are ready, except perhaps those of the proof.
    """

    document: Document
    generation: int = 0
    analysis: Analysis | None = None
    begun: Checked | None = None
    planned: Planned | None = None
    early: Analysis | None = None
    proved: Planned | None = None
    whole: asyncio.Event = field(default_factory=asyncio.Event)
    some: asyncio.Event = field(default_factory=asyncio.Event)
    most: asyncio.Event = field(default_factory=asyncio.Event)


class Analyses:
    """The checks of all texts that are open in the editor.

    Everything except the checks themselves runs in the event loop's thread. There, `arrived` is called with
    each new analysis.
    """

    def __init__(self, checks: Checks, arrived: Callable[[Analysis], None]) -> None:
        self._checks = checks
        self._arrived = arrived
        self._desks: dict[str, _Desk] = {}
        self._touched: list[str] = []
        """The texts that wait for a check. The text that was changed last is at the end."""
        self._unread: set[str] = set()
        """Those of the waiting texts whose first check, without planning, hasn't begun yet."""
        self._checking = ThreadPoolExecutor(1, thread_name_prefix="checking")
        self._planning = ThreadPoolExecutor(1, thread_name_prefix="planning")
        self._reading = ThreadPoolExecutor(1, thread_name_prefix="reading")
        self._tasks: set[asyncio.Task[None]] = set()
        self._running: set[bool] = set()
        """The kinds of checks that are running: False for checks without planning, True for complete checks.
        """

    def put(self, document: Document) -> None:
        """Check a text that was opened or changed."""
        desk = self._desks.get(document.uri)
        if desk is None:
            desk = self._desks[document.uri] = _Desk(document)
        desk.document = document
        self.again(document.uri)
        task = asyncio.ensure_future(self._read(desk))
        self._tasks.add(task)  # the event loop holds only a weak reference to a task
        task.add_done_callback(self._tasks.discard)

    def again(self, uri: str) -> None:
        """Check an open text again, because a file on which it depends has changed."""
        desk = self._desks.get(uri)
        if desk is None:
            return
        desk.generation += 1
        desk.begun, desk.early = None, None
        desk.whole.clear()
        desk.most.clear()
        desk.some.clear()
        self._take_out(uri)
        self._touched.append(uri)
        self._unread.add(uri)
        self._go_on()

    def drop(self, uri: str) -> None:
        """Forget a text that was closed."""
        desk = self._desks.pop(uri, None)
        if desk is not None:
            desk.whole.set()
            desk.most.set()
            desk.some.set()
        self._take_out(uri)

    def _take_out(self, uri: str) -> None:
        """Remove a text from the queues of texts that wait for a check."""
        self._unread.discard(uri)
        if uri in self._touched:
            self._touched.remove(uri)

    def of(self, uri: str) -> Analysis | None:
        """Return the results for the newest version of a text; None if there are none yet."""
        desk = self._desks.get(uri)
        found = desk.analysis if desk else None
        return found if desk and found and found.document is desk.document else None

    def last(self, uri: str) -> Analysis | None:
        """Return the latest results for a text, perhaps of an older version."""
        desk = self._desks.get(uri)
        return desk.analysis if desk else None

    async def whole(self, uri: str, patience: float | None) -> Analysis | None:
        """Wait for the complete results of a text.

        Args:
            uri: URI of the text.
            patience: longest time to wait [s]; None waits without limit.

        Returns:
            After `patience` the results so far, which are at least those without planning. None if the text
            was closed.
        """
        desk = self._desks.get(uri)
        if desk is None:
            return None
        try:
            async with asyncio.timeout(patience):
                await desk.whole.wait()
        except TimeoutError:
            await desk.some.wait()
        return self.of(uri)

    async def most(self, uri: str, patience: float) -> Analysis | None:
        """Wait until a text's motions are planned, whether proved or not, and return the results.

        Args:
            uri: URI of the text.
            patience: longest time to wait [s].

        Returns:
            The results; after `patience`, the results so far. None if the text was closed.
        """
        desk = self._desks.get(uri)
        if desk is None:
            return None
        try:
            async with asyncio.timeout(patience):
                await desk.most.wait()
        except TimeoutError:
            await desk.some.wait()
        found = self.of(uri)
        return found if found is None or found.is_whole else desk.early or found

    def close(self) -> None:
        """Stop all checks."""
        for uri in list(self._desks):
            self.drop(uri)
        for pool in (self._checking, self._planning, self._reading):
            pool.shutdown(wait=False, cancel_futures=True)

    # The work in threads.

    def _go_on(self) -> None:
        if self._unread and False not in self._running:
            uri = next(one for one in reversed(self._touched) if one in self._unread)
            self._unread.remove(uri)
            self._begin(uri, plans=False)
        elif self._touched and not self._unread and not self._running:
            self._begin(self._touched.pop(), plans=True)

    def _begin(self, uri: str, *, plans: bool) -> None:
        self._running.add(plans)
        task = asyncio.ensure_future(self._look(uri, plans))
        task.add_done_callback(partial(self._looked, plans))

    def _looked(self, plans: bool, task: asyncio.Task[None]) -> None:
        self._running.discard(plans)
        self._go_on()
        task.result()  # the loop reports a bug, and the next text is checked all the same

    async def _read(self, desk: _Desk) -> None:
        """Report the syntax errors of a long text while other checks are running."""
        document, generation = desk.document, desk.generation

        def is_wanted() -> bool:
            known = desk.analysis is not None and desk.analysis.document is document
            return not known and desk.generation == generation and self._desks.get(document.uri) is desk

        def read() -> tuple[Diagnostic, ...] | None:
            return self._checks.syntax(document) if is_wanted() else None

        found = await asyncio.get_running_loop().run_in_executor(self._reading, read)
        if found is not None and is_wanted():
            self._arrived(_of_syntax(desk, document, generation, found))

    async def _look(self, uri: str, plans: bool) -> None:
        """Check a text in a thread, with or without planning."""
        desk = self._desks.get(uri)
        if desk is None:
            return
        document, generation = desk.document, desk.generation
        begun = desk.begun if plans else None

        def is_stale() -> bool:
            return self._desks.get(uri) is not desk or desk.generation != generation

        pool = self._planning if plans else self._checking
        loop = asyncio.get_running_loop()

        def early(checked: Checked) -> None:
            # Let the event loop show the findings before the proof needs the processor.
            shown = threading.Event()
            loop.call_soon_threadsafe(self._show_early, desk, document, generation, checked, shown)
            shown.wait(_SHOWN_BY)

        try:
            checked = await loop.run_in_executor(
                pool, self._checks.check, document, plans, begun, is_stale, early
            )
        except Exception:
            # After a bug, wake up all tasks that wait for results.
            if not is_stale():
                self._take_out(uri)
            desk.some.set()
            desk.most.set()
            desk.whole.set()
            raise
        if is_stale():
            return
        if checked is not None:
            self._put_down(desk, Analysis(document, generation, checked, plans))
            assert desk.analysis is not None  # it was just stored
            self._arrived(desk.analysis)
        if not plans:
            desk.begun = checked

    def _show_early(
        self, desk: _Desk, document: Document, generation: int, checked: Checked, shown: threading.Event
    ) -> None:
        """Show the findings that are known before the proof, together with those of the last proof in
        unchanged lines.
        """
        if self._desks.get(document.uri) is desk and desk.generation == generation:
            rest = () if desk.proved is None else tuple(carried(desk.proved, document.source))
            desk.early = Analysis(document, generation, checked, False, rest, is_planned=True)
            desk.most.set()
            try:
                self._arrived(desk.early)
            finally:
                shown.set()
        shown.set()

    @staticmethod
    def _put_down(desk: _Desk, found: Analysis) -> None:
        """Store results, and wake up the tasks that wait for them."""
        source = found.document.source
        if found.is_whole:
            quick = desk.analysis.checked.diagnostics if desk.analysis else ()
            desk.planned = planned_alone(source, found.checked.diagnostics, quick)
            if desk.early is not None:
                desk.proved = planned_alone(source, found.checked.diagnostics, desk.early.checked.diagnostics)
                found = replace(found, repeats=found.shown == desk.early.shown)
            else:
                desk.proved = None
            desk.whole.set()
            desk.most.set()
        elif desk.planned is not None:
            found = replace(found, carried=tuple(carried(desk.planned, source)))
        desk.analysis = found
        desk.some.set()


def _of_syntax(desk: _Desk, document: Document, generation: int, found: tuple[Diagnostic, ...]) -> Analysis:
    """Return an analysis with the syntax errors of a long text, and with the older findings of other kinds in
    unchanged lines. Nothing is stored.
    """
    rest: tuple[Diagnostic, ...] = ()
    if desk.analysis is not None:
        others = [one for one in desk.analysis.shown if one.family != SYNTAX]
        before = planned_alone(desk.analysis.document.source, others, ())
        rest = tuple(carried(before, document.source))
    return Analysis(document, generation, Checked(found), is_whole=False, carried=rest)
