"""`yarc new`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from yarclang.cli.options import robot_option

if TYPE_CHECKING:
    from yarclang.robot.model import Robot


def _of_template(name: str, robot: Robot) -> str:
    """Return the text of a template's program for a robot, after a proof that the program works for this
    robot.
    """
    import tempfile

    from yarclang.runtime.actions import Trouble
    from yarclang.teaching.templates import new

    # prove it in an empty folder, because the project doesn't exist yet
    with tempfile.TemporaryDirectory() as folder:
        try:
            return new(name, robot, {}, Path(folder))
        except Trouble as trouble:
            raise click.UsageError(f"{trouble.what}: {trouble.remedy}") from None


@click.command("new")
@click.argument("name")
@robot_option
@click.option(
    "--template",
    "template",
    metavar="NAME",
    help="Begin with a program for a task: pick-place, pallet, weld, glue, tend or empty.",
)
def command(name: str, robot: str | None, template: str | None) -> None:
    """Make the folder NAME with a program for a robot, its settings, and files for editors and CI."""
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_all
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.inputs import robot_for
    from yarclang.pipeline.new_project import CHECK, check_folder, check_name, project_files
    from yarclang.robot.library import find_robot

    folder = Path(name)
    found = check_name(name) or check_folder(folder)
    if not found:
        loaded = robot_for(Path.cwd(), robot)
        found = loaded.diagnostics
        if loaded.value is not None:
            library = find_robot(loaded.value.name)[0]
            entry = loaded.value.name
            if library is None or library.parent.resolve() != loaded.value.folder.resolve():
                own = find_robot(robot)[0] if robot is not None else None
                entry = os.path.relpath(own or loaded.value.folder, folder)
            files = project_files(name, loaded.value, entry)
            if template is not None:
                files[f"{name}.yarc"] = _of_template(template, loaded.value)
            found += write_all([(folder / place, text) for place, text in files.items()])
    show_findings(found)
    if has_errors(found):
        raise SystemExit(1)
    (folder / CHECK).chmod((folder / CHECK).stat().st_mode | 0o111)
    click.echo(f"{name} was created; cd {name}, then yarc check {name}.yarc")
