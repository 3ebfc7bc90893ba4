"""`yarc check`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.options import file_argument, format_option, planning_options, tm_option

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.inputs import Options


@click.command("check")
@file_argument("files", nargs=-1, metavar="FILE...")
@planning_options
@tm_option
@click.option("--strict", is_flag=True, help="A warning counts as an error.")
@format_option
def command(files: tuple[str, ...], strict: bool, format_: str, **planning: Any) -> None:
    """Check programs: everything that yarcc checks before it writes. - reads standard input.

    A FILE.toml is checked by itself: robot.toml is a robot's, any other a cell's (for --robot, if it is given).
    """
    from yarclang.cli.show import count_text, finding_json, show_findings
    from yarclang.cli.work import Progress, options_from
    from yarclang.diagnostics import in_order

    found: list[Diagnostic] = []
    with Progress() as progress:
        options = options_from(planning, progress)
        for file in files:
            diagnostics = _checked(file, options)
            progress.pause()
            if format_ == "text":
                show_findings(in_order(diagnostics))
            found += in_order(diagnostics)
    if format_ == "json":
        import json

        document = {"version": 1, "diagnostics": [finding_json(diagnostic) for diagnostic in found]}
        click.echo(json.dumps(document, indent=2, ensure_ascii=False))
    else:
        files_text = f"{len(files)} file{'s' * (len(files) != 1)}"
        click.echo(f"{files_text} checked: {count_text(found) or 'nothing to complain of'}", err=True)
    failed = any(one.is_error or (strict and one.severity == "warning") for one in found)
    raise SystemExit(1 if failed else 0)


def _checked(file: str, options: Options) -> tuple[Diagnostic, ...]:
    """The findings of a program, or of the description of a cell or a robot."""
    from yarclang.pipeline.cells import SUFFIX, check_description
    from yarclang.pipeline.inputs import open_program
    from yarclang.pipeline.stages import plan_module

    if file.lower().endswith(SUFFIX):
        return check_description(file, options.robot)
    opened = open_program(file, options)
    if opened.value is None:
        return opened.diagnostics
    planned = plan_module(opened.value.module, opened.value.request)
    return (*opened.diagnostics, *planned.diagnostics)
