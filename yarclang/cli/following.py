"""`yarc follow` from the door's side: another process steers the robot; events as JSON lines, signals as orders."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from yarclang.cli.address import Address
from yarclang.cli.controllers import SIMULATED_REPLY_TIME
from yarclang.cli.executing import Lines, Signals, log_told, refused_line, status_of, tell
from yarclang.cli.secret_file import secret_file
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.live.opening import Settings
from yarclang.coordinator.live.serving import Door, MasterServer, TcpDoor, UnixDoor
from yarclang.coordinator.opened import opened
from yarclang.robot.model import Robot
from yarclang.runtime.session import REPLY_TIME
from yarclang.units import MM


def follow(robot: Robot, address: Address, options: dict[str, Any], lines: Lines, *, own: bool) -> int:
    """Let another process steer the robot until a termination comes.

    Args:
        robot: that hangs on the controller.
        address: of the controller.
        options: of the command line.
        lines: where events go.
        own: whether the controller is a simulator of our own.

    Returns:
        The exit status.
    """
    return status_of(_follow(robot, address, options, lines, own=own), lines)


def _door(options: dict[str, Any]) -> Door:
    if options["port"] is not None:
        return TcpDoor(options["port"])
    unix = options["unix"]
    return UnixDoor(None if unix is None else Path(unix))


@contextlib.contextmanager
def _known(server: MasterServer, token_file: Path | None) -> Iterator[dict[str, Any]]:
    """Make known where masters connect to, and with which token.

    Yields:
        The event that says so.

    Raises:
        Trouble: the file of the token can't be written.
    """
    event: dict[str, Any] = {"event": "listening"}
    if not isinstance(server.door, TcpDoor):
        assert server.path is not None  # it listens
        yield event | {"unix": str(server.path.absolute())}
        return
    event |= {"host": server.door.host, "port": server.port}
    if token_file is None:
        yield event | {"token": server.door.token}
        return
    with secret_file(token_file, server.door.token + "\n"):
        yield event | {"token_file": str(token_file)}


async def _follow(robot: Robot, address: Address, options: dict[str, Any], lines: Lines, *, own: bool) -> int:
    ends = asyncio.Event()
    signals = Signals(ends.set)
    log: Path | None = NO_LOG if options["no_log"] else options["log"]
    with signals:
        async with opened(
            robot,
            address.host,
            address.port,
            folder=Path(),
            name="follow",
            cell=options["cell"],
            log=log,
            reply_time=SIMULATED_REPLY_TIME if own else REPLY_TIME,
        ) as coordinator:
            client = coordinator.attach("follow")
            client.own()
            signals.client = client
            speed = options["speed"]
            settings = Settings(speed=None if speed is None else speed * MM)
            moving = "{" + options["moving"].strip("{} ") + "}"
            with client.events() as stream:
                telling = asyncio.create_task(
                    tell(stream, lines, coordinator, positions=options["positions"])
                )
                async with MasterServer(client, _door(options), moving=moving, settings=settings) as server:
                    with _known(server, options["token_file"]) as listening:
                        around = coordinator.planner.cell
                        await lines.put(listening | {"cell": None if around is None else around.source.name})
                        await ends.wait()
                    while coordinator.under_way:
                        await asyncio.sleep(0.02)
            await asyncio.wait((telling,), timeout=1.0)
            stands = await client.stands()
    joints = dict(zip(robot.joint_names, (stands / robot.axis_units).round(6).tolist(), strict=True))
    path, sound = log_told(coordinator.engine.run_log, lines)
    said = {"status": int(not sound), "well": True, "joints": joints, "log": path}
    lines.say({**refused_line("a termination has come", ""), **said})
    return int(not sound)
