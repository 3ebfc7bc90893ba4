"""`yarc campaign`."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.options import cell_option, complete_robots, format_option, jobs_option, scheduler_option
from yarclang.cli.threads import one_for_products

if TYPE_CHECKING:
    from typing import Any

    from yarclang.campaign.judging import Task
    from yarclang.campaign.state import State
    from yarclang.cli.fleet import Fleet

_CHUNK = 10
"""Number of programs after which the state is written: a few seconds of work."""

_MOST = 100_000_000
_LARGEST_SEED = 10**15


@click.command("campaign")
@click.option(
    "--programs",
    type=click.IntRange(1, _MOST),
    default=400,
    metavar="N",
    help="Total number of programs, including those in the state file (default: 400).",
)
@click.option(
    "--seed",
    type=click.IntRange(0, _LARGEST_SEED),
    default=0,
    metavar="N",
    help="Seed of the first program; each next program uses the next seed (default: 0).",
)
@click.option(
    "--robot",
    "robots",
    multiple=True,
    metavar="NAME|PATH",
    shell_complete=complete_robots,
    help=(
        "A robot to draw programs for; may be given several times (default: all robots of the standard "
        "library)."
    ),
)
@cell_option
@click.option(
    "--state",
    type=click.Path(dir_okay=False),
    metavar="FILE",
    help=(
        "File for the progress, so that the same command continues after an interruption (default: no file)."
    ),
)
@click.option(
    "--again",
    type=click.IntRange(0, _LARGEST_SEED + _MOST),
    metavar="SEED",
    help="Draw, judge and print only the program of this seed.",
)
@jobs_option
@scheduler_option
@format_option
def command(
    programs: int,
    seed: int,
    robots: tuple[str, ...],
    cell: str | None,
    state: str | None,
    again: int | None,
    jobs: int | None,
    scheduler: str,
    format_: str,
) -> None:
    """Compile random programs, and judge what comes out by an independent reading of the texts.

    The reading shares no code with the compiler and its certificate. It samples densely: it proves nothing,
    and finds what a proof may have missed. Programs that the compiler refuses are counted. Exit status 1
    means that something wrong was found; --again SEED shows it.
    """
    one_for_products()
    seldom_look_for_garbage()
    task = _task(robots, cell)
    if again is not None:
        if state is not None:
            raise click.UsageError("--again judges a single program and uses no --state")
        _once(again, task, format_)
        return
    from yarclang.campaign.report import as_data, as_text, summed
    from yarclang.campaign.state import State, StateError
    from yarclang.cli.fleet import Fleet

    kept = None if state is None else Path(state)
    try:
        with State(kept, _what(task, seed)) as opened:
            try:
                _done(opened, task, seed, programs, Fleet(jobs, scheduler))
            except KeyboardInterrupt:
                done = sum(one.count for one in opened.pieces)
                goes_on = "" if kept is None else f" and saved in {kept}: the same command continues"
                click.echo(f"\nstopped: {done:,} of {programs:,} programs are done{goes_on}", err=True)
                raise SystemExit(130) from None
            whole = summed(opened.pieces, seed)
    except StateError as error:
        raise click.ClickException(str(error)) from None
    if format_ == "json":
        click.echo(json.dumps(as_data(whole, task), indent=2))
    else:
        for line in as_text(whole, task):
            click.echo(line)
        rate = whole.count / whole.seconds if whole.seconds else 0.0
        click.echo(f"{whole.seconds:,.0f} s of processor time, {rate:.1f} programs a second", err=True)
    raise SystemExit(1 if whole.found else 0)


def _task(robots: tuple[str, ...], cell: str | None) -> Task:
    """Return the robot, cell and settings for which programs are generated. An unusable robot or cell is an
    error.
    """
    from yarclang.campaign.judging import Task, arm_of
    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import has_errors
    from yarclang.robot.description import load_robot
    from yarclang.robot.library import list_robots

    names = tuple(dict.fromkeys(robots)) or tuple(one.name for one in list_robots())
    for name in names:
        loaded = load_robot(name)
        if loaded.value is None:
            show_findings(loaded.diagnostics)
            raise SystemExit(1)
        try:
            arm_of(loaded.value)
        except ValueError as error:
            raise click.ClickException(f"no programs can be drawn for {name}: {error}") from None
        if cell is not None:
            from yarclang.memory import NO_MEMORY
            from yarclang.pipeline.cells import cell_loader
            from yarclang.pipeline.sources import NO_TEXTS

            read = cell_loader(Path(), loaded.value, NO_TEXTS, NO_MEMORY).at(Path(cell))
            if has_errors(read.diagnostics):
                show_findings(read.diagnostics)
                raise SystemExit(1)
    return Task(names, cell)


def _what(task: Task, seed: int) -> dict[str, Any]:
    """Return the facts that identify a campaign. A saved state is continued only if its facts are equal."""
    import hashlib

    from yarclang.files import read_whole
    from yarclang.fleet.installation import this_installation
    from yarclang.robot.description import load_robot

    robots = [(name, load_robot(name).value) for name in task.robots]
    cell = (
        None if task.cell is None else hashlib.sha256(read_whole(Path(task.cell), 1 << 30)).hexdigest()[:16]
    )
    return {
        "seed": seed,
        "robots": [f"{name} {robot.fingerprint}" for name, robot in robots if robot is not None],
        "cell": cell,
        "installation": this_installation().digest[:16],
    }


def _done(state: State, task: Task, seed: int, programs: int, fleet: Fleet) -> None:
    """Generate and judge the programs of all chunks that aren't done yet."""
    from yarclang.campaign.judging import judged_chunk
    from yarclang.campaign.pieces import lost_piece
    from yarclang.campaign.state import missing
    from yarclang.cli.work import Progress
    from yarclang.fleet.outcome import Lost

    chunks = missing(state.pieces, seed, programs, _CHUNK)
    done = sum(one.count for one in state.pieces)
    if not chunks:
        return
    if done:
        click.echo(f"{done:,} programs were done before; continuing", err=True)
    with Progress() as progress, fleet.racing_workers(partial(judged_chunk, task=task)) as do:
        while chunks:
            again = []
            for place, result in do(chunks):
                first, count = chunks[place]
                piece = result
                if isinstance(piece, Lost):
                    # a program in this chunk kills processes: run each program alone to find it
                    if count > 1:
                        again += [(one, 1) for one in range(first, first + count)]
                        continue
                    piece = lost_piece(first, task.robot_of(first), piece.reason)
                state.keep(piece)
                done += count
                progress("programs", done, programs)
            chunks = again


def _once(seed: int, task: Task, format_: str) -> None:
    """Generate a random program, judge it, and print the result."""
    from yarclang.campaign.judging import judged_program
    from yarclang.campaign.report import program_data, program_text

    one = judged_program(seed, task)
    if format_ == "json":
        click.echo(json.dumps(program_data(one), indent=2))
    else:
        for line in program_text(one):
            click.echo(line)
    raise SystemExit(1 if one.faults else 0)
