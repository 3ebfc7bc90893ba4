"""`yarc ros`."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.preparing import machines, prepared, session_options


@click.command("ros")
@session_options
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    help=(
        "Address to listen on. Anyone who reaches the ports can move the robot: simple_message has no "
        "passwords."
    ),
)
@click.option(
    "--port",
    "ports",
    type=click.IntRange(0, 65535),
    nargs=2,
    default=(11000, 11002),
    show_default=True,
    metavar="MOTION STATE",
    help="TCP ports of both links; 0 takes a free one.",
)
@click.option(
    "--swap-bytes", is_flag=True, help="Big-endian words, for the client nodes whose names end with _bswap."
)
@click.option(
    "--hold-on-disconnect",
    is_flag=True,
    help="Hold the robot on its path when the motion client disconnects; otherwise its goal goes on.",
)
def command(to: Address | None, **options: Any) -> None:
    """Let MoveIt move a robot: the controller's side of ROS-Industrial's stock client nodes (simple_message).
    Ctrl-C ends.

    Each goal is planned, proved and run as a program. Where `yarc serve` owns the robot, the door attaches to
    it. docs/ros.md has the rest.
    """
    from yarclang.cli.attaching import place_of, place_served, served_at
    from yarclang.cli.ros_door import ros_door

    found = prepared(Path(), to, options)
    robot = found.robot
    with trouble_is_said():
        if (served := served_at(to, lambda: robot)) is not None:
            asyncio.run(ros_door(robot, place_served(served, robot, options), options))
        else:
            around = machines(Path(), robot, options)
            with place_of(to, robot, found.stands, options["rate"], surroundings=around) as place:
                asyncio.run(ros_door(robot, place, options))
