"""`yarc repl`."""

from __future__ import annotations

import asyncio
import contextlib
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.preparing import machines, prepared, session_options

if TYPE_CHECKING:
    from yarclang.cli.attaching import Place
    from yarclang.coordinator.attached import Attached
    from yarclang.coordinator.messages.replies import LogTold
    from yarclang.robot.model import Robot


@click.command("repl")
@session_options
@click.option("--go", is_flag=True, help="Move without asking for confirmation, as .go does.")
def command(to: Address | None, **options: Any) -> None:
    """Work with a robot live: each line is planned from where it stands, certified, shown, and carried out.

    .help lists what else can be typed; Ctrl-C stops the robot. Standard input that is no terminal is read
    line by line.
    """
    from yarclang.cli.attaching import place_of, place_served, served_at

    found = prepared(Path(), to, options)
    robot = found.robot
    with trouble_is_said():
        if (served := served_at(to, lambda: robot)) is not None:
            raise SystemExit(asyncio.run(_session(robot, place_served(served, robot, options), options)))
        around = machines(Path(), robot, options)
        with place_of(to, robot, found.stands, options["rate"], surroundings=around) as place:
            raise SystemExit(asyncio.run(_session(robot, place, options)))


async def _session(robot: Robot, place: Place, options: dict[str, Any]) -> int:
    from yarclang import __version__
    from yarclang.cli.attaching import attached, check_cell
    from yarclang.cli.ending import error_text
    from yarclang.cli.table import checked_table
    from yarclang.coordinator.engine import NotReady
    from yarclang.coordinator.messages import orders
    from yarclang.repl.console import converse
    from yarclang.repl.interpreter import Interpreter
    from yarclang.repl.session import trouble_text
    from yarclang.report.cell import cell_text
    from yarclang.runtime.actions import Trouble

    terminal = sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()
    folder = Path.cwd()
    try:
        async with attached(place, robot, "repl", options, what="repl", folder=folder) as client:
            if place.served is not None and options["cell"] is not None:
                check_cell(client, options["cell"])
            if (cell := client.welcome.status.cell) is not None:
                click.echo(cell_text(cell), err=True)
            # if another client owns the robot, this client only watches at first
            with contextlib.suppress(Trouble):
                await client.ask(orders.Own(shared=True))
            interpreter = Interpreter(
                client, robot, click.echo, folder, asks=not options["go"], tm=options["tm"]
            )
            if terminal:
                click.echo(
                    f"yarc {__version__}: {robot.name} at {place}. .help lists what can be typed; Ctrl-C "
                    "stops the robot, Ctrl-D ends."
                )
            await converse(interpreter, terminal=terminal)
            log = await _released(client)
    except NotReady as trouble:
        click.echo(checked_table(trouble.inspection.errors), err=True)
        click.echo(f"{place} doesn't fit {robot.name}", err=True)
        return 1
    except Trouble as trouble:
        click.echo(trouble_text(trouble), err=True)
        return 1
    if log is not None and log.problem:
        click.echo(error_text(log.problem, log.help), err=True)
        return 1
    return int(interpreter.failed and not terminal)


async def _released(client: Attached) -> LogTold | None:
    """Wait until the robot is at rest, and return the state of the log."""
    from yarclang.coordinator.messages import orders

    return (await client.ask(orders.Release())).log
