"""Prepare commands that drive a robot for a session: load the robot, the initial position of a simulated
robot, the cell, and the machines around a simulated robot.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import click

from yarclang.cli.address import Address
from yarclang.cli.controller_options import check_controller_usage, controller_option, motion_options
from yarclang.cli.options import Numbers, cell_option, robot_option, tm_option
from yarclang.cli.show import show_findings
from yarclang.diagnostics import has_errors
from yarclang.robot.model import Array, Robot
from yarclang.simulated_cell.playing import SimulatedCell

F = TypeVar("F", bound=Callable[..., Any])


def session_options(function: F) -> F:
    """Add the options of a session: --robot, --to, --start, --cell, --log, --no-log, --patience, --rate,
    --set, --inputs and --tm.
    """
    for option in (
        tm_option,
        motion_options,
        cell_option,
        click.option(
            "--start",
            type=Numbers("Q1,Q2,..."),
            help="Start position of the simulated robot: deg, mm for prismatic joints (default: its home).",
        ),
        controller_option,
        robot_option,
    ):
        function = option(function)
    return function


@dataclass(frozen=True, slots=True)
class Prepared:
    """The robot of a session, and where it is at first if it is simulated.

    Attributes:
        robot: the robot.
        stands: (n,) initial position of a simulated robot [rad or m].
    """

    robot: Robot
    stands: Array


def prepared(folder: Path, to: Address | None, options: dict[str, Any]) -> Prepared:
    """Return the robot that a command line names. Findings are shown; with an error the exit status is 1.

    Args:
        folder: folder in which yarc.toml is looked for.
        to: address of the controller; None for a simulator.
        options: options of the command line.

    Raises:
        click.UsageError: options exclude each other.
    """
    from yarclang.pipeline.inputs import joint_position, robot_for

    check_controller_usage(to, options)
    if options["start"] and to is not None:
        raise click.UsageError("--start works only with the simulator: a real robot already has a position")
    found = robot_for(folder.absolute(), options["robot"])
    show_findings(found.diagnostics)
    if found.value is None:
        raise SystemExit(1)
    placed = joint_position(found.value, options["start"], "--start")
    show_findings(placed.diagnostics)
    if placed.value is None:
        raise SystemExit(1)
    return Prepared(found.value, placed.value)


def machines(folder: Path, robot: Robot, options: dict[str, Any]) -> SimulatedCell:
    """Return the machines around a simulated robot, from the options --set and --inputs and the session's
    cell. Findings are shown; with an error the exit status is 1.
    """
    from yarclang.cli.surroundings import surroundings_of
    from yarclang.pipeline.cells import session_cell
    from yarclang.simulated_cell.script import known_in

    around = session_cell(folder, robot, options["cell"])
    show_findings(around.diagnostics)
    if has_errors(around.diagnostics):
        raise SystemExit(1)
    cell = around.value.loaded.value if around.value is not None else None
    known = known_in(None, cell, robot.controller.signal)
    made = surroundings_of(options, known, robot, cell, waits=False)
    show_findings(made.diagnostics)
    if made.value is None:
        raise SystemExit(1)
    return made.value
