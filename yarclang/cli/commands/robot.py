"""`yarc robot`."""

from __future__ import annotations

import click

from yarclang.cli.lazy import LazyGroup

_COMMANDS = {
    "check": "Check a robot, and list what is still to do.",
    "list": "List the robots of the standard library, or show some.",
    "new": "Make a robot's folder from a URDF.",
}


@click.command("robot", cls=LazyGroup, commands_by_section={"Commands": _COMMANDS}, prefix="robot_")
def command() -> None:
    """Make, check and list robots."""
