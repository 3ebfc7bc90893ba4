"""`yarc doctor`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import SIM, Address, AddressType, trouble_is_said
from yarclang.cli.options import complete_robots, format_option

if TYPE_CHECKING:
    from yarclang.robot.model import Robot
    from yarclang.runtime.inspection import Inspection
    from yarclang.runtime.scripts import Measured


@click.command("doctor")
@click.option(
    "--robot",
    required=True,
    metavar="NAME|PATH",
    shell_complete=complete_robots,
    help="The robot of the controller.",
)
@click.option(
    "--to",
    type=AddressType(),
    default=SIM,
    metavar="sim|tcp://HOST[:PORT]",
    help="The controller (default: a built-in simulator).",
)
@format_option
def command(robot: str, to: Address | None, format_: str) -> None:
    """Look at a controller: kind, settings, motors, guard PLC, and the link to it. Nothing moves.

    Exit status 1 says that `yarc run` would refuse.
    """
    import asyncio

    from yarclang.cli.controllers import controller
    from yarclang.cli.show import show_findings
    from yarclang.pipeline.inputs import named_robot
    from yarclang.runtime.transports.lock import controller_lock

    loaded = named_robot(Path(), robot)
    show_findings(loaded.diagnostics)
    if loaded.value is None:
        raise SystemExit(1)
    with trouble_is_said(), controller(to, loaded.value, loaded.value.home) as address:
        # lock the controller: the test of the guard would hold a running program
        with controller_lock(address.host, address.port):
            inspection, link = asyncio.run(_examine(loaded.value, address))
        _show(loaded.value, robot, address, inspection, link, format_)
    raise SystemExit(1 if inspection.errors else 0)


async def _examine(robot: Robot, address: Address) -> tuple[Inspection, Measured | None]:
    """Return the findings, and the measurement of the link.

    The link isn't measured while a program runs, because the program may need the link's full rate.
    """
    from yarclang.pipeline.settings import items_of
    from yarclang.runtime.scripts import scripts_of
    from yarclang.runtime.session import Session

    items = items_of(robot)
    scripts = scripts_of(robot.controller.kind)
    session = Session(address.host, address.port, scripts=scripts)
    try:
        await session.perform(scripts.connect(session.operation))
        inspection = await session.perform(scripts.look(session.operation, robot, items))
        if not inspection.idle:
            return inspection, None
        return inspection, await session.perform(scripts.measured(session.operation, robot))
    finally:
        session.close()


def _show(
    robot: Robot, given: str, address: Address, inspection: Inspection, link: Measured | None, format_: str
) -> None:
    if format_ == "json":
        import json

        click.echo(json.dumps(_json(robot, address, inspection, link), indent=2))
        return
    from yarclang.cli.controllers import robot_argument
    from yarclang.cli.table import checked_table
    from yarclang.runtime.standing import described

    where = f"--to {address} --robot {robot_argument(robot, given)}"
    # errors come last, so that they are visible after a hundred lines
    order = ("ok", "warning", "error")
    checked = sorted(inspection.checked, key=lambda one: order.index(one.verdict))
    click.echo(checked_table(checked).replace("`yarc stop --to ...`", f"`yarc stop {where}`"))
    if inspection.joints is not None:
        click.echo(f"\n{robot.name} is commanded to {described(robot, inspection.joints)}")
    if link is not None:
        for line in link.lines:
            click.echo(line)
    wrong, count = len(inspection.errors), len(inspection.checked)
    click.echo(
        f"\n{wrong} of {count} checks failed: no program can be run"
        if wrong
        else f"\nall {count} checks passed"
    )


def _json(robot: Robot, address: Address, inspection: Inspection, link: Measured | None) -> dict[str, Any]:
    joints = inspection.joints
    places = [None] * robot.size if joints is None else (joints / robot.axis_units).round(6).tolist()
    return {
        "controller": str(address),
        "robot": robot.name,
        "checked": [
            {
                "subject": one.subject,
                "found": one.found,
                "wanted": one.wanted,
                "verdict": one.verdict,
                "help": one.remedy or None,
            }
            for one in inspection.checked
        ],
        "joints": [
            {"name": name, "commanded": place, "unit": unit}
            for name, place, unit in zip(robot.joint_names, places, robot.axis_unit_names, strict=True)
        ],
        "link": None if link is None else dict(link.values),
    }
