"""`yarc repl`."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.controller_options import check_controller_usage, controller_option, log_options
from yarclang.cli.options import Numbers, cell_option, robot_option, tm_option


@click.command("repl")
@robot_option
@cell_option
@controller_option
@click.option(
    "--start",
    type=Numbers("Q1,Q2,..."),
    help="Where the simulated robot stands: deg, mm for prismatic joints (default: its home).",
)
@click.option("--go", is_flag=True, help="Move without asking, as .go does.")
@log_options
@tm_option
def command(to: Address | None, **options: Any) -> None:
    """Work with a robot live: each line is planned from where it stands, certified, shown, and carried out.

    .help lists what else can be typed; Ctrl-C stops the robot. Standard input that is no terminal is read line by line.
    """
    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.cells import session_cell
    from yarclang.pipeline.inputs import joint_position, robot_for
    from yarclang.report.cell import cell_text

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
    if around.value is not None and around.value.loaded.value is not None:
        click.echo(cell_text(around.value.loaded.value), err=True)
    from yarclang.cli.controllers import controller

    with trouble_is_said(), controller(to, robot, placed.value, options["rate"]) as address:
        raise SystemExit(asyncio.run(_session(robot, address, options, own=to is None)))


async def _session(robot: Any, address: Address, options: dict[str, Any], *, own: bool) -> int:
    from yarclang import __version__
    from yarclang.cli.controllers import SIMULATED_REPLY_TIME
    from yarclang.cli.ending import error_text
    from yarclang.cli.table import checked_table
    from yarclang.coordinator.engine import NO_LOG, NotReady
    from yarclang.coordinator.opened import opened
    from yarclang.repl.console import converse
    from yarclang.repl.interpreter import Interpreter, trouble_text
    from yarclang.runtime.actions import Trouble
    from yarclang.runtime.session import REPLY_TIME

    terminal = sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()
    try:
        async with opened(
            robot,
            address.host,
            address.port,
            folder=Path.cwd(),
            name="repl",
            tm=options["tm"],
            cell=options["cell"],
            log=NO_LOG if options["no_log"] else options["log"],
            reply_time=SIMULATED_REPLY_TIME if own else REPLY_TIME,
            pace=options["rate"] or 1.0,
        ) as coordinator:
            client = coordinator.attach("repl")
            client.own()
            interpreter = Interpreter(coordinator, client, click.echo, Path.cwd(), asks=not options["go"])
            if terminal:
                click.echo(
                    f"yarc {__version__}: {robot.name} at {address}. .help lists what can be typed; Ctrl-C stops the robot, Ctrl-D ends."
                )
            await converse(interpreter, coordinator, terminal=terminal)
            client.leave()
    except NotReady as trouble:
        click.echo(checked_table(trouble.inspection.errors), err=True)
        click.echo(f"{address} isn't what {robot.name} needs", err=True)
        return 1
    except Trouble as trouble:
        click.echo(trouble_text(trouble), err=True)
        return 1
    run_log = coordinator.engine.run_log
    if run_log is not None and run_log.problem:
        click.echo(error_text(run_log.problem, run_log.remedy), err=True)
        return 1
    return int(interpreter.failed and not terminal)
