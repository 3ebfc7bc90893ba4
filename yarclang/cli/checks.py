"""Checks and fixes of files, one after the other or in several processes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from yarclang.cli.door import failure_of
from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.outputs import STANDARD
from yarclang.parallel import cores

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.inputs import Options
    from yarclang.source import SourceFile

_MANY = 4
"""Number of files from which they are shared among processes, because each process imports everything
once.
"""


@dataclass(frozen=True, slots=True)
class Task:
    """Task for each file.

    Attributes:
        options: of the command line.
        plans: True to plan motions.
        fix: True to apply fixes.
        shown: codes to report; None for all. Errors are always reported.
        chosen: codes that the user has named. Their fixes are applied even if they fix no error.
    """

    options: Options
    plans: bool = True
    fix: bool = False
    shown: frozenset[str] | None = None
    chosen: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Done:
    """Result for a file.

    Attributes:
        path: of the file.
        found: findings.
        before: the text before fixes; None if it wasn't to be fixed.
        after: the text after fixes; None if it wasn't to be fixed.
        applied: descriptions of the fixes.
    """

    path: str
    found: tuple[Diagnostic, ...]
    before: str | None = None
    after: str | None = None
    applied: tuple[str, ...] = ()

    @property
    def is_changed(self) -> bool:
        """True if a fix was applied."""
        return self.after is not None and self.after != self.before


def check_all(files: Sequence[str], task: Task) -> Iterator[Done]:
    """Check files, in their order."""
    workers = min(len(files), cores())
    if len(files) < _MANY or workers < 2:
        yield from (check_one(path, task) for path in files)
        return
    import signal
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import get_context

    size = max(1, min(8, len(files) // (4 * workers)))
    # not forked: a library with running threads may wait for them for ever
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_end_in_silence)
    # Ctrl-C is for this process: the others, which are started here, ignore it while they import
    heard = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        results = pool.map(check_one, files, [task] * len(files), chunksize=size)
    finally:
        signal.signal(signal.SIGINT, heard)
    try:
        yield from results
    except BrokenProcessPool:
        raise click.ClickException(
            "a process that checked files was killed; is there enough memory? Check fewer files at once"
        ) from None
    finally:
        pool.shutdown(cancel_futures=True)


def _end_in_silence() -> None:
    """End the process at once on Ctrl-C, without a traceback."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)


def check_one(path: str, task: Task) -> Done:
    """Check one file, and fix it if requested. An exception becomes a finding."""
    try:
        return _checked(path, task)
    except Exception as error:  # a bug of ours: continue with the other files
        return Done(path, (failure_of(error, path),))


def _checked(path: str, task: Task) -> Done:
    seldom_look_for_garbage()  # in each process that checks files
    from yarclang.pipeline.checking import Checked, check_file, check_text
    from yarclang.pipeline.fixing import fixed, is_repair

    checked = check_file(path, task.options, plans=task.plans)
    if not task.fix or checked.source is None:
        return Done(path, _told(checked.diagnostics, task))
    folder = Path.cwd() if path == STANDARD else Path(path).parent

    def again(source: SourceFile) -> Checked:
        return check_text(source, folder, task.options, plans=task.plans)

    before = checked.source.text

    def wanted(one: Diagnostic) -> bool:
        return (task.shown is None or one.code in task.shown) and (is_repair(one) or one.code in task.chosen)

    made = fixed(checked, again, wanted)
    return Done(path, _told(made.checked.diagnostics, task), before, made.text, made.applied)


def _told(found: tuple[Diagnostic, ...], task: Task) -> tuple[Diagnostic, ...]:
    return tuple(one for one in found if task.shown is None or one.is_error or one.code in task.shown)
