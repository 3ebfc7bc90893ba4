"""`yarc diff`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import click

from yarclang.cli.options import Numbers, cell_option, file_argument, format_option

if TYPE_CHECKING:
    from yarclang.cli.work import Progress
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.executed import Executed
    from yarclang.report.comparison.compared import Comparison
    from yarclang.robot.model import Tolerance

_HEADER = 4096
"""Number of characters at the beginning of a controller text that certainly contain the robot's
fingerprint.
"""

_COLOURS = {"+": "green", "-": "red", "~": "yellow"}


@click.command("diff")
@file_argument("first", metavar="A.yarc|A.pmc")
@file_argument("second", metavar="B.yarc|B.pmc")
@click.option(
    "--tolerance",
    type=Numbers("MM[,DEG]", most=2, positive=True),
    help="Allowed difference of the tool (default: the robot's path tolerance; DEG in the same ratio).",
)
@click.option("--all", "all_commands", is_flag=True, help="Also show commands that don't differ.")
@click.option(
    "--robot", metavar="NAME|PATH", help="A robot of the standard library, or the path of a robot.toml."
)
@cell_option
@format_option
def command(
    first: str,
    second: str,
    tolerance: tuple[float, ...] | None,
    all_commands: bool,
    robot: str | None,
    cell: str | None,
    format_: str,
) -> None:
    """Compare two programs by what the robot does: paths, times, configurations, outputs, waits. Comments,
    layout and renumbering are no difference.

    The exit status is 0 if they are equal within the tolerance, and 1 if they differ, as for diff, or if a
    program can't be read or compiled.
    """
    if first == second == "-":
        raise click.UsageError("only one of the two programs can be standard input")
    from yarclang.cli.work import Progress

    with Progress() as progress:
        comparison = _compared((first, second), robot, cell, tolerance, progress)
    _show(comparison, all_commands, format_)


def _compared(
    files: tuple[str, str],
    robot: str | None,
    cell: str | None,
    tolerance: tuple[float, ...] | None,
    progress: Progress,
) -> Comparison:
    """Read and compare two programs; exit with status 1 if they can't be compared."""
    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import Diagnostic
    from yarclang.progress import part

    programs: list[Executed] = []
    for file in files:
        with part(file):
            found, diagnostics = _read(file, robot, cell)
        progress.pause()
        show_findings(diagnostics)
        if found is None:
            click.echo(f"{file}: nothing was compared", err=True)
            raise SystemExit(1)
        programs.append(found)
    first, second = files
    one, other = programs
    if (one.robot.name, one.robot.joint_names) != (other.robot.name, other.robot.joint_names):
        message = (
            f"{first} is for {one.robot.name}, {second} for {other.robot.name}: their paths can't be compared"
        )
        show_findings((Diagnostic("Y1163", message, help="give two programs for one robot"),))
        raise SystemExit(1)
    from yarclang.report.comparison.compared import compare

    return compare(one, other, _tolerance(tolerance, other.robot.tolerance))


def _show(comparison: Comparison, all_commands: bool, format_: str) -> None:
    from yarclang.report.comparison.text import compared_json, compared_lines

    if format_ == "json":
        import json

        click.echo(json.dumps(compared_json(comparison), indent=2, ensure_ascii=False))
        raise SystemExit(int(not comparison.equal))
    for sign, line in compared_lines(comparison, all_commands=all_commands):
        click.echo(click.style(line, fg=_COLOURS[sign]) if sign in _COLOURS else line)
    raise SystemExit(int(not comparison.equal))


def _tolerance(asked: tuple[float, ...] | None, usual: Tolerance) -> Tolerance:
    """Return the requested tolerance in SI, or the robot's own tolerance `usual` if none is requested. If
    only a length [mm] is requested, the ratio of angle to length is that of `usual`.
    """
    from yarclang.robot.model import Tolerance
    from yarclang.units import DEG, MM

    if asked is None:
        return usual
    position = asked[0] * MM
    angle = asked[1] * DEG if len(asked) > 1 else position * usual.angle / usual.position
    return Tolerance(position, angle)


def _read(file: str, robot: str | None, cell: str | None) -> tuple[Executed | None, tuple[Diagnostic, ...]]:
    """Return the motions and actions of a program, and its errors."""
    from yarclang.cli.work import options_from
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.checking import check_program_file
    from yarclang.pipeline.controller_text import is_compiled, read_controller_text, robot_of_text
    from yarclang.pipeline.executed import executed
    from yarclang.pipeline.line_map import is_compiled_text

    if is_compiled(file):
        read = read_controller_text(file)
        if read.value is None:
            return None, read.diagnostics
        if not is_compiled_text(read.value.text):
            message = "this text wasn't written by yarcc"
            return None, (Diagnostic("Y1151", message, read.value, help="give a .pmc that yarcc wrote"),)
        found = robot_of_text(read.value, robot)
        if found.value is None:
            return None, found.diagnostics
        if found.value.fingerprint not in read.value.text[:_HEADER]:
            click.echo(
                f"{file} was compiled for an earlier description of {found.value.name}; it is read with "
                "the present one",
                err=True,
            )
        made = executed(read.value.text, found.value, file)
        return made.value, (*found.diagnostics, *made.diagnostics)
    checked = check_program_file(file, options_from({"robot": robot, "cell": cell}))
    compiled = checked.compiled
    if compiled is None:
        # leave out warnings: they are reported when the program is compiled
        return None, tuple(one for one in checked.diagnostics if one.is_error)
    carried = {one.step: one.carries for one in compiled.certificate.commands}
    made = executed(compiled.text, compiled.plan.robot, file, carried)
    return made.value, tuple(replace(one, source=None) for one in made.diagnostics)
