"""`yarc serve` from the door's side: own a robot for others, and tell what they do."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import Address
from yarclang.cli.controllers import SIMULATED_REPLY_TIME
from yarclang.cli.screen import Screen
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.messages import events
from yarclang.coordinator.opened import Ground, opened
from yarclang.coordinator.subscription import Subscription
from yarclang.report.cell import cell_text
from yarclang.robot.model import Robot
from yarclang.runtime.session import REPLY_TIME
from yarclang.runtime.state import State
from yarclang.runtime.transports.private import folder, own_name

_ENDING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


async def serve(robot: Robot, address: Address, options: dict[str, Any], *, own: bool) -> int:
    """Own a robot until a termination comes; then it comes to rest on its path.

    Args:
        robot: that hangs on the controller.
        address: of the controller.
        options: of the command line.
        own: whether the controller is a simulator of our own.

    Returns:
        The exit status.

    Raises:
        ControlError: another process of this computer drives the controller.
        Trouble: the controller can't be reached, or isn't what the robot needs (`NotReady`).
    """
    ground = Ground(
        address.host,
        address.port,
        Path.cwd(),
        "serve",
        tm=options["tm"],
        cell=options["cell"],
        log=NO_LOG if options["no_log"] else options["log"],
        reply_time=SIMULATED_REPLY_TIME if own else REPLY_TIME,
        pace=options["rate"] or 1.0,
        patience=options["patience"],
        simulated=own,
        serves=True,
    )
    screen = Screen()  # a terminal that is stopped, or gone, delays no robot
    try:
        with _terminations() as ends:
            async with opened(robot, ground) as coordinator:
                if coordinator.cell is not None:
                    screen.say(cell_text(coordinator.cell))
                with coordinator.subscribe(positions=False) as stream:
                    telling = asyncio.create_task(_tell(stream, screen))
                    where = folder() / f"{own_name(robot.name)}.sock"
                    click.echo(f"{robot.name} at {address} is served: {where}")
                    await ends.wait()
                    if coordinator.under_way:
                        screen.say(f"{coordinator.under_way} is stopped on its path")
                telling.cancel()
    finally:
        screen.close()
    return 0


@contextmanager
def _terminations() -> Iterator[asyncio.Event]:
    """Yield what is set when somebody wants the end."""
    ends = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in _ENDING:
        loop.add_signal_handler(number, ends.set)
    try:
        yield ends
    finally:
        for number in _ENDING:
            loop.remove_signal_handler(number)


async def _tell(stream: Subscription, screen: Screen) -> None:
    """Say who moves the robot, what begins and ends, and what is wrong."""
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
