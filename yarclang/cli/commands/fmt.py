"""`yarc fmt`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.options import jobs_option, scheduler_option
from yarclang.cli.outputs import STANDARD

if TYPE_CHECKING:
    from yarclang.cli.forms import Form

_START, _STEP = 10, 10


class _Command(click.Command):
    """A command whose --renumber takes two numbers, or none."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line. Numbers directly after --renumber are passed to this option, and all other
        arguments to the command.
        """
        if "--renumber" in args:
            at = args.index("--renumber") + 1
            given = args[at : at + 2]
            numbers = given if len(given) == 2 and all(one.isdecimal() for one in given) else []
            args = [*args[:at], *(numbers or [str(_START), str(_STEP)]), *args[at + len(numbers) :]]
        return super().parse_args(ctx, args)


@click.command("fmt", cls=_Command)
@click.argument("paths", nargs=-1, required=True, metavar="PATH...", type=click.Path(allow_dash=True))
@click.option("--check", "checks", is_flag=True, help="Write nothing; list the files that would be changed.")
@click.option("--diff", is_flag=True, help="Write nothing; show what would be changed.")
@click.option(
    "--renumber",
    nargs=2,
    type=click.IntRange(1, 1_000_000),
    metavar="[START STEP]",
    help="Renumber the commands in steps: P0010, P0020, ... by default.",
)
@jobs_option
@scheduler_option
def command(
    paths: tuple[str, ...],
    checks: bool,
    diff: bool,
    renumber: tuple[int, int] | None,
    jobs: int | None,
    scheduler: str,
) -> None:
    """Write programs in their usual form: names in upper case, blocks indented, comments below each other.

    The meaning of a program and its comments stay the same. This is proved before a file is written;
    otherwise the file stays unchanged. A folder means all .yarc files in it; - reads standard input and
    writes to standard output.

    The exit status is 0, with --check or --diff 1 if a file would be changed, 1 if a result can't be proved,
    and 2 if a file can't be read or written, or has syntax errors.
    """
    seldom_look_for_garbage()
    from yarclang.cli.differences import difference
    from yarclang.cli.fleet import Fleet, ended
    from yarclang.cli.forms import Form, form_of
    from yarclang.cli.paths import programs
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_standard_output
    from yarclang.findings import YARCLANG

    files = programs(paths)
    failed, changed, unproved = 0, 0, 0
    fleet = Fleet(jobs, scheduler)
    forms = fleet.results(
        partial(form_of, renumber=renumber),
        files,
        name=lambda path: path,
        is_lasting=lambda _: False,
        lost=lambda path, why: Form(found=(ended(path, why),)),
    )
    for file, made in zip(files, forms, strict=True):
        found = list(made.found)
        if not found and made.is_changed and diff:
            found += write_standard_output(difference(file, made.before, made.after))
        elif not found and not checks and not diff:
            found += _write(file, made)
        show_findings(found)
        if found:
            failed += 1
            unproved += all(one.family == YARCLANG for one in found)
        elif made.is_changed:
            changed += 1
            if not diff and file != STANDARD:
                click.echo(f"{'would be changed' if checks else 'changed'}: {file}", err=True)
    _summarise(len(files), changed, failed, would=checks or diff)
    if failed > unproved:
        raise SystemExit(2)
    raise SystemExit(int(unproved > 0 or (changed > 0 and (checks or diff))))


def _write(file: str, made: Form) -> tuple[Any, ...]:
    from yarclang.cli.differences import with_mark
    from yarclang.cli.work import write_standard_output, write_whole

    if file == STANDARD:
        return write_standard_output(made.after.encode())
    path = Path(file)
    return write_whole(path, with_mark(path, made.after)) if made.is_changed else ()


def _summarise(files: int, changed: int, failed: int, *, would: bool) -> None:
    def counted(number: int) -> str:
        return f"{number} file{'s' * (number != 1)}"

    same = files - changed - failed
    parts = [f"{counted(changed)} {'would be changed' if would else 'changed'}"] * (changed > 0)
    parts += [f"{counted(same)} already formatted"] * (same > 0)
    parts += [f"{counted(failed)} left unchanged because of errors"] * (failed > 0)
    click.echo(", ".join(parts), err=True)
