"""`yarc plot`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from yarclang.cli.options import file_argument, jobs_option, planning_options, scheduler_option, tm_option
from yarclang.cli.outputs import STANDARD, refuse_collisions

_FORMATS = ("png", "svg", "pdf")


@click.command("plot")
@file_argument("files", nargs=-1, metavar="FILE...")
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help=(
        "File to write: .png, .svg or .pdf (- for PNG on standard output; default: FILE.png beside the "
        "source)."
    ),
)
@click.option(
    "--out-dir",
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Folder for the pictures of several programs; those of a folder keep its structure.",
)
@planning_options
@tm_option
@jobs_option
@scheduler_option
def command(
    files: tuple[str, ...],
    output: str | None,
    out_dir: Path | None,
    jobs: int | None,
    scheduler: str,
    **planning: Any,
) -> None:
    """Draw the motions of programs: joints against their limits, and the tool's path. - reads standard input.

    For a run's log (.mcap): planned and actual motion. A folder, with --out-dir, means all .yarc files in it.
    """
    if output is not None and out_dir is not None:
        raise click.UsageError("-o and --out-dir exclude each other")
    from yarclang.cli.compiling import destinations_of
    from yarclang.report.runs.kind import is_log

    destinations = destinations_of(files, output, out_dir, ".png")
    if len(destinations) > 1 and output is not None:
        raise click.UsageError("-o names one picture: use --out-dir for several")
    formats = {file: _format(destination) for file, destination in destinations.items()}
    refuse_collisions(destinations, [(destination, file) for file, destination in destinations.items()])
    logs = {file for file in destinations if file != STANDARD and is_log(file)}
    if logs and (given := [f"--{name}" for name, value in planning.items() if value is not None]):
        raise click.UsageError(f"{', '.join(given)}: a run's log contains this already")
    if _draw(destinations, formats, logs, planning, jobs, scheduler):
        raise SystemExit(1)


def _draw(
    destinations: dict[str, str],
    formats: dict[str, Any],
    logs: set[str],
    planning: dict[str, Any],
    jobs: int | None,
    scheduler: str,
) -> bool:
    """Draw all files in their order; return True if one of them has no picture."""
    from yarclang.cli.fleet import Fleet
    from yarclang.cli.pictures import draw_programs, draw_run, put
    from yarclang.cli.work import Progress, options_from

    failed = False
    with Progress() as progress:
        progress.file(0, len(destinations))
        programs = [(file, formats[file]) for file in destinations if file not in logs]
        made = draw_programs(programs, options_from(planning), Fleet(jobs, scheduler))
        for number, (file, destination) in enumerate(destinations.items(), 1):
            drawn = draw_run(file, formats[file]) if file in logs else next(made)
            progress.pause()
            failed |= not put(drawn, destination)
            progress.file(number, len(destinations))
        progress.pause()
    return failed


def _format(destination: str) -> Any:
    """Return the format of a picture by the extension of its file. An unknown extension is a usage error."""
    if destination == STANDARD:
        return "png"
    extension = Path(destination).suffix.removeprefix(".").lower()
    if extension not in _FORMATS:
        known = ", ".join(f".{one}" for one in _FORMATS)
        wrong = f".{extension} can't be drawn" if extension else "the extension selects the format"
        raise click.BadParameter(f"{wrong}; there are {known}", param_hint="-o")
    return extension
