"""What the pipeline says of the open texts: found in threads, newest first, given up where a text has changed meanwhile.

Each version of a text is looked at twice: first what needs no planning, then all of it; of the second look, what planning has found is there before the proof. Each has a thread of its own, so that the first look at one text
doesn't wait for the motions of another. Who asks gets what is there.
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
"""So long [s] a proof waits at most until what was found before it is shown."""


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """What was found in one version of a text; `is_whole` says that motions were planned as well.

    Until they are, `carried` has what planning said of the lines that are as they were.
    """

    document: Document
    generation: int
    checked: Checked
    is_whole: bool
    carried: tuple[Diagnostic, ...] = ()
    is_planned: bool = False
    """Whether motions are planned, and perhaps not proved."""
    repeats: bool = False
    """Whether all of it was shown before the proof."""

    @property
    def shown(self) -> tuple[Diagnostic, ...]:
        """What is shown in the text."""
        return (*self.checked.diagnostics, *self.carried)


@dataclass(slots=True)
class _Desk:
    """An open text: its newest version, how often it was to be looked at, and what is known of it."""

    document: Document
    generation: int = 0
    analysis: Analysis | None = None
    begun: Checked | None = None
    planned: Planned | None = None
    early: Analysis | None = None
    """What was known of the newest version before the proof."""
    proved: Planned | None = None
    """What only a proof has said."""
    whole: asyncio.Event = field(default_factory=asyncio.Event)
    some: asyncio.Event = field(default_factory=asyncio.Event)
    most: asyncio.Event = field(default_factory=asyncio.Event)
    """All is known, or all but the proof."""


class Analyses:
    """Analyses of all open texts. Everything but the work itself is done in the event loop's thread.

    `arrived` is called there with each new analysis.
    """

    def __init__(self, checks: Checks, arrived: Callable[[Analysis], None]) -> None:
        self._checks = checks
        self._arrived = arrived
        self._desks: dict[str, _Desk] = {}
        self._touched: list[str] = []
        """The texts that wait for a look, the one that was touched last at the end."""
        self._unread: set[str] = set()
        """Those of them that weren't looked at without planning."""
        self._checking = ThreadPoolExecutor(1, thread_name_prefix="checking")
        self._planning = ThreadPoolExecutor(1, thread_name_prefix="planning")
        self._reading = ThreadPoolExecutor(1, thread_name_prefix="reading")
        self._tasks: set[asyncio.Task[None]] = set()
        self._running: set[bool] = set()
        """Which looks are being made: without planning, or with it."""

    def put(self, document: Document) -> None:
        """A text was opened or changed: it is looked at anew."""
        desk = self._desks.get(document.uri)
        if desk is None:
            desk = self._desks[document.uri] = _Desk(document)
        desk.document = document
        self.again(document.uri)
        task = asyncio.ensure_future(self._read(desk))
        self._tasks.add(task)  # the loop itself keeps no task alive
        task.add_done_callback(self._tasks.discard)

    def again(self, uri: str) -> None:
        """Something that an open text depends on has changed."""
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
        """A text was closed."""
        desk = self._desks.pop(uri, None)
        if desk is not None:
            desk.whole.set()
            desk.most.set()
            desk.some.set()
        self._take_out(uri)

    def _take_out(self, uri: str) -> None:
        """Let a text wait for nothing."""
        self._unread.discard(uri)
        if uri in self._touched:
            self._touched.remove(uri)

    def of(self, uri: str) -> Analysis | None:
        """What is known of the newest version of a text; None where nothing is yet."""
        desk = self._desks.get(uri)
        found = desk.analysis if desk else None
        return found if desk and found and found.document is desk.document else None

    def last(self, uri: str) -> Analysis | None:
        """What was found last, also in an older version."""
        desk = self._desks.get(uri)
        return desk.analysis if desk else None

    async def whole(self, uri: str, patience: float | None) -> Analysis | None:
        """All that is to be said of a text, or, where that takes longer than `patience` [s], what is known by then: at least what needs no
        planning. None if the text was closed.
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
        """What is to be said of a text when its motions are planned, though perhaps not proved; else as `whole`."""
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
        """End all work."""
        for uri in list(self._desks):
            self.drop(uri)
        for pool in (self._checking, self._planning, self._reading):
            pool.shutdown(wait=False, cancel_futures=True)

    # the threads' work

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
        task.result()  # a bug is reported by the loop, and the next text is looked at all the same

    async def _read(self, desk: _Desk) -> None:
        """Tell the syntax errors of a long text, beside whatever else is being looked at."""
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
        """Look at a text, without planning or then with it."""
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
            # what is shown first has the processor first
            shown = threading.Event()
            loop.call_soon_threadsafe(self._show_early, desk, document, generation, checked, shown)
            shown.wait(_SHOWN_BY)

        try:
            checked = await loop.run_in_executor(
                pool, self._checks.check, document, plans, begun, is_stale, early
            )
        except Exception:
            # a bug: nobody shall wait for what doesn't come
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
            assert desk.analysis is not None  # it was put down
            self._arrived(desk.analysis)
        if not plans:
            desk.begun = checked

    def _show_early(
        self, desk: _Desk, document: Document, generation: int, checked: Checked, shown: threading.Event
    ) -> None:
        """Show what was found before the proof, with what the last proof has said of unchanged lines."""
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
        """Keep what was found, for whoever waits for it."""
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
    """Syntax errors of a long text, with what else was said of unchanged lines: told at once, and kept by nobody."""
    rest: tuple[Diagnostic, ...] = ()
    if desk.analysis is not None:
        others = [one for one in desk.analysis.shown if one.family != SYNTAX]
        before = planned_alone(desk.analysis.document.source, others, ())
        rest = tuple(carried(before, document.source))
    return Analysis(document, generation, Checked(found), is_whole=False, carried=rest)
