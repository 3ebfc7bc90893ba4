"""`yarc new`."""

from __future__ import annotations

import os
from pathlib import Path

import click

from yarclang.cli.options import robot_option


@click.command("new")
@click.argument("name")
@robot_option
def command(name: str, robot: str | None) -> None:
    """Make the folder NAME with a program for a robot, its settings, and what editors and CI need."""
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
            found += write_all([(folder / place, text) for place, text in files.items()])
    show_findings(found)
    if has_errors(found):
        raise SystemExit(1)
    (folder / CHECK).chmod((folder / CHECK).stat().st_mode | 0o111)
    click.echo(f"{name} is made; cd {name}, then yarc check {name}.yarc")
