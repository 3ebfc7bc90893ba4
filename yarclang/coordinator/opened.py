"""A coordinator on a controller, alone on this computer, and to be ordered about from other terminals (`yarc status`, `yarc stop`)."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.ordered import OrderedSession
from yarclang.robot.model import Robot
from yarclang.runtime.remote import About
from yarclang.runtime.session import REPLY_TIME
from yarclang.runtime.transports.local import ControlSocket
from yarclang.runtime.transports.lock import controller_lock


@asynccontextmanager
async def opened(
    robot: Robot,
    host: str,
    port: int,
    *,
    folder: Path,
    name: str,
    tm: float | None = None,
    cell: str | None = None,
    log: Path | None = None,
    reply_time: float = REPLY_TIME,
    pace: float = 1.0,
) -> AsyncIterator[Coordinator]:
    """A coordinator that is at work as long as the context lasts.

    Args:
        robot: that hangs on the controller.
        host: of the controller.
        port: likewise.
        folder: where modules, cells and yarc.toml are looked for.
        name: what `yarc status` calls it while nothing is under way.
        tm: longest segment time of what is planned [ms]; None: the robot's.
        cell: the path of a cell.toml that all motions keep to; None: that of yarc.toml, if it names one.
        log: where motions are logged (`Engine`).
        reply_time: after so long a reply is lost [s].
        pace: how fast the controller's time passes: 1, but for a simulator.

    Raises:
        ControlError: another process of this computer drives the controller.
        Trouble: the controller can't be reached, or isn't what the robot needs (`NotReady`).
    """
    with controller_lock(host, port):
        session = OrderedSession(host, port, reply_time=reply_time, pace=pace)
        coordinator = Coordinator(robot, session, folder=folder, tm=tm, cell=cell, log=log)
        async with coordinator, ControlSocket(session, lambda: About(coordinator.under_way or name, robot)):
            yield coordinator
