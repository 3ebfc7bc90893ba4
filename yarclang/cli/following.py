"""`yarc follow` from the door's side: another process steers the robot over TCP; events as JSON lines, signals as orders."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

from yarclang.cli.address import Address
from yarclang.cli.controllers import SIMULATED_REPLY_TIME
from yarclang.cli.executing import Lines, Signals, refused_line, status_of, tell
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.live.opening import Settings
from yarclang.coordinator.live.serving import MasterServer
from yarclang.coordinator.opened import opened
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
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
            log=log,
            reply_time=SIMULATED_REPLY_TIME if own else REPLY_TIME,
        ) as coordinator:
            client = coordinator.attach("follow")
            client.own()
            signals.client = client
            if options["cell"] is not None:
                made = await client.offer(f'CELL "{options["cell"]}"')
                if made.value is None:
                    raise Trouble(
                        f"the cell can't be used: {made.diagnostics[0].message}", "see its findings"
                    )
                await client.go(made.value)
            speed = options["speed"]
            settings = Settings(speed=None if speed is None else speed * MM)
            moving = "{" + options["moving"].strip("{} ") + "}"
            with client.events() as stream:
                telling = asyncio.create_task(
                    tell(stream, lines, coordinator, positions=options["positions"])
                )
                async with MasterServer(client, options["port"], moving=moving, settings=settings) as server:
                    await lines.put({"event": "listening", "host": "127.0.0.1", "port": server.port})
                    await ends.wait()
                    while coordinator.under_way:
                        await asyncio.sleep(0.02)
            await asyncio.wait((telling,), timeout=1.0)
            stands = await client.stands()
    joints = dict(zip(robot.joint_names, (stands / robot.axis_units).round(6).tolist(), strict=True))
    lines.say({**refused_line("a termination has come", ""), "status": 0, "well": True, "joints": joints})
    return 0
