"""Options of the commands that move a robot: the controller and the log."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from yarclang.cli.address import SIM, Address, AddressType
from yarclang.cli.options import PositiveNumber, file_argument
from yarclang.cli.parameter import ParamType

F = TypeVar("F", bound=Callable[..., Any])


_LEAST_PATIENCE, _MOST_PATIENCE = 0.1, 60.0
"""Bounds of --patience, the time without a message after which the controller holds [s]. With less, it would
hold at each short pause of a computer. With more, a robot whose computer has failed would move on for too
long.
"""


def controller_option(function: F) -> F:
    """Add the option --to sim|tcp://HOST[:PORT]. Its value is None for a simulator that belongs to the
    command.
    """
    return click.option(
        "--to",
        type=AddressType(),
        default=SIM,
        metavar="sim|tcp://HOST[:PORT]",
        help="The controller: a built-in simulator (default), or a Turbo PMAC's address.",
    )(function)


def patience_option(function: F) -> F:
    """Add --patience S."""
    return click.option(
        "--patience",
        type=PositiveNumber("S", _LEAST_PATIENCE, _MOST_PATIENCE),
        help="Longest silence of this computer and the link before the controller holds, s (default: 0.4, "
        "or what the link needs). If this computer fails, the robot keeps moving for this time.",
    )(function)


class _Setting(ParamType[str]):
    """Parser of INPUT=VALUE. The input is resolved later, when the program is known."""

    name = "INPUT=VALUE"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the text itself. Text of another form is a usage error."""
        from yarclang.simulated_cell.script import check_setting

        try:
            check_setting(str(value))
        except ValueError as error:
            self.fail(str(error), param, ctx)
        return str(value)


def inputs_option(function: F) -> F:
    """Add --inputs SCRIPT.toml."""
    return click.option(
        "--inputs",
        type=click.Path(dir_okay=False),
        metavar="SCRIPT.toml",
        help="Script of the inputs of a simulated robot (docs/language.md: Simulated inputs).",
    )(function)


def motion_options(function: F) -> F:
    """Add --log, --no-log, --patience, --rate, --set and --inputs."""
    for option in (
        inputs_option,
        click.option(
            "--set",
            "set",
            multiple=True,
            type=_Setting(),
            help=(
                "Initial value of an input of the simulated robot: ON, OFF or a number. May be given "
                "several times."
            ),
        ),
        click.option(
            "--rate",
            type=PositiveNumber("N"),
            help="Speed of the simulator's time (default: real time).",
        ),
        patience_option,
        click.option("--no-log", is_flag=True, help="Run without a log."),
        click.option(
            "--log",
            type=click.Path(path_type=Path),
            help="File for the run log (default: a new file in yarc-runs/).",
        ),
    ):
        function = option(function)
    return function


def run_options(function: F) -> F:
    """Add the argument for the program, and the options for the controller, the first command and the motion
    to it.
    """
    for option in (
        click.option(
            "--from",
            "first",
            metavar="P0010",
            help="Begin at this command; a motion to its start is planned.",
        ),
        click.option(
            "--approach",
            is_flag=True,
            help="If the robot isn't at the program's start, move there slowly first.",
        ),
        click.option(
            "--source",
            type=click.Path(dir_okay=False),
            metavar="FILE.yarc",
            help=(
                "For a .pmc: the program to prove it against (default: the program beside it, if there is "
                "one)."
            ),
        ),
        controller_option,
        file_argument("file", metavar="FILE.yarc|FILE.pmc"),
    ):
        function = option(function)
    return function


def check_controller_usage(to: Address | None, options: dict[str, Any]) -> None:
    """Reject options that exclude each other."""
    if options["log"] and options["no_log"]:
        raise click.UsageError("--log and --no-log exclude each other")
    if options["rate"] and to is not None:
        raise click.UsageError("--rate works only with the simulator: a controller runs in real time")
    for name in ("set", "inputs"):
        if options[name] and to is not None:
            raise click.UsageError(
                f"--{name} is for a simulated robot: the inputs of a controller are set by the connected "
                "devices"
            )
