"""`yarc robot check`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import click

from yarclang.cli.options import format_option, robot_argument

if TYPE_CHECKING:
    from yarclang.robot.checklist.item import Item
    from yarclang.robot.model import Robot

_COLOURS = {"ok": "green", "note": "cyan", "to do": "red"}


@click.command("check")
@robot_argument("robot", metavar="[FOLDER|robot.toml|NAME]", default=".")
@format_option
def command(robot: str, format_: str) -> None:
    """Check a robot: its files, limits, kinematics, motors, and values that are still guesses.

    The exit status is 1 while anything is left to do.
    """
    import os
    from itertools import zip_longest

    from yarclang.collision.checklist import body_items
    from yarclang.robot.checklist import check_robot

    if robot.lower().endswith((".urdf", ".xacro")):
        raise click.UsageError(
            f"{robot} is a URDF: `yarc robot new` creates a robot's folder from it; check that folder"
        )
    checked = check_robot(robot, body_items, _times)
    if format_ == "json":
        import json

        fields = ("subject", "verdict", "found", "remedy")
        points = [{name: getattr(item, name) for name in fields} for item in checked.items]
        click.echo(json.dumps({"version": 1, "checks": points}, indent=2, ensure_ascii=False))
        raise SystemExit(1 if checked.to_do else 0)
    colour = False if os.environ.get("NO_COLOR") else None
    for item, after in zip_longest(checked.items, checked.items[1:]):
        mark = click.style(f"{item.verdict:6}", fg=_COLOURS[item.verdict], bold=item.verdict == "to do")
        click.echo(f"{mark} {item.subject}: {item.found}", color=colour)
        again = after is not None and (after.verdict, after.remedy) == (item.verdict, item.remedy)
        if item.verdict != "ok" and item.remedy and not again:
            click.echo(f"       do: {item.remedy}")
    name = checked.robot.name if checked.robot else robot
    notes = sum(item.verdict == "note" for item in checked.items)
    click.echo(f"{name}: {checked.to_do} to do, {notes} note{'s' * (notes != 1)}")
    raise SystemExit(1 if checked.to_do else 0)


def _times(robot: Robot) -> Iterator[Item]:
    """Yield lines with the measured times of inverse kinematics for many poses at once, in process time."""
    import time

    from yarclang.robot.checklist.geometry import POSES
    from yarclang.robot.checklist.item import Item
    from yarclang.robot.kinematics.fk import flange_poses
    from yarclang.robot.kinematics.search import reaching, within

    poses = flange_poses(robot.chain, within(robot.chain, robot.limits, POSES))
    begun = time.process_time()
    reaching(robot.chain, robot.limits, poses)
    each = (time.process_time() - begun) / POSES
    yield Item("time of solutions", "ok", f"{each * 1e6:,.0f} µs a pose, of {POSES} at once")
