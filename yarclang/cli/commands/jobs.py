"""`yarc jobs`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from yarclang.cli.options import planning_options, tm_option


@click.command("jobs")
@click.argument("folder", default=".", metavar="[FOLDER]", type=click.Path())
@planning_options
@tm_option
def command(folder: str, **options: Any) -> None:
    """Prove the jobs of a project: the programs that its yarc.toml numbers in [jobs].

    Each is compiled and certified, and must begin and end where the first one begins, so that any job may
    follow any other. `yarc run FOLDER --job N` runs one.
    """
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import options_from
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.joblist import listed_jobs

    project = project_with_jobs(folder)
    rows, is_well = [], True
    for one in listed_jobs(project, options_from(options)):
        show_findings(one.diagnostics)
        is_well = is_well and one.job is not None and not has_errors(one.diagnostics)
        said = "not certified" if one.job is None else f"{one.job.lasting.text()}, certified"
        rows.append((str(one.number), one.file, said))
    widths = [max(len(row[column]) for row in rows) for column in (0, 1)]
    for number, file, said in rows:
        click.echo(f"{number:>{widths[0]}}  {file:<{widths[1]}}  {said}")
    raise SystemExit(0 if is_well else 1)


def project_with_jobs(folder: str) -> Any:
    """Return the project in a folder, or the project of a yarc.toml. If it is invalid or has no jobs, show
    the findings and exit.
    """
    from yarclang.cli.show import show_findings
    from yarclang.pipeline.project import FILE_NAME, find_project

    place = Path(folder)
    found = find_project(place.parent if place.name == FILE_NAME else place)
    if found.value is None:
        show_findings(found.diagnostics)
        raise SystemExit(1)
    if not found.value.jobs:
        source = found.value.source
        what = (
            f"no {FILE_NAME} is in {folder}, or above it"
            if source is None
            else f"{source.called} has no jobs"
        )
        raise click.UsageError(f'{what}: write [jobs] into it, and below 1 = "left.yarc"')
    return found.value


def file_of_job(folder: str, number: int) -> str:
    """Return the program that has a number in a project."""
    project = project_with_jobs(folder)
    file = project.jobs.get(number)
    if file is None:
        known = ", ".join(map(str, sorted(project.jobs)))
        raise click.UsageError(f"there is no job {number}: {project.source.called} has {known}")
    return str(project.folder / file)
