"""Implement `yarc serve`: own a robot for other clients, and report what they do."""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import Address
from yarclang.cli.attaching import tell_whether_ready
from yarclang.cli.controllers import SIMULATED_REPLY_TIME
from yarclang.cli.screen import Screen
from yarclang.cli.secret_file import secret_file
from yarclang.cli.terminations import terminations
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.live.serving import TcpDoor
from yarclang.coordinator.messages import events
from yarclang.coordinator.opened import Ground, opened
from yarclang.coordinator.subscription import Subscription
from yarclang.coordinator.values_door import ValuesDoor
from yarclang.report.cell import cell_text
from yarclang.robot.model import Robot
from yarclang.runtime.session import REPLY_TIME
from yarclang.runtime.state import State
from yarclang.runtime.transports.private import folder, own_name
from yarclang.simulated_cell.playing import SimulatedCell


async def serve(
    robot: Robot,
    address: Address,
    options: dict[str, Any],
    *,
    own: SimulatedCell | None,
    values: TcpDoor | None = None,
) -> int:
    """Drive a robot for clients until a termination (SIGTERM or SIGINT). Then bring it to rest on its path.

    Args:
        robot: robot of the controller.
        address: address of the controller.
        options: options of the command line.
        own: machines around the robot, if the controller is a simulator in this process.
        values: TCP port at which other software sends values to running programs. None: values are accepted
            only through the coordinator's socket.

    Returns:
        The exit status.

    Raises:
        ControlError: another process of this computer drives the controller.
        Trouble: the robot's settings aren't proved.
    """
    ground = Ground(
        address.host,
        address.port,
        Path.cwd(),
        "serve",
        tm=options["tm"],
        cell=options["cell"],
        log=NO_LOG if options["no_log"] else options["log"],
        reply_time=SIMULATED_REPLY_TIME if own is not None else REPLY_TIME,
        pace=options["rate"] or 1.0,
        patience=options["patience"],
        simulated=own is not None,
        surroundings=own,
        leash=address.leash,
        serves=True,
        patient=True,
    )
    screen = Screen()  # a stopped or closed terminal doesn't delay the robot
    try:
        with terminations() as ends:
            async with opened(robot, ground) as coordinator:
                tell_whether_ready(coordinator)
                if coordinator.cell is not None:
                    screen.say(cell_text(coordinator.cell))
                async with contextlib.AsyncExitStack() as doors:
                    if values is not None:
                        await _open(ValuesDoor(coordinator, values), options["values_token"], doors, screen)
                    stream = doors.enter_context(coordinator.subscribe(positions=False))
                    telling = asyncio.create_task(_tell(stream, screen))
                    where = folder() / f"{own_name(robot.name)}.sock"
                    click.echo(f"{robot.name} at {address} is served: {where}")
                    await ends.wait()
                    if coordinator.under_way:
                        screen.say(f"{coordinator.under_way} is being stopped on its path")
                telling.cancel()
    finally:
        screen.close()
    return 0


async def _open(door: ValuesDoor, token: Path, doors: contextlib.AsyncExitStack, screen: Screen) -> None:
    """Accept values until the context ends, and report the address.

    Raises:
        Trouble: the server can't listen on the port, or the token can't be written.
    """
    await doors.enter_async_context(door)
    doors.enter_context(secret_file(token, door.door.token + "\n"))
    screen.say(f"values are accepted at {door.door.host}:{door.port}, with the token in {token}")


async def _tell(stream: Subscription, screen: Screen) -> None:
    """Report which client moves the robot, the start and end of its programs, and problems."""
    async for event in stream:
        if text := _text(event):
            screen.say(text)


def _text(event: events.BaseEvent) -> str:
    match event:
        case events.OwnerChanged(owner=owner):
            return f"{owner} owns the robot" if owner else "nobody owns the robot"
        case events.Began(name=name, client=client):
            return f"{client}: {name}"
        case events.Finished(name=name, well=well, what=what):
            return f"{name}: done" if well else f"{name}: {what}"
        case events.StateChanged(state=state, why=why) if state in (State.FAULT, State.DISCONNECTED):
            return f"{state.value}: {why}"
        case events.Told(text=text, warning=warning):
            return f"warning: {text}" if warning else text
        case _:
            return ""
