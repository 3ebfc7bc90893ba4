"""`yarc reach`."""

from __future__ import annotations

from pathlib import Path

import click

from yarclang.cli.options import robot_argument


@click.command("reach")
@robot_argument("robot", metavar="[FOLDER|robot.toml|NAME]", default=".")
@click.option(
    "-o", "--output", metavar="OUT", help="The picture, a .png (default: NAME.reach.png in this folder)."
)
def command(robot: str, output: str | None) -> None:
    """Draw where a robot can hold its flange, and in how many orientations, from the side and from above.

    The picture shows errors of a URDF: with missing joints there are few orientations, or a thin shell.
    """
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_whole
    from yarclang.robot.description import load_robot

    if output is not None and not output.lower().endswith(".png"):
        raise click.BadParameter("only .png can be drawn", param_hint="-o")
    loaded = load_robot(robot)
    if loaded.value is None:
        show_findings(loaded.diagnostics)
        raise SystemExit(1)
    from yarclang.report.pictures.held import draw_held

    destination = Path(output or f"{loaded.value.name.lower()}.reach.png")
    if faults := write_whole(destination, draw_held(loaded.value, "png")):
        show_findings(faults)
        raise SystemExit(1)
    click.echo(f"{loaded.value.name}: where the flange can be held drawn to {destination}", err=True)
