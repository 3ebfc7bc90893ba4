"""Provide the controller that a command drives: one with an address, or a simulator that runs as long as
the command.
"""

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
"""Time without a reply after which a simulator in this process counts as lost [s]. It is long because the
computer may be busy.
"""


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
    """Yield the address of the controller that a command drives. Without an address, start a simulator for
    the context.

    Args:
        to: address on the command line; None for a simulator.
        robot: robot of the controller.
        stands: (n,) initial position of a simulated robot [rad or m].
        rate: simulated seconds per second of real time.
        tells: True to print that the robot is simulated.
        surroundings: the machines around a simulated robot.

    Raises:
        Trouble: the robot is simulated, and the settings of its controller aren't proved.
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
    """Return what a user writes after --robot: the value that was given, or else the robot's name or path."""
    if given is None and any(one.folder == robot.folder for one in list_robots()):
        return robot.name
    return shlex.quote(given or str(robot.folder))
