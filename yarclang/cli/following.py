"""Implement `yarc follow`: another process moves the robot. Events are written as JSON lines, and signals of
the operating system are orders.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from yarclang.cli.attaching import Place, attached, check_cell
from yarclang.cli.executing import Lines, Signals, log_line, refused_line, status_of, tell
from yarclang.cli.secret_file import secret_file
from yarclang.coordinator.attached import Attached
from yarclang.coordinator.engine import UNDER_WAY
from yarclang.coordinator.live.serving import Door, MasterServer, TcpDoor, UnixDoor
from yarclang.coordinator.messages import orders
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble

_EACH = 0.02
"""Time between two checks whether the robot is at rest [s]."""


def follow(robot: Robot, place: Place, options: dict[str, Any], lines: Lines) -> int:
    """Let another process move the robot until a termination (SIGTERM or SIGINT).

    Args:
        robot: robot of the controller.
        place: controller or running coordinator of the robot.
        options: options of the command line.
        lines: output of events.

    Returns:
        The exit status.
    """
    return status_of(_follow(robot, place, options, lines), lines)


def _door(options: dict[str, Any]) -> Door:
    if options["port"] is not None:
        return TcpDoor(options["port"])
    unix = options["unix"]
    return UnixDoor(None if unix is None else Path(unix))


@contextlib.contextmanager
def _known(server: MasterServer, token_file: Path | None) -> Iterator[dict[str, Any]]:
    """Publish the address and the token with which another process connects to move the robot.

    Yields:
        The event with the address.

    Raises:
        Trouble: the file of the token can't be written.
    """
    event: dict[str, Any] = {"event": "listening"}
    if not isinstance(server.door, TcpDoor):
        assert server.path is not None  # the server listens
        yield event | {"unix": str(server.path.absolute())}
        return
    event |= {"host": server.door.host, "port": server.port}
    if token_file is None:
        yield event | {"token": server.door.token}
        return
    with secret_file(token_file, server.door.token + "\n"):
        yield event | {"token_file": str(token_file)}


async def _follow(whose: Robot, place: Place, options: dict[str, Any], lines: Lines) -> int:
    ends = asyncio.Event()
    signals = Signals(ends.set)
    with signals:
        async with attached(place, whose, "follow", options, what="follow") as robot:
            await robot.ask(orders.Own())
            signals.attached = robot
            if place.served is not None and options["cell"] is not None:
                check_cell(robot, options["cell"])
            moving = "{" + options["moving"].strip("{} ") + "}"
            with await robot.listen(positions=options["positions"]) as stream:
                telling = asyncio.create_task(tell(stream, lines))
                async with MasterServer(
                    robot, _door(options), robot=whose.name, moving=moving, speed=options["speed"]
                ) as server:
                    with _known(server, options["token_file"]) as listening:
                        await lines.put(listening | {"cell": robot.welcome.status.cell})
                        await ends.wait()
                    stands = await _at_rest(robot)
            await asyncio.wait((telling,), timeout=1.0)
            released = await robot.ask(orders.Release())
    path, sound = log_line(released.log, lines)
    said = {"status": int(not sound), "well": True, "joints": stands, "log": path}
    lines.say({**refused_line("the process was asked to terminate", ""), **said})
    return int(not sound)


async def _at_rest(robot: Attached) -> dict[str, float]:
    """Wait until the robot is at rest, and return its position [deg or mm]."""
    while True:
        try:
            return (await robot.ask(orders.AskPlace())).joints
        except Trouble as trouble:
            if trouble.code != UNDER_WAY:
                raise
        await asyncio.sleep(_EACH)
