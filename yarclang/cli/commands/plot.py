"""`yarc plot`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from yarclang.cli.options import file_argument, planning_options, tm_option
from yarclang.cli.outputs import beside, refuse_collisions

_FORMATS = ("png", "svg", "pdf")


@click.command("plot")
@file_argument("file", metavar="FILE")
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help="Where to draw: .png, .svg or .pdf (- for PNG on standard output; default: FILE.png beside the source).",
)
@planning_options
@tm_option
def command(file: str, output: str | None, **planning: Any) -> None:
    """Draw the motion of a program: joints against their limits, and the tool's path. - reads standard input."""
    destination = output or beside(file, ".png")
    format_ = _format(destination)
    refuse_collisions([file], [(destination, file)])
    from yarclang.cli.show import count_text, show_findings
    from yarclang.cli.work import Progress, options_from, write_whole
    from yarclang.diagnostics import has_errors, in_order
    from yarclang.pipeline.inputs import open_program
    from yarclang.pipeline.stages import plan_module

    name = "<stdin>" if file == "-" else file
    with Progress() as progress:
        opened = open_program(file, options_from(planning, progress))
        diagnostics, plan = opened.diagnostics, None
        if opened.value is not None:
            planned = plan_module(opened.value.module, opened.value.request)
            diagnostics, plan = (*diagnostics, *planned.diagnostics), planned.value
        progress.pause()
        show_findings(in_order(diagnostics))
        if plan is None or has_errors(diagnostics):
            click.echo(f"{name}: {count_text(in_order(diagnostics)) or 'no motion'}; nothing drawn", err=True)
            raise SystemExit(1)
        from yarclang.report.plot import draw

        picture = draw(plan, format_)
    if destination == "-":
        click.echo(picture, nl=False)
    elif faults := write_whole(Path(destination), picture):
        show_findings(faults)
        raise SystemExit(1)
    where = "standard output" if destination == "-" else destination
    click.echo(f"{name}: {plan.duration:.3f} s drawn to {where}", err=True)


def _format(destination: str) -> Any:
    """The format that the extension names; what isn't known is wrong usage."""
    if destination == "-":
        return "png"
    extension = Path(destination).suffix.removeprefix(".").lower()
    if extension not in _FORMATS:
        known = ", ".join(f".{one}" for one in _FORMATS)
        wrong = f".{extension} can't be drawn" if extension else "the extension says the format"
        raise click.BadParameter(f"{wrong}; there are {known}", param_hint="-o")
    return extension
