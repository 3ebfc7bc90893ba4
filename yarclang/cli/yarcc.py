"""`yarcc`: compile programs to certified controller text."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang import __version__
from yarclang.cli.door import Door
from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.options import (
    avoid_effort_option,
    file_argument,
    fleet_options,
    format_option,
    planning_options,
    tm_option,
)
from yarclang.cli.outputs import refuse_collisions
from yarclang.cli.threads import one_for_products

if TYPE_CHECKING:
    from yarclang.certify.certificate import Certificate
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.stages import Compiled


def _known_target(context: click.Context, parameter: click.Parameter, value: str) -> str:  # noqa: ARG001 - the signature is click's
    """Return the kind of controller text that --target names, after a check that a kind of controller
    supports it.
    """
    if value:
        from yarclang.backend import backend_called
        from yarclang.robot.kinds import kind_names

        known = list(dict.fromkeys(one for kind in kind_names() for one in backend_called(kind).targets))
        if value not in known:
            raise click.BadParameter(f"'{value}' isn't a target; the targets are {', '.join(known)}.")
    return value


_ONE_PROGRAM = "-o and --certificate need exactly one program; use --out-dir for several"


@click.command(cls=Door, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="yarcc %(version)s")
@file_argument("files", nargs=-1, metavar="PATH...")
@click.option(
    "-o", "--output", metavar="OUT", help="File for the text of one program (- for standard output)."
)
@click.option(
    "--out-dir",
    type=click.Path(file_okay=False, path_type=Path),
    help="The folder to write to (default: beside each source).",
)
@planning_options
@tm_option
@avoid_effort_option
@click.option(
    "--target",
    metavar="TARGET",
    default="",
    callback=_known_target,
    help=(
        "Target of the text; for a Turbo PMAC `rotary`, to be streamed (default), or `prog`, a program "
        "buffer to download."
    ),
)
@click.option(
    "--certificate", type=click.Path(dir_okay=False, path_type=Path), help="Write the certificate as JSON."
)
@click.option(
    "--proof",
    is_flag=True,
    help="Write a proof for `yarc verify`, as NAME.proof.json beside the text.",
)
@click.option(
    "--full",
    is_flag=True,
    help=(
        "Show every command in the table, with all columns, for any length of the program and width of "
        "the terminal."
    ),
)
@click.option("--strict", is_flag=True, help="Treat warnings as errors.")
@fleet_options
@format_option
def main(
    files: tuple[str, ...],
    output: str | None,
    out_dir: Path | None,
    certificate: Path | None,
    proof: bool,
    full: bool,
    strict: bool,
    jobs: int | None,
    scheduler: str,
    no_cache: bool,
    format_: str,
    **planning: Any,
) -> None:
    """Compile YARC programs to their controller's text, and prove what they do.

    It reports the findings of `yarc check`, except those that comments or yarc.toml suppress. FILE.yarc
    becomes FILE.pmc; - reads standard input, and a folder, with --out-dir, means all .yarc files in it.
    Nothing is written for a program with an error.
    """
    _check_usage(files, output, out_dir, certificate, format_)
    if proof and output == "-":
        raise click.UsageError(
            "--proof writes beside the text, but the text goes to standard output: give a file with -o"
        )
    one_for_products()
    seldom_look_for_garbage()
    from yarclang.cli.compiling import Task, compile_all, destinations_of

    destinations = destinations_of(files, output, out_dir)
    if len(destinations) > 1 and (output is not None or certificate is not None):
        raise click.UsageError(_ONE_PROGRAM)
    results = [(destination, file) for file, destination in destinations.items()]
    if certificate is not None:
        results.append((str(certificate), "the certificate"))
    if proof:
        results += [(_proof_beside(one), f"the proof of {file}") for file, one in destinations.items()]
    refuse_collisions(destinations, results)
    from yarclang.cli.fleet import Fleet
    from yarclang.cli.work import Progress, options_from
    from yarclang.parallel import on_cores

    failed = False
    reports: list[tuple[dict[str, Any], Certificate | None]] = []
    fleet = Fleet(jobs, scheduler, reuses=not no_cache)
    with Progress() as progress, on_cores(jobs):
        task = Task(options_from(planning), strict, proof)
        progress.file(0, len(destinations))
        made = zip(destinations.items(), compile_all(list(destinations), task, fleet), strict=True)
        for number, ((file, destination), one) in enumerate(made, 1):
            compiled, diagnostics = one.compiled, one.found
            if compiled is not None and not any(finding.is_error for finding in diagnostics):
                if output is None:
                    destination = _called(destination, compiled)  # noqa: PLW2901 - as its controller calls it
                diagnostics += _write(compiled, destination, certificate, one.proof)
            progress.pause()
            written = compiled is not None and not any(finding.is_error for finding in diagnostics)
            failed |= not written
            if format_ == "json":
                reports.append(_report(file, destination if written else None, compiled, diagnostics))
            else:
                _show(file, destination, compiled if written else None, diagnostics, full=full)
            progress.file(number, len(destinations))
        progress.pause()
    if fleet.remark:
        click.echo(fleet.remark, err=True)
    if format_ == "json":
        from yarclang.report.certificate_json import reports_pieces

        for piece in reports_pieces(reports):
            click.echo(piece, nl=False)
    raise SystemExit(1 if failed else 0)


def _check_usage(
    files: tuple[str, ...], output: str | None, out_dir: Path | None, certificate: Path | None, format_: str
) -> None:
    """Reject options that exclude each other."""
    if output is not None and out_dir is not None:
        raise click.UsageError("-o and --out-dir exclude each other")
    if len(files) > 1 and (output is not None or certificate is not None):
        raise click.UsageError(_ONE_PROGRAM)
    if output == "-" and format_ == "json":
        raise click.UsageError("-o - and --format json both write to standard output")
    if len(set(files)) < len(files):
        raise click.UsageError("a file is named twice")
    if certificate is not None and str(certificate) == "-":
        raise click.UsageError(
            "--certificate needs a file; use --format json to write the certificate to standard output"
        )


def _called(destination: str, compiled: Compiled) -> str:
    """Return a text's path with the suffix of the program's kind of controller."""
    from yarclang.backend import backend_of

    if destination == "-":
        return destination
    return str(Path(destination).with_suffix(backend_of(compiled.plan.robot).suffix))


def _proof_beside(destination: str) -> str:
    return str(Path(destination).with_suffix(".proof.json"))


def _write(
    compiled: Compiled, destination: str, certificate: Path | None, proof: str | None
) -> tuple[Diagnostic, ...]:
    """Write text, certificate and proof; if one of them can't be written, write none."""
    from yarclang.cli.work import write_all, write_standard_output

    files: list[tuple[Path, str]] = []
    if destination != "-":
        files.append((Path(destination), compiled.text))
    if proof is not None:
        files.append((Path(_proof_beside(destination)), proof))
    if certificate is not None:
        from yarclang.report.certificate_json import certificate_pieces

        files.append((certificate, "".join((*certificate_pieces(compiled.certificate), "\n"))))
    found = write_all(files)
    if not found and destination == "-":
        found = write_standard_output(compiled.text)
    return found


def _show(
    file: str,
    destination: str,
    compiled: Compiled | None,
    diagnostics: tuple[Diagnostic, ...],
    *,
    full: bool,
) -> None:
    from yarclang.cli.show import show_findings
    from yarclang.report.finding import count_text

    show_findings(diagnostics)
    name = "<stdin>" if file == "-" else file
    if compiled is None:
        click.echo(f"{name}: {count_text(diagnostics) or 'no output'}; nothing written", err=True)
        if os.path.isfile(destination):  # noqa: PTH113 (Path.is_file raises where a folder can't be searched)
            click.echo(f"  {destination} existed before and is unchanged", err=True)
        return
    from yarclang.cli.screen import width_of, wrapped

    to_stderr = destination == "-"
    width = width_of(sys.stderr if to_stderr else sys.stdout)
    if compiled.certificate.commands:
        _show_table(compiled, width, full=full, err=to_stderr)
    where = "standard output" if to_stderr else destination
    tolerance = compiled.certificate.tolerance
    of_tables = [
        command.kind == "timed" for command in compiled.certificate.commands if command.tolerance is not None
    ]
    others = ", or that of TOL" if not all(of_tables) else ""
    others += ", or that of a timetable" if any(of_tables) else ""
    told = (
        f"{name}: {compiled.certificate.lasting.text()}, certified: {compiled.certificate.summary()} "
        f"(tolerance {tolerance.position * 1e3:g} mm, {tolerance.angle * 57.29577951308232:.4g} deg{others})"
    )
    click.echo("\n".join((*wrapped(told, width), f"written to {where}")), err=to_stderr)


def _show_table(compiled: Compiled, width: int | None, *, full: bool, err: bool) -> None:
    """Write the certificate as a table; for a long program, first a table of the commands nearest to a
    limit.
    """
    from yarclang.cli.table import certificate_table, nearest_table

    certificate, robot, cell = compiled.certificate, compiled.plan.robot, compiled.program.cell
    if not full and (near := nearest_table(certificate, robot, cell, width)):
        click.echo(f"{near}\n", err=err)
    click.echo(certificate_table(certificate, full=full, width=width, robot=robot, cell=cell), err=err)


def _report(
    file: str, destination: str | None, compiled: Compiled | None, diagnostics: tuple[Diagnostic, ...]
) -> tuple[dict[str, Any], Certificate | None]:
    from yarclang.report.finding import finding_json

    report = {
        "file": file,
        "output": destination,
        "diagnostics": [finding_json(diagnostic) for diagnostic in diagnostics],
    }
    return report, compiled.certificate if compiled and destination else None
