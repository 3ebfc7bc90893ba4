"""`yarc stop`."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from yarclang.cli.address import (
    Address,
    check_controller_options,
    controller_options,
    run_option,
    trouble_is_said,
)

if TYPE_CHECKING:
    from yarclang.robot.model import Array, Robot

_PATIENCE = 30.0
"""Longest wait until a run ends [s], including the time to come to rest and to reconnect."""

_TELL = 0.3
"""Longest wait for an answer of the run that drives the controller [s]. It is short because the run may
hang.
"""

_LET_END = 2.0
"""Longest wait [s] until a run that has answered the order to stop ends. After that the controller itself
is stopped.
"""


@click.command("stop")
@run_option
@controller_options
@click.option(
    "--abort", is_flag=True, help="Stop each motor at once with its deceleration Ixx15, off the path."
)
def command(run: str | None, to: Address | None, robot: str | None, abort: bool) -> None:
    """End a run: the robot slows down on its path, and the program ends.

    With --to and --robot, no run is needed: the motion of the robot is ended, whatever has started it; for
    example after a killed run.
    """
    check_controller_options(to, robot, run)
    with trouble_is_said():
        order = "abort" if abort else "stop"
        if to is not None and robot is not None:
            _stop_controller(to, robot, order)
        else:
            _stop_run(run, order)


def _stop_run(name: str | None, what: str) -> None:
    from yarclang.cli.ordering import order
    from yarclang.runtime.transports.runs import the_run

    chosen = the_run(name)
    status = order(chosen, what, _PATIENCE)
    state = "" if status is None else f" ({status['state']})"
    click.echo(f"{chosen.name}: ended{state}")


def _stop_controller(to: Address, name: str, what: str) -> None:
    import asyncio

    from yarclang.cli.show import show_findings
    from yarclang.pipeline.inputs import named_robot
    from yarclang.runtime.standing import described

    loaded = named_robot(Path(), name)
    show_findings(loaded.diagnostics)
    robot = loaded.value
    if robot is None:
        raise SystemExit(1)
    _tell_run(to, what)
    joints = asyncio.run(_end(to, robot, what))
    where = f"is at {described(robot, joints)}" if joints is not None else "isn't homed any more: inspect it"
    click.echo(f"no program runs on {to}; {robot.name} {where}")


def _tell_run(to: Address, what: str) -> None:
    """Ask the run that drives the controller to end its program, since the run can stop the robot more gently
    than the controller alone. A run that hangs doesn't prevent the stop.
    """
    from yarclang.cli.ordering import send
    from yarclang.runtime.actions import Trouble
    from yarclang.runtime.transports.lock import holder_of
    from yarclang.runtime.transports.runs import run_on

    with contextlib.suppress(Trouble):
        until = time.monotonic() + _LET_END
        if (run := run_on(to.host, to.port)) is None:
            if (holder := holder_of(to.host, to.port)) is not None:
                text = (
                    f"{holder} drives this controller and can't be reached: the controller itself is stopped"
                )
                click.echo(text, err=True)
            return
        click.echo(f"{run.name} drives this controller, and was asked to end", err=True)
        send(run, what, timeout=_TELL)
        while run_on(to.host, to.port) is not None and time.monotonic() < until:
            time.sleep(0.05)


async def _end(to: Address, robot: Robot, what: str) -> Array | None:
    from yarclang.runtime.scripts import scripts_of
    from yarclang.runtime.session import Session

    scripts = scripts_of(robot.controller.kind)
    session = Session(to.host, to.port, scripts=scripts)
    try:
        await session.perform(scripts.connect(session.operation))
        return await session.perform(scripts.end_what_runs(session.operation, robot, abort=what == "abort"))
    finally:
        session.close()
