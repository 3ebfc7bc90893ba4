"""`yarc serve`."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.preparing import machines, prepared, session_options

if TYPE_CHECKING:
    from yarclang.coordinator.live.serving import TcpDoor

_LARGEST_PORT = 65535


@click.command("serve")
@click.option(
    "--values",
    metavar="[HOST:]PORT",
    help=(
        "TCP port (0: any free one; of this computer if no HOST is given) at which a camera, the gateway "
        "of a PLC or a script sends values to running programs. It must send the token."
    ),
)
@click.option(
    "--values-token",
    type=click.Path(path_type=Path),
    metavar="PATH",
    help="With --values: the file to which the token is written, which only this user can read.",
)
@session_options
def command(to: Address | None, **options: Any) -> None:
    """Serve a robot: run, exec, repl, follow and pendant use it, one at a time, while others watch; everybody
    may stop it.

    Clients find it by its controller's address (--to), or by the robot's name if it is simulated. Each client
    that moves it gets a log. SIGTERM and SIGINT bring the robot to rest on its path, and end.
    """
    if (options["values"] is None) != (options["values_token"] is None):
        raise click.UsageError("--values and --values-token go together")
    door = None if options["values"] is None else _values_door(options["values"])
    found = prepared(Path(), to, options)
    robot, around = found.robot, machines(Path(), found.robot, options)
    from yarclang.cli.controllers import controller
    from yarclang.cli.serving import serve

    with (
        trouble_is_said(),
        controller(to, robot, found.stands, options["rate"], surroundings=around) as address,
    ):
        own = around if to is None else None
        raise SystemExit(asyncio.run(serve(robot, address, options, own=own, values=door)))


def _values_door(text: str) -> TcpDoor:
    """Parse `[HOST:]PORT`.

    Raises:
        click.UsageError: the text is invalid.
    """
    from yarclang.coordinator.live.serving import LOOPBACK, TcpDoor

    host, _, port = text.rpartition(":")
    if not (port.isascii() and port.isdigit() and len(port) <= 5 and int(port) <= _LARGEST_PORT):
        raise click.UsageError(
            f"--values: {text[:60]!r} isn't [HOST:]PORT, with a port from 0 to {_LARGEST_PORT}"
        )
    return TcpDoor(int(port), host.strip("[]") or LOOPBACK)
