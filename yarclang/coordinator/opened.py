"""A coordinator on a controller, alone on this computer, and to be ordered about by other processes (`yarc status`, `yarc stop`, clients)."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from secrets import randbelow

from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.serving import ControlSocket
from yarclang.robot.model import Robot
from yarclang.runtime.scripts import scripts_of
from yarclang.runtime.session import REPLY_TIME, Leash
from yarclang.runtime.transports.lock import controller_lock
from yarclang.runtime.transports.promptness import prompt_thread
from yarclang.simulated_cell.playing import SimulatedCell

_MOST_FIRST = 2**40
"""Numbers of programs and offers begin anywhere below: those of a coordinator that has ended mean nothing to this one."""


@dataclass(frozen=True, slots=True)
class Ground:
    """Where a coordinator works, and how.

    Attributes:
        host: of the controller.
        port: likewise.
        folder: where modules, cells and yarc.toml are looked for.
        name: what `yarc status` calls it while nothing is under way.
        tm: longest segment time of what is planned [ms]; None: the robot's.
        cell: the path of a cell.toml that all motions keep to; None: that of yarc.toml, if it names one.
        log: where motions are logged (`Engine`).
        reply_time: after so long a reply is lost [s].
        pace: how fast the controller's time passes: 1, but for a simulator.
        patience: for how long this computer may be silent before its controller holds [s]; None: what the link allows.
        simulated: whether the controller is a simulator of our own, in this process: it doesn't go on while this process is kept from its work.
        serves: whether the coordinator is there to serve other processes.
        surroundings: the machines around a robot that is simulated in this process; None: it isn't.
        leash: the time of a simulator in this process; None: the controller waits for nobody.
        patient: whether the coordinator is there also while the controller isn't ready (`Coordinator`).
        unattended: whether nobody can resume what no person has held (`Operation.unattended`).
    """

    host: str
    port: int
    folder: Path
    name: str
    tm: float | None = None
    log: Path | None = None
    reply_time: float = REPLY_TIME
    pace: float = 1.0
    patience: float | None = None
    simulated: bool = False
    serves: bool = False
    cell: str | None = None
    surroundings: SimulatedCell | None = None
    leash: Leash | None = None
    unattended: bool = False
    patient: bool = False


@asynccontextmanager
async def opened(robot: Robot, ground: Ground) -> AsyncIterator[Coordinator]:
    """Yield a coordinator that is at work as long as the context lasts.

    Args:
        robot: that hangs on the controller.
        ground: where it works.

    Raises:
        ControlError: another process of this computer drives the controller.
        Trouble: the controller can't be reached, or isn't what the robot needs (`NotReady`).
    """
    with controller_lock(ground.host, ground.port), prompt_thread():
        session = OrderedSession(
            ground.host,
            ground.port,
            reply_time=max(ground.reply_time, ground.patience or 0.0),
            pace=ground.pace,
            leash=ground.leash,
            scripts=scripts_of(robot.controller.kind),
        )
        if ground.patience is not None:
            session.operation.wanted_silence = ground.patience * ground.pace
        session.operation.unattended = ground.unattended
        coordinator = Coordinator(
            robot,
            session,
            folder=ground.folder,
            tm=ground.tm,
            log=ground.log,
            name=ground.name,
            cell=ground.cell,
            simulated=ground.simulated,
            serves=ground.serves,
            surroundings=ground.surroundings,
            patient=ground.patient,
            first=1 + randbelow(_MOST_FIRST),
        )
        async with coordinator, ControlSocket(coordinator):
            yield coordinator
