"""`yarc plot`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from yarclang.cli.options import file_argument, planning_options, tm_option
from yarclang.cli.outputs import STANDARD, beside, refuse_collisions

_FORMATS = ("png", "svg", "pdf")


@click.command("plot")
@file_argument("file", metavar="FILE")
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help="File to write: .png, .svg or .pdf (- for PNG on standard output; default: FILE.png beside the source).",
)
@planning_options
@tm_option
def command(file: str, output: str | None, **planning: Any) -> None:
    """Draw the motion of a program: joints against their limits, and the tool's path. - reads standard input.

    For a run's log (.mcap): planned and actual motion.
    """
    from yarclang.report.runs.kind import is_log

    destination = output or beside(file, ".png")
    format_ = _format(destination)
    refuse_collisions([file], [(destination, file)])
    if file != STANDARD and is_log(file):
        if given := [f"--{name}" for name, value in planning.items() if value is not None]:
            raise click.UsageError(f"{', '.join(given)}: the log of a run says that itself")
        picture, what = _run_picture(file, format_)
    else:
        picture, what = _program_picture(file, format_, planning)
    _write(picture, what, destination)


def _program_picture(file: str, format_: Any, planning: dict[str, Any]) -> tuple[bytes, str]:
    """Return a program's picture, and a description of it."""
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import Progress, options_from
    from yarclang.diagnostics import has_errors, in_order
    from yarclang.pipeline.checking import settled_in_folder
    from yarclang.pipeline.inputs import open_program
    from yarclang.pipeline.stages import plan_module
    from yarclang.report.finding import count_text

    name = "<stdin>" if file == STANDARD else file
    with Progress() as progress:
        opened = open_program(file, options_from(planning))
        diagnostics, plan = opened.diagnostics, None
        if opened.value is not None:
            planned = plan_module(opened.value.module, opened.value.request)
            folder = Path.cwd() if file == STANDARD else Path(file).parent
            diagnostics = settled_in_folder(
                (*diagnostics, *planned.diagnostics), opened.value.module.source, folder, opened.value
            )
            plan = planned.value
        progress.pause()
        show_findings(in_order(diagnostics))
        if plan is None or has_errors(diagnostics):
            click.echo(f"{name}: {count_text(in_order(diagnostics)) or 'no motion'}; nothing drawn", err=True)
            raise SystemExit(1)
        from yarclang.report.pictures.plot import draw

        return draw(plan, format_), f"{name}: {plan.lasting.text()}"


def _run_picture(file: str, format_: Any) -> tuple[bytes, str]:
    """Return a run's picture, and a description of it."""
    from yarclang.cli.show import show_findings
    from yarclang.report.runs.log import read_run
    from yarclang.report.runs.planned import planned_motion

    run = read_run(file)
    show_findings(run.diagnostics)
    if run.value is not None:
        planned = planned_motion(run.value)
        show_findings(planned.diagnostics)
        if planned.value is not None:
            from yarclang.report.runs.plot import draw_run

            return draw_run(run.value, planned.value, format_), f"{file}: a run of {run.value.end:.3f} s"
    click.echo(f"{file}: nothing drawn", err=True)
    raise SystemExit(1)


def _write(picture: bytes, what: str, destination: str) -> None:
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_whole

    if destination == STANDARD:
        click.echo(picture, nl=False)
    elif faults := write_whole(Path(destination), picture):
        show_findings(faults)
        raise SystemExit(1)
    where = "standard output" if destination == STANDARD else destination
    click.echo(f"{what} drawn to {where}", err=True)


def _format(destination: str) -> Any:
    """Return the format from the extension. An unknown one is a usage error."""
    if destination == STANDARD:
        return "png"
    extension = Path(destination).suffix.removeprefix(".").lower()
    if extension not in _FORMATS:
        known = ", ".join(f".{one}" for one in _FORMATS)
        wrong = f".{extension} can't be drawn" if extension else "the extension says the format"
        raise click.BadParameter(f"{wrong}; there are {known}", param_hint="-o")
    return extension
