"""Files checked, and fixed, one after the other or several at once in processes of their own."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from yarclang.cli.door import failure_of
from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.outputs import STANDARD

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.inputs import Options
    from yarclang.source import SourceFile

_MANY = 4
"""From so many files on they are shared among processes: each of them imports everything once."""


@dataclass(frozen=True, slots=True)
class Task:
    """What to do with each file: `shown` are the codes that are wanted (None: all); errors are told all the same. `chosen` are those that somebody
    has named: their fixes are made even where they repair nothing.
    """

    options: Options
    plans: bool = True
    fix: bool = False
    shown: frozenset[str] | None = None
    chosen: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Done:
    """What was found in a file; if it was to be fixed, its text before and after, and what was done."""

    path: str
    found: tuple[Diagnostic, ...]
    before: str | None = None
    after: str | None = None
    applied: tuple[str, ...] = ()

    @property
    def is_changed(self) -> bool:
        """Whether a fix was applied."""
        return self.after is not None and self.after != self.before


def check_all(files: Sequence[str], task: Task) -> Iterator[Done]:
    """Check files, in their order."""
    workers = min(len(files), len(os.sched_getaffinity(0)))
    if len(files) < _MANY or workers < 2:
        yield from (check_one(path, task) for path in files)
        return
    import signal
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import get_context

    size = max(1, min(8, len(files) // (4 * workers)))
    # not forked: a library that has threads already may wait for them for ever
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_end_in_silence)
    # Ctrl-C is for this process; the others, which are begun here, don't hear it while they import
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
    """Let Ctrl-C end a process at once, without a traceback."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)


def check_one(path: str, task: Task) -> Done:
    """Check one file, and fix it if that is wanted. An exception is a finding."""
    try:
        return _checked(path, task)
    except Exception as error:  # a bug of ours: other files are checked all the same
        return Done(path, (failure_of(error, path),))


def _checked(path: str, task: Task) -> Done:
    seldom_look_for_garbage()  # in each process that has a share of the files
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
