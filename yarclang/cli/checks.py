"""Check files and fix them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from yarclang.cli.door import failure_of
from yarclang.cli.fleet import Fleet, ended
from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.outputs import STANDARD
from yarclang.findings import YARCLANG

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.inputs import Options
    from yarclang.source import SourceFile


@dataclass(frozen=True, slots=True)
class Task:
    """Settings of `yarc check` that apply to each file.

    Attributes:
        options: options of the command line.
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

    @property
    def said(self) -> tuple[object, ...]:
        """Return everything in this task that affects the results. It is a part of the key under which the
        results are cached.
        """
        shown = None if self.shown is None else sorted(self.shown)
        return (self.options.said, self.plans, self.fix, shown, sorted(self.chosen))


@dataclass(frozen=True, slots=True)
class Done:
    """Result of `yarc check` for a file.

    Attributes:
        path: path of the file.
        found: findings.
        before: the file's text before fixes; None if fixes weren't requested.
        after: the file's text after fixes; None if fixes weren't requested.
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


def check_all(files: Sequence[str], task: Task, fleet: Fleet) -> Iterator[Done]:
    """Check files, and yield the results in the order of the files."""
    return fleet.results(
        partial(check_one, task=task),
        files,
        name=lambda path: ("check", path, task.said),
        is_lasting=lambda done: not any(one.family == YARCLANG for one in done.found),
        lost=lambda path, why: Done(path, (ended(path, why),)),
    )


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

    checked = check_file(path, task.options, plans=task.plans, boxes=True)
    if not task.fix or checked.source is None:
        return Done(path, _told(checked.diagnostics, task))
    folder = Path.cwd() if path == STANDARD else Path(path).parent

    def again(source: SourceFile) -> Checked:
        return check_text(source, folder, task.options, plans=task.plans, boxes=True)

    before = checked.source.text

    def wanted(one: Diagnostic) -> bool:
        return (task.shown is None or one.code in task.shown) and (is_repair(one) or one.code in task.chosen)

    made = fixed(checked, again, wanted)
    return Done(path, _told(made.checked.diagnostics, task), before, made.text, made.applied)


def _told(found: tuple[Diagnostic, ...], task: Task) -> tuple[Diagnostic, ...]:
    return tuple(one for one in found if task.shown is None or one.is_error or one.code in task.shown)
