"""The controller that a command talks to: one with an address, or a simulator that lives as long as the command."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Iterator
from typing import TYPE_CHECKING

import click

from yarclang.cli.address import Address
from yarclang.robot.library import list_robots
from yarclang.robot.model import Array, Robot

if TYPE_CHECKING:
    from yarclang.simulated_cell.playing import SimulatedCell

SIMULATED_REPLY_TIME = 20.0
"""A simulator of our own isn't lost before [s]: where it is late, this computer has much to do."""


@contextlib.contextmanager
def controller(
    to: Address | None,
    robot: Robot,
    stands: Array,
    rate: float | None = None,
    *,
    tells: bool = True,
    surroundings: SimulatedCell | None = None,
) -> Iterator[Address]:
    """The address to talk to.

    Args:
        to: the controller that was named; None for a simulator.
        robot: that hangs on it.
        stands: (n,) where a simulated robot stands [rad or m].
        rate: how fast a simulator's time passes.
        tells: whether it is said that the robot is simulated.
        surroundings: the machines around a simulated robot.

    Raises:
        Trouble: the robot is simulated, and its controller's settings aren't proved.
    """
    if to is not None:
        yield to
        return
    from yarclang.backend import backend_of
    from yarclang.pipeline.settings import proved_settings

    proved_settings(robot)
    if tells:
        click.echo(f"{robot.name} is simulated", err=True)
    with backend_of(robot).simulated(robot, stands, rate or 1.0, surroundings) as simulator:
        yield Address("127.0.0.1", simulator.port, simulator.leash)


def robot_argument(robot: Robot, given: str | None) -> str:
    """What to write behind --robot: what was given, else the robot's name, else where it is."""
    if given is None and any(one.folder == robot.folder for one in list_robots()):
        return robot.name
    return shlex.quote(given or str(robot.folder))
