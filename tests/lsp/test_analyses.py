"""Work in the background: the newest text comes first, outdated work is given up, and requests never wait for
this work.
"""

import asyncio
import threading
from collections.abc import Callable

from yarclang.diagnostics import Diagnostic
from yarclang.lsp.analyses import Analyses, Analysis
from yarclang.lsp.checks import Checks
from yarclang.lsp.documents import Document
from yarclang.pipeline.checking import Checked
from yarclang.pipeline.inputs import Options
from yarclang.source import Span

SOON = 10.0


class Slow:
    """Checks whose planning doesn't end before `go_on` is set."""

    def __init__(self) -> None:
        self.done: list[tuple[str, int, bool]] = []
        self.begun = threading.Event()
        self.told_at_once: tuple[Diagnostic, ...] | None = None
        self.go_on = threading.Event()
        self.is_slow_at_first = False
        self.planned: tuple[str, ...] | None = None
        """Codes that planning finds in the first line and reports before the proof; None if it reports
        nothing early.
        """
        self.proved: tuple[str, ...] = ()

    def syntax(self, document: Document) -> tuple[Diagnostic, ...] | None:
        return self.told_at_once

    def check(
        self,
        document: Document,
        plans: bool,
        begun: Checked | None,
        is_stale: Callable[[], bool],
        early: Callable[[Checked], None],
    ) -> Checked | None:
        assert plans == (begun is not None)  # planning continues from what was found without planning
        if plans and self.planned is not None:
            early(Checked(findings(document, self.planned)))
        if plans or self.is_slow_at_first:
            self.begun.set()
            while not self.go_on.wait(0.005):
                if is_stale():
                    return None
        self.done.append((document.uri, document.version, plans))
        told = (*(self.planned or ()), *self.proved) if plans else ()
        return Checked(findings(document, told))


def findings(document: Document, codes: tuple[str, ...]) -> tuple[Diagnostic, ...]:
    span = Span(1, 1, 1, 2)
    return tuple(Diagnostic(code, code, document.source, span, level="note") for code in codes)


def codes_of(analysis: Analysis) -> list[str]:
    return [one.code for one in analysis.shown]


def run(work: Callable[[Analyses, Slow, list[Analysis]], object]) -> None:
    async def whole() -> None:
        checks, arrived = Slow(), []
        analyses = Analyses(checks, arrived.append)
        try:
            async with asyncio.timeout(SOON):
                await work(analyses, checks, arrived)
        finally:
            checks.go_on.set()
            analyses.close()

    asyncio.run(whole())


async def begun(checks: Slow) -> None:
    while not checks.begun.is_set():
        await asyncio.sleep(0.002)
    checks.begun.clear()


def test_stale_work_is_given_up():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        for version in range(1, 5):
            analyses.put(Document("a", version, ""))
            await begun(checks)
        checks.go_on.set()
        found = await analyses.whole("a", None)
        assert (found.document.version, found.is_whole) == (4, True)
        assert [one for one in checks.done if one[2]] == [("a", 4, True)]
        assert [(one.document.version, one.is_whole) for one in arrived if one.is_whole] == [(4, True)]

    run(work)


def test_what_needs_no_planning_is_there_while_motions_are_planned():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        analyses.put(Document("a", 1, ""))
        found = await analyses.whole("a", 0.0)
        assert not found.is_whole
        assert analyses.of("a") is found
        checks.go_on.set()
        assert (await analyses.whole("a", None)).is_whole
        assert [one.is_whole for one in arrived] == [False, True]

    run(work)


def test_what_planning_finds_is_shown_before_the_proof():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        checks.planned = ("Y0505",)
        analyses.put(Document("a", 1, "P0010 MOVEJ HOME"))
        early = await analyses.most("a", 5.0)
        assert (early.is_planned, early.is_whole) == (True, False)
        assert codes_of(early) == ["Y0505"]
        assert not analyses.of("a").is_whole
        checks.go_on.set()
        whole = await analyses.whole("a", None)
        assert whole.is_whole
        assert await analyses.most("a", 5.0) is whole
        assert [(one.is_planned, one.repeats) for one in arrived] == [
            (False, False),
            (True, False),
            (False, True),
        ]

    run(work)


def test_what_the_proof_has_found_stays_until_the_next_proof():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        checks.planned, checks.proved = ("Y0505",), ("Y0611",)
        checks.go_on.set()
        analyses.put(Document("a", 1, "P0010 MOVEJ HOME\n"))
        whole = await analyses.whole("a", None)
        assert codes_of(whole) == ["Y0505", "Y0611"]
        assert not whole.repeats
        checks.proved = ()
        analyses.put(Document("a", 2, "P0010 MOVEJ HOME\n! edited\n"))
        whole = await analyses.whole("a", None)
        quick, early, last = arrived[-3:]
        assert codes_of(quick) == ["Y0505", "Y0611"]
        assert codes_of(early) == ["Y0505", "Y0611"]
        assert last is whole
        assert codes_of(whole) == ["Y0505"]
        assert not whole.repeats

    run(work)


def test_nothing_old_is_shown_early():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        checks.planned = ("Y0505",)
        analyses.put(Document("a", 1, ""))
        await begun(checks)
        analyses.put(Document("a", 2, ""))
        assert (await analyses.most("a", 5.0)).document.version == 2
        checks.go_on.set()
        assert (await analyses.whole("a", None)).document.version == 2
        versions = [one.document.version for one in arrived]
        assert versions == sorted(versions)

    run(work)


def test_the_first_look_at_a_text_does_not_wait_for_the_motions_of_another():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        analyses.put(Document("busy", 1, ""))
        await begun(checks)
        analyses.put(Document("a", 1, ""))
        found = await analyses.whole("a", 0.0)
        assert (found.document.uri, found.is_whole) == ("a", False)
        assert not analyses.of("busy").is_whole

    run(work)


def test_a_new_text_ends_the_first_look_at_the_old_one():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        checks.is_slow_at_first = True
        for version in range(1, 4):
            analyses.put(Document("a", version, ""))
            await begun(checks)
        checks.go_on.set()
        await analyses.whole("a", None)
        assert checks.done == [("a", 3, False), ("a", 3, True)]

    run(work)


def test_syntax_errors_of_long_texts_are_told_at_once():
    """Syntax errors are sent first, but they don't count as the complete findings of the text."""

    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        analyses.put(Document("busy", 1, ""))
        await begun(checks)
        checks.told_at_once = (Diagnostic("Y0101", "what is this?"),)
        checks.is_slow_at_first = True
        analyses.put(Document("a", 1, ""))
        while not any(one.shown for one in arrived):
            await asyncio.sleep(0.002)
        assert analyses.of("a") is None  # names aren't resolved yet
        checks.go_on.set()
        assert (await analyses.whole("a", None)).checked.diagnostics == ()
        told = [[one.code for one in each.shown] for each in arrived if each.document.uri == "a"]
        assert told == [["Y0101"], [], []]

    run(work)
    long = Document("file:///a.yarc", 1, "P0010 MOVJE [\n" * 3_000)
    checks = Checks(Options())
    assert {one.code[:3] for one in checks.syntax(long)} == {"Y01"}
    assert checks.syntax(Document("file:///a.yarc", 1, "P0010 [\n")) is None


def test_of_several_texts_the_one_that_was_touched_last_comes_first():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        analyses.put(Document("busy", 1, ""))
        await begun(checks)
        for uri in ("a", "b", "c"):
            analyses.put(Document(uri, 1, ""))
        analyses.again("b")
        checks.go_on.set()
        for uri in ("a", "b", "c"):
            await analyses.whole(uri, None)
        assert [uri for uri, _, plans in checks.done if plans] == ["busy", "b", "c", "a"]

    run(work)


def test_closed_texts_keep_nobody_waiting():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        analyses.put(Document("a", 1, ""))
        await begun(checks)
        waiting = asyncio.ensure_future(analyses.whole("a", None))
        await asyncio.sleep(0)
        analyses.drop("a")
        assert await waiting is None
        assert analyses.of("a") is None
        analyses.again("a")  # the text is closed, so there is nothing to check
        assert await analyses.whole("a", None) is None

    run(work)


def test_a_change_leaves_nothing_old_to_answer_from():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        checks.go_on.set()
        analyses.put(Document("a", 1, ""))
        first = await analyses.whole("a", None)
        analyses.put(Document("a", 2, ""))
        assert analyses.of("a") is None
        assert analyses.last("a") is first
        assert (await analyses.whole("a", None)).document.version == 2

    run(work)


def test_a_bug_in_a_check_keeps_the_server_alive():
    async def work(analyses: Analyses, checks: Slow, arrived: list[Analysis]) -> None:
        asyncio.get_running_loop().set_exception_handler(lambda loop, context: told.append(context))
        right = checks.check

        def broken(*arguments: object) -> Checked:
            checks.check = right  # type: ignore[method-assign]
            raise ZeroDivisionError

        checks.check = broken  # type: ignore[method-assign]
        checks.go_on.set()
        analyses.put(Document("a", 1, ""))
        assert await analyses.whole("a", None) is None
        while not told:
            await asyncio.sleep(0.002)
        analyses.put(Document("a", 2, ""))
        assert (await analyses.whole("a", None)).document.version == 2

    told: list[object] = []
    run(work)
