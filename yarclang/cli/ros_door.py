"""Implement `yarc ros` on the terminal: its start and end, and its output."""

from __future__ import annotations

from typing import Any

import click

from yarclang.cli.attaching import Place, check_cell, reached
from yarclang.cli.terminations import terminations
from yarclang.robot.model import Robot
from yarclang.ros import serving
from yarclang.ros.simple_message import ByteOrder


async def ros_door(robot: Robot, place: Place, options: dict[str, Any]) -> None:
    """Serve a ROS client until a termination (SIGTERM or SIGINT). Then bring the robot to rest on its path.

    Args:
        robot: the robot that is served.
        place: controller or running coordinator of the robot.
        options: options of the command line.

    Raises:
        Trouble: the coordinator can't be reached, or a port is in use.
    """
    with terminations() as ends:
        async with reached(place, robot, options, what="ros", patient=True) as attach:
            if place.served is not None and options["cell"] is not None:
                looking = await attach("looking")
                check_cell(looking, options["cell"])
                await looking.leave()
            motion, state = options["ports"]
            async with serving.served(
                robot,
                attach,
                serving.Place(options["host"].strip(), motion, state),
                click.echo,
                order=ByteOrder.BIG if options["swap_bytes"] else ByteOrder.LITTLE,
                hold_on_disconnect=options["hold_on_disconnect"],
            ) as ports:
                click.echo(
                    f"the ROS door of {robot.name} at {place}: motion link on port {ports[0]}, state link "
                    f"on port {ports[1]}"
                )
                click.echo(f"controller_joint_names: [{', '.join(robot.joint_names)}]")
                await ends.wait()
