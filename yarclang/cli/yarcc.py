"""`yarcc`: programs to certified controller text."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang import __version__
from yarclang.cli.door import Door, failure_of, is_failure
from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.options import file_argument, format_option, planning_options, tm_option
from yarclang.cli.outputs import beside, refuse_collisions

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.inputs import Options
    from yarclang.pipeline.stages import Compiled


@click.command(cls=Door, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="yarcc %(version)s")
@file_argument("files", nargs=-1, metavar="FILE...")
@click.option(
    "-o", "--output", metavar="OUT", help="Where to write the text of one program (- for standard output)."
)
@click.option(
    "--out-dir",
    type=click.Path(file_okay=False, path_type=Path),
    help="The folder to write to (default: beside each source).",
)
@planning_options
@tm_option
@click.option(
    "--target",
    type=click.Choice(["rotary", "prog"]),
    default="rotary",
    help="For streaming into the rotary buffer, or as a program buffer to download.",
)
@click.option(
    "--certificate", type=click.Path(dir_okay=False, path_type=Path), help="Write the certificate as JSON."
)
@click.option("--strict", is_flag=True, help="A warning counts as an error.")
@format_option
def main(
    files: tuple[str, ...],
    output: str | None,
    out_dir: Path | None,
    certificate: Path | None,
    strict: bool,
    format_: str,
    **planning: Any,
) -> None:
    """Compile YARC programs to Turbo PMAC text, and prove what they do.

    It finds what `yarc check` finds, and comments and yarc.toml silence the same. FILE.yarc becomes FILE.pmc; - reads standard input. A program with an error leaves no file.
    """
    _check_usage(files, output, out_dir, certificate, format_)
    seldom_look_for_garbage()
    destinations = {file: output or beside(file, ".pmc", out_dir) for file in files}
    results = [(destination, file) for file, destination in destinations.items()]
    if certificate is not None:
        results.append((str(certificate), "the certificate"))
    refuse_collisions(files, results)
    from yarclang.cli.work import Progress, options_from

    failed = False
    reports: list[dict[str, Any]] = []
    with Progress() as progress:
        options = options_from(planning)
        for file in files:
            destination = destinations[file]
            try:
                compiled, diagnostics = _compiled(file, options, destination, certificate, strict)
            except Exception as error:
                if not is_failure(error):
                    raise
                compiled, diagnostics = None, (failure_of(error, file),)
            progress.pause()
            written = compiled is not None and not any(one.is_error for one in diagnostics)
            failed |= not written
            if format_ == "json":
                reports.append(_report(file, destination if written else None, compiled, diagnostics))
            else:
                _show(file, destination, compiled if written else None, diagnostics)
    if format_ == "json":
        import json

        click.echo(json.dumps({"version": 1, "files": reports}, indent=2, ensure_ascii=False))
    raise SystemExit(1 if failed else 0)


def _check_usage(
    files: tuple[str, ...], output: str | None, out_dir: Path | None, certificate: Path | None, format_: str
) -> None:
    """What can't be meant together is wrong usage."""
    if output is not None and out_dir is not None:
        raise click.UsageError("-o and --out-dir exclude each other")
    if len(files) > 1 and (output is not None or certificate is not None):
        raise click.UsageError("-o and --certificate go with one program; --out-dir takes several")
    if output == "-" and format_ == "json":
        raise click.UsageError("-o - and --format json both write to standard output")
    if len(set(files)) < len(files):
        raise click.UsageError("a file is named twice")
    if certificate is not None and str(certificate) == "-":
        raise click.UsageError(
            "--certificate takes a file; --format json writes the certificate to standard output"
        )


def _compiled(
    file: str, options: Options, destination: str, certificate: Path | None, strict: bool
) -> tuple[Compiled | None, tuple[Diagnostic, ...]]:
    """Compile a file, and write what comes of it. None if there is nothing to write."""
    from yarclang.pipeline.checking import check_program_file

    checked = check_program_file(file, options)
    compiled, diagnostics = checked.compiled, checked.diagnostics
    if compiled is not None and strict and any(one.severity == "warning" for one in diagnostics):
        compiled = None
    if compiled is not None:
        diagnostics += _write(compiled, destination, certificate)
    return compiled, diagnostics


def _write(compiled: Compiled, destination: str, certificate: Path | None) -> tuple[Diagnostic, ...]:
    """Write text and certificate: both, or neither."""
    import json

    from yarclang.cli.work import write_all, write_standard_output

    files: list[tuple[Path, str]] = []
    if destination != "-":
        files.append((Path(destination), compiled.text))
    if certificate is not None:
        files.append((certificate, json.dumps(compiled.certificate.to_json(), indent=2) + "\n"))
    found = write_all(files)
    if not found and destination == "-":
        found = write_standard_output(compiled.text)
    return found


def _show(
    file: str, destination: str, compiled: Compiled | None, diagnostics: tuple[Diagnostic, ...]
) -> None:
    from yarclang.cli.show import show_findings
    from yarclang.cli.table import certificate_table
    from yarclang.report.finding import count_text

    show_findings(diagnostics)
    name = "<stdin>" if file == "-" else file
    if compiled is None:
        click.echo(f"{name}: {count_text(diagnostics) or 'no output'}; nothing written", err=True)
        if os.path.isfile(destination):  # noqa: PTH113 (Path.is_file raises where a folder can't be searched)
            click.echo(f"  {destination} was there before and is unchanged", err=True)
        return
    to_stderr = destination == "-"
    if compiled.certificate.commands:
        click.echo(certificate_table(compiled.certificate), err=to_stderr)
    where = "standard output" if to_stderr else destination
    tolerance = compiled.certificate.tolerance
    click.echo(
        f"{name}: {compiled.certificate.duration:.3f} s, certified: {compiled.certificate.summary()} "
        f"(tolerance {tolerance.position * 1e3:g} mm, {tolerance.angle * 57.29577951308232:.4g} deg)\nwritten to {where}",
        err=to_stderr,
    )


def _report(
    file: str, destination: str | None, compiled: Compiled | None, diagnostics: tuple[Diagnostic, ...]
) -> dict[str, Any]:
    from yarclang.report.finding import finding_json

    return {
        "file": file,
        "output": destination,
        "diagnostics": [finding_json(diagnostic) for diagnostic in diagnostics],
        "certificate": compiled.certificate.to_json() if compiled and destination else None,
    }
