"""`yarc check`."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.options import (
    avoid_effort_option,
    finding_words,
    fleet_options,
    planning_options,
    tm_option,
)
from yarclang.cli.outputs import STANDARD
from yarclang.cli.threads import one_for_products

if TYPE_CHECKING:
    from yarclang.cli.checks import Done, Task
    from yarclang.cli.fleet import Fleet
    from yarclang.diagnostics import Diagnostic

_PAUSE = 0.3
"""Time after which --watch looks for changed files again [s]."""


@click.command("check")
@click.argument("paths", nargs=-1, required=True, metavar="PATH...", type=click.Path(allow_dash=True))
@click.option(
    "--fix", is_flag=True, help="Apply fixes until none is left, except those that would break the program."
)
@click.option("--diff", is_flag=True, help="Show what --fix would change, and write nothing.")
@click.option("--watch", is_flag=True, help="Check again whenever a file changes, until Ctrl-C.")
@click.option(
    "--plan/--no-plan",
    "plans",
    default=True,
    help="Plan and prove the motions (default), or only check without planning.",
)
@click.option("--strict", is_flag=True, help="Treat warnings as errors.")
@finding_words(
    "--select", help="Besides errors, report (and fix) only these: codes, prefixes of codes (Y06), or names."
)
@finding_words("--ignore", help="Don't report (or fix) these; errors are always reported.")
@click.option("--max-findings", type=click.IntRange(min=0), metavar="N", help="Show at most N findings.")
@click.option(
    "--format",
    "format_",
    type=click.Choice(["text", "json", "sarif", "github", "junit"]),
    default="text",
    help="Output format of the findings.",
)
@planning_options
@tm_option
@avoid_effort_option
@fleet_options
def command(
    paths: tuple[str, ...],
    fix: bool,
    diff: bool,
    watch: bool,
    plans: bool,
    strict: bool,
    select: frozenset[str] | None,
    ignore: frozenset[str] | None,
    max_findings: int | None,
    format_: str,
    jobs: int | None,
    scheduler: str,
    no_cache: bool,
    **planning: Any,
) -> None:
    """Check programs: everything that yarcc checks before it writes, and further warnings and notes.

    A folder means all .yarc files in it; - reads standard input. A FILE.toml is checked by itself: robot.toml
    describes a robot, yarc.toml a project, and any other file a cell (for --robot, if it is given).
    `yarc.toml` may name the robot, the cell, and the findings to report: docs/findings.md.
    """
    _check_usage(paths, fix, diff, watch, format_)
    one_for_products()
    seldom_look_for_garbage()
    from yarclang.cli.checks import Task
    from yarclang.cli.fleet import Fleet
    from yarclang.cli.paths import programs
    from yarclang.cli.work import Progress, options_from
    from yarclang.parallel import on_cores

    with Progress() as progress, on_cores(jobs):
        task = Task(
            options_from(planning),
            plans,
            fix or diff,
            _shown(select, ignore),
            select or frozenset(),
        )
        if watch:
            _watch(paths, task, Fleet(jobs, scheduler), max_findings, progress)
            return
        fleet = Fleet(jobs, scheduler, reuses=not no_cache)
        failed = _checked(
            programs(paths), task, fleet, strict, max_findings, format_, progress, writes=fix, diff=diff
        )
    raise SystemExit(1 if failed else 0)


def _check_usage(paths: tuple[str, ...], fix: bool, diff: bool, watch: bool, format_: str) -> None:
    """Reject options that exclude each other."""
    if fix and diff:
        raise click.UsageError("--fix writes files and --diff doesn't: choose one")
    if watch and (fix or diff or STANDARD in paths or format_ != "text"):
        raise click.UsageError(
            "--watch needs files or folders and --format text; it can't be combined with --fix or --diff"
        )
    if format_ != "text" and (diff or (fix and STANDARD in paths)):
        raise click.UsageError(f"--format {format_} and the changed program would both go to standard output")


def _shown(select: frozenset[str] | None, ignore: frozenset[str] | None) -> frozenset[str] | None:
    """Return the codes of findings to report; None for all."""
    if select is None and ignore is None:
        return None
    from yarclang.lint.registry import everything

    return (select if select is not None else frozenset(everything())) - (ignore or frozenset())


def _checked(
    files: Sequence[str],
    task: Task,
    fleet: Fleet,
    strict: bool,
    most: int | None,
    format_: str,
    progress: Any,
    *,
    writes: bool = False,
    diff: bool = False,
) -> bool:
    """Check files and report their findings; return True if the exit status should report a failure."""
    from yarclang.cli.checks import check_all
    from yarclang.cli.show import show_findings
    from yarclang.report.finding import count_text

    found: list[Diagnostic] = []
    fixes = changed = shown = 0
    if len(files) > 1:
        progress.file(0, len(files))
    for number, done in enumerate(check_all(files, task, fleet), 1):
        progress.pause()
        said = list(done.found)
        if writes or diff:
            fixes, changed = fixes + len(done.applied), changed + done.is_changed
            said += _put(done, diff=diff)
        found += said
        if format_ == "text":
            room = len(said) if most is None else max(0, most - shown)
            show_findings(said[:room], whole=most is not None)
            shown += len(said[:room])
        progress.file(number, len(files))
    progress.pause()
    if format_ != "text":
        from yarclang.cli.formats import document
        from yarclang.cli.work import write_standard_output

        written = write_standard_output(document(format_, files, found[:most], strict=strict))
        show_findings(written)
        found += written
    else:
        if shown < len(found):
            click.echo(f"and {len(found) - shown:,} more: --max-findings {most}", err=True)
        if fixes:
            verb = "would be applied" if diff else "applied"
            click.echo(f"{_counted(fixes, 'fix', 'fixes')} {verb} in {_counted(changed, 'file')}", err=True)
        elif writes or diff:
            click.echo(f"no fix applied: {_why_unfixed(found)}", err=True)
        count = count_text(found, notes=True)
        result = f": {count}" if count else ", no problems found"
        click.echo(f"{_counted(len(files), 'file')} checked{result}", err=True)
        if fleet.remark:
            click.echo(f"  {fleet.remark}", err=True)
    failed = any(one.is_error or (strict and one.severity == "warning") for one in found)
    return failed or (diff and changed > 0)


def _why_unfixed(found: Sequence[Diagnostic]) -> str:
    """Return the reasons why no fix was applied, with the codes of the remaining findings."""
    if not found:
        return "there are no findings"
    by_choice = sorted({one.code for one in found if one.fix is not None and one.fix.by_choice})
    refused = sorted({one.code for one in found if one.fix is not None and not one.fix.by_choice})
    why = []
    if refused:
        why.append(f"the fix of {', '.join(refused)} would cause an error or change a motion")
    if by_choice:
        codes = ",".join(by_choice)
        why.append(f"the fix of {', '.join(by_choice)} needs --select {codes}")
    if others := sorted({one.code for one in found if one.fix is None}):
        why.append(f"{', '.join(others)} {'has' if len(others) == 1 else 'have'} no automatic fix")
    return "; ".join(why)


def _put(done: Done, *, diff: bool) -> tuple[Diagnostic, ...]:
    """Write a file after its fixes, or print the difference to its old text. A program from standard input is
    written to standard output.
    """
    from yarclang.cli.differences import difference, with_mark
    from yarclang.cli.work import write_standard_output, write_whole

    if diff:
        return (
            write_standard_output(difference(done.path, done.before, done.after)) if done.is_changed else ()
        )
    if done.path == STANDARD:
        return write_standard_output((done.after or "").encode()) if done.after is not None else ()
    if not done.is_changed:
        return ()
    path = Path(done.path)
    return write_whole(path, with_mark(path, done.after or ""))


def _watch(paths: tuple[str, ...], task: Task, fleet: Fleet, most: int | None, progress: Any) -> None:
    """Check files again after each change, until the user interrupts."""
    from yarclang.cli.watching import changes

    try:
        for files in changes(paths, lambda: time.sleep(_PAUSE)):
            if len(files) == 1:
                click.echo(f"{files[0]}:", err=True)
            _checked(files, task, fleet, False, most, "text", progress)
    except KeyboardInterrupt:
        click.echo(err=True)


def _counted(number: int, one: str, many: str = "") -> str:
    return f"{number} {one if number == 1 else many or one + 's'}"
