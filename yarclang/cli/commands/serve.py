"""`yarc serve`."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.preparing import machines, prepared, session_options


@click.command("serve")
@session_options
def command(to: Address | None, **options: Any) -> None:
    """Own a robot for others: run, exec, repl, follow and pendant work with it, one at a time, while others watch; everybody may stop it.

    They find it by its controller's address (--to), or by the robot where it is simulated. A log is written for each that moves it. SIGTERM and SIGINT bring the
    robot to rest on its path, and end.
    """
    found = prepared(Path(), to, options)
    robot, around = found.robot, machines(Path(), found.robot, options)
    from yarclang.cli.controllers import controller
    from yarclang.cli.serving import serve

    with (
        trouble_is_said(),
        controller(to, robot, found.stands, options["rate"], surroundings=around) as address,
    ):
        own = around if to is None else None
        raise SystemExit(asyncio.run(serve(robot, address, options, own=own)))
