"""Connect a command to its robot, through a running coordinator (the process that drives the robot,
`yarc serve`), or through one that the command starts in its own process.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import Address
from yarclang.cli.controllers import SIMULATED_REPLY_TIME, controller
from yarclang.cli.table import checked_table
from yarclang.cli.terminal import has_keys
from yarclang.client import Gone, Refused
from yarclang.client import Robot as Asked
from yarclang.coordinator.attached import Attached, Here, There
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.opened import Ground, opened
from yarclang.pipeline.cells import is_same_file
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.session import REPLY_TIME
from yarclang.runtime.transports.runs import Run, find_runs, run_on

if TYPE_CHECKING:
    from yarclang.simulated_cell.playing import SimulatedCell

_ALONE = ("run", "exec")
"""Commands that run one program and then end. All other commands that drive a robot wait for orders of users.
"""

_QUICK = 1.5
"""Longest wait for a coordinator's greeting [s]. A coordinator that takes longer is not used."""


@dataclass(frozen=True, slots=True)
class Served:
    """A running coordinator that serves a robot (`yarc serve`).

    Attributes:
        run: the coordinator's entry among the runs on this computer.
        fingerprint: fingerprint of the robot.
        controller: address of the robot's controller.
        simulated: True if the controller is simulated.
    """

    run: Run
    fingerprint: str
    controller: str
    simulated: bool


@dataclass(frozen=True, slots=True)
class Place:
    """The controller or the running coordinator through which a command drives its robot.

    Attributes:
        address: address of the controller.
        served: the running coordinator; None if the command starts its own coordinator.
        own: True if the controller is a simulator that exists only as long as the command runs.
        surroundings: the simulated machines around the robot, if `own` is True.
    """

    address: Address
    served: Served | None = None
    own: bool = False
    surroundings: SimulatedCell | None = None

    def __str__(self) -> str:
        """Format the place for people."""
        return str(self.address) if self.served is None else f"{self.served.run.name}, which serves it"


def served_at(to: Address | None, robot: Callable[[], Robot | None]) -> Served | None:
    """Find a running coordinator that serves a robot.

    Without an address only simulated robots are considered, so that no real robot moves.

    Args:
        to: address of the controller; None for a simulator.
        robot: function that returns the wanted robot. It is called only if a coordinator serves a simulated
            robot.
    """
    if to is not None:
        run = run_on(to.host, to.port)
        return None if run is None else _served(run)
    found = [one for run in find_runs() if (one := _served(run)) is not None and one.simulated]
    if not found:
        return None
    wanted = robot()
    return next((one for one in found if wanted is not None and one.fingerprint == wanted.fingerprint), None)


def _served(run: Run) -> Served | None:
    """Return the coordinator of a run; None if it doesn't answer, or doesn't serve other clients."""
    try:
        with Asked(str(run.path), name="looking", timeout=_QUICK) as robot:
            told = robot.welcome
    except (Gone, Refused, TimeoutError):  # a process that hangs doesn't serve
        return None
    if not told["serves"]:
        return None
    return Served(run, str(told["fingerprint"]), str(told["status"]["controller"]), bool(told["simulated"]))


@contextlib.contextmanager
def place_of(
    to: Address | None,
    robot: Robot,
    stands: Array,
    rate: float | None = None,
    *,
    tells: bool = True,
    surroundings: SimulatedCell | None = None,
) -> Iterator[Place]:
    """Yield the Place for a command that starts its own coordinator. The arguments are those of
    `controller`.
    """
    from yarclang.simulated_cell.playing import SimulatedCell

    around = (surroundings or SimulatedCell()) if to is None else None
    with controller(to, robot, stands, rate, tells=tells, surroundings=around) as address:
        yield Place(address, own=to is None, surroundings=around)


def place_served(served: Served, robot: Robot | None, options: dict[str, Any]) -> Place:
    """Return the Place for a command that uses a running coordinator.

    Raises:
        Trouble: the coordinator serves another robot.
        click.UsageError: an option works only with a coordinator that the command starts itself.
    """
    for name in ("log", "no_log", "rate", "patience", "set", "inputs"):
        if options.get(name):
            option = name.replace("_", "-")
            raise click.UsageError(
                f"--{option}: {served.run.name} serves this robot; set it when starting `yarc serve`"
            )
    if robot is not None and robot.fingerprint != served.fingerprint:
        raise Trouble(
            f"{served.run.name} serves another robot than {robot.name} as described here",
            "stop it, or name its robot",
            "Y1392",
        )
    host, _, port = served.controller.rpartition(":")
    return Place(Address(host, int(port)), served)


def check_cell(robot: Attached, named: str) -> None:
    """Check that a running coordinator uses the cell that the command line names.

    Raises:
        Trouble: the coordinator uses another cell, or none.
    """
    known = robot.welcome.status.cell
    if known is None or not is_same_file(Path(known), Path(named)):
        what = f"the command line gives the cell {named}, the robot is served with {known or 'none'}"
        raise Trouble(what, "leave --cell out, or serve the robot with this cell", "Y1373")


Attach = Callable[[str], Awaitable[Attached]]
"""Function that connects a new client to a coordinator, and returns it. Its argument is the name that other
clients see.
"""


@asynccontextmanager
async def attached(
    place: Place,
    robot: Robot | None,
    name: str,
    options: dict[str, Any],
    *,
    what: str,
    folder: Path | None = None,
) -> AsyncIterator[Attached]:
    """Connect a client to a robot's coordinator, and yield it. It is disconnected at the end of the context.

    Args:
        place: controller or running coordinator to use.
        robot: robot of the controller; None with a running coordinator, which knows its robot.
        name: name of the client that other clients see.
        options: options of the command line.
        what: text that `yarc status` shows while nothing is running.
        folder: folder in which modules, cells and yarc.toml are looked for; None for the working directory.

    Raises:
        ControlError: another process of this computer drives the controller.
        Trouble: the controller can't be reached, or doesn't fit the robot (`NotReady`).
    """
    async with reached(place, robot, options, what=what, folder=folder, door=name) as attach:
        one = await attach(name)
        try:
            yield one
        finally:
            if place.served is not None:  # clients in this process end with their coordinator
                await one.leave()


def _attaching(served: Served, address: Address, robot: Robot | None) -> Attach:
    """Return a function that connects clients to a running coordinator. If this coordinator has ended, the
    function uses the coordinator that serves the same robot now.
    """
    known = served

    async def there(name: str) -> Attached:
        nonlocal known
        try:
            return await There.attach(known.run.path, name)
        except Trouble:
            again = await asyncio.to_thread(served_at, None if served.simulated else address, lambda: robot)
            if again is None or again.fingerprint != served.fingerprint:
                raise
            known = again
            return await There.attach(known.run.path, name)

    return there


def tell_whether_ready(coordinator: Coordinator) -> None:
    """Report on the terminal why a connected robot can't move."""
    if coordinator.engine.lost:
        click.echo(f"no connection yet: {coordinator.engine.lost}; retrying", err=True)
    elif coordinator.inspection is not None and coordinator.inspection.errors:
        click.echo(checked_table(coordinator.inspection.errors), err=True)
        click.echo("the robot isn't ready; it can't move until these checks pass", err=True)


@asynccontextmanager
async def reached(
    place: Place,
    robot: Robot | None,
    options: dict[str, Any],
    *,
    what: str,
    folder: Path | None = None,
    door: str = "",
    patient: bool = False,
) -> AsyncIterator[Attach]:
    """Yield a function that connects clients to a robot's coordinator, as `attached` does. The caller
    disconnects each client.

    Args:
        place: controller or running coordinator to use.
        robot: robot of the controller; None with a running coordinator.
        options: options of the command line.
        what: text that `yarc status` shows while nothing is running.
        folder: folder in which modules, cells and yarc.toml are looked for; None for the working directory.
        door: kind of command to which the clients belong.
        patient: True to start a coordinator even if its controller isn't ready.
    """
    if place.served is not None:
        yield _attaching(place.served, place.address, robot)
        return
    assert robot is not None  # the command starts a coordinator, for which it knows the robot
    address = place.address
    ground = Ground(
        address.host,
        address.port,
        Path() if folder is None else folder,
        what,
        tm=options.get("tm"),
        cell=options.get("cell"),
        log=NO_LOG if options["no_log"] else options["log"],
        reply_time=SIMULATED_REPLY_TIME if place.own else REPLY_TIME,
        pace=options.get("rate") or 1.0,
        patience=options.get("patience"),
        simulated=place.own,
        surroundings=place.surroundings,
        leash=address.leash,
        patient=patient,
        unattended=place.own and door in _ALONE and not has_keys(),
    )
    async with opened(robot, ground) as coordinator:
        if patient:
            tell_whether_ready(coordinator)

        async def here(name: str) -> Attached:
            return Here(coordinator, name)

        yield here
