"""Start of a coordinator for a controller. On this computer, only one coordinator can run for each
controller. Other processes can send orders to it (`yarc status`, `yarc stop`, clients).
"""

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
"""Upper bound of the random number at which a coordinator begins to number programs and offers. Because the
beginning is random, a number from an earlier coordinator isn't taken for that of a program or offer of this
one.
"""


@dataclass(frozen=True, slots=True)
class Ground:
    """Settings of a coordinator.

    Attributes:
        host: host of the controller.
        port: port of the controller.
        folder: folder that contains modules, cells and yarc.toml.
        name: name that `yarc status` shows while nothing is in progress.
        tm: longest segment time of planned motions [ms]; None: that of the robot.
        cell: path of a cell.toml for all motions; None: the one that yarc.toml names, if any.
        log: file or folder in which motions are logged (`Engine`).
        reply_time: longest time until the controller replies [s].
        pace: speed of the controller's clock relative to this computer's clock; 1, except for a simulator.
        patience: longest silence of this computer before the controller holds the robot [s]; None: a time
            that depends on how fast the connection is.
        simulated: True if the controller is yarclang's simulator in this process. The simulator pauses
            whenever this process can't run.
        serves: True if the coordinator serves other processes.
        surroundings: machines around a robot that is simulated in this process; None: the robot isn't
            simulated here.
        leash: clock of a simulator in this process, which waits for this process; None: the controller
            doesn't wait.
        patient: True if the coordinator also runs while the controller isn't ready (`Coordinator`).
        unattended: True if nobody is there to resume after a hold that no user has ordered
            (`Operation.unattended`).
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
    """Yield a coordinator that runs until the context ends.

    Args:
        robot: the robot.
        ground: settings of the coordinator.

    Raises:
        ControlError: another process on this computer controls the same controller.
        Trouble: the controller can't be reached, or isn't in the state that the robot needs (`NotReady`).
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
