"""`yarc settings`."""

from __future__ import annotations

import click

from yarclang.cli.options import robot_argument


@click.command("settings")
@robot_argument("robot", metavar="ROBOT")
def command(robot: str) -> None:
    """Print what a controller has to be told once about ROBOT (a name or a path): axis definitions,
    feedback, limits, and the guard of the rotary buffer.
    """
    from yarclang.backend_pmac.settings import settings_text
    from yarclang.cli.show import show_findings
    from yarclang.robot.description import load_robot

    loaded = load_robot(robot)
    show_findings(loaded.diagnostics)
    if loaded.value is None:
        raise SystemExit(1)
    click.echo(settings_text(loaded.value), nl=False)
