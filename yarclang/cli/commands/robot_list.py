"""`yarc robot list`."""

from __future__ import annotations

import click

from yarclang.cli.options import robot_argument


@click.command("list")
@robot_argument("names", nargs=-1, metavar="[NAME|PATH]...")
def command(names: tuple[str, ...]) -> None:
    """List the robots of the standard library; with names, check these robots and show them."""
    from yarclang.cli.show import show_findings
    from yarclang.robot.description import load_robot
    from yarclang.robot.library import list_robots

    if not names:
        for robot in list_robots():
            click.echo(f"{robot.name:24}{robot.size} joints  {robot.title}")
        return
    failed = False
    for name in names:
        loaded = load_robot(name)
        show_findings(loaded.diagnostics)
        if loaded.value is None:
            failed = True
            continue
        from yarclang.report.robot import robot_text

        click.echo(robot_text(loaded.value))
    raise SystemExit(1 if failed else 0)
