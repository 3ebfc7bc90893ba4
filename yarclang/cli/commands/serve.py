"""`yarc serve`."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.controller_options import check_controller_usage, controller_option, motion_options
from yarclang.cli.options import Numbers, cell_option, robot_option, tm_option


@click.command("serve")
@robot_option
@controller_option
@click.option(
    "--start",
    type=Numbers("Q1,Q2,..."),
    help="Where the simulated robot stands: deg, mm for prismatic joints (default: its home).",
)
@cell_option
@motion_options
@tm_option
def command(to: Address | None, **options: Any) -> None:
    """Own a robot for others: run, exec, repl and follow work with it, one at a time, while others watch; everybody may stop it.

    They find it by its controller's address (--to), or by the robot where it is simulated. A log is written for each that moves it. SIGTERM and SIGINT bring the
    robot to rest on its path, and end.
    """
    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.cells import session_cell
    from yarclang.pipeline.inputs import joint_position, robot_for

    check_controller_usage(to, options)
    if options["start"] and to is not None:
        raise click.UsageError("--start is for the simulator: a real robot stands where it stands")
    found = robot_for(Path.cwd(), options["robot"])
    show_findings(found.diagnostics)
    if found.value is None:
        raise SystemExit(1)
    robot = found.value
    placed = joint_position(robot, options["start"], "--start")
    show_findings(placed.diagnostics)
    if placed.value is None:
        raise SystemExit(1)
    around = session_cell(Path(), robot, options["cell"])
    show_findings(around.diagnostics)
    if has_errors(around.diagnostics):
        raise SystemExit(1)
    from yarclang.cli.controllers import controller
    from yarclang.cli.serving import serve
    from yarclang.cli.table import checked_table
    from yarclang.coordinator.engine import NotReady

    with trouble_is_said():
        try:
            with controller(to, robot, placed.value, options["rate"]) as address:
                raise SystemExit(asyncio.run(serve(robot, address, options, own=to is None)))
        except NotReady as trouble:
            click.echo(checked_table(trouble.inspection.errors), err=True)
            raise
