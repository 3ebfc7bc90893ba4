"""`yarc run`."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import SIM, Address, AddressType
from yarclang.cli.options import PositiveNumber, file_argument, planning_options, tm_option


@click.command("run")
@file_argument("file", metavar="FILE.yarc|FILE.pmc")
@click.option(
    "--to",
    type=AddressType(),
    default=SIM,
    metavar="sim|tcp://HOST[:PORT]",
    help="The controller: a simulator of our own (default), or a Turbo PMAC's address.",
)
@click.option(
    "--approach", is_flag=True, help="Move slowly to the program's start first, if the robot isn't there."
)
@click.option(
    "--from", "first", metavar="P0010", help="Begin at this command; the way to its start is planned."
)
@click.option("--step", is_flag=True, help="Pause behind each command; Enter or `yarc resume` goes on.")
@click.option("--loop", is_flag=True, help="Again and again, where the program ends where it starts.")
@click.option("--times", type=click.IntRange(1), help="As --loop, so many times.")
@click.option("--dry-run", is_flag=True, help="Look at everything, move nothing.")
@click.option("--yes", "-y", is_flag=True, help="Don't ask before an approach.")
@click.option(
    "--log",
    type=click.Path(path_type=Path),
    help="Where to write the run log (default: a new file in yarc-runs/).",
)
@click.option("--no-log", is_flag=True, help="Run without a log.")
@click.option(
    "--rate", type=PositiveNumber("N"), help="How fast the simulator's time passes (default: real time)."
)
@planning_options
@tm_option
def command(file: str, to: Address | None, first: str | None, **options: Any) -> None:
    """Run a program on a controller: compile it, look at the controller, stream, and watch until the robot stands.

    Ctrl-C holds on the path, a second one aborts. Without --to the robot is simulated, and stands where the program starts.
    """
    from yarclang.cli.loading import is_compiled, load
    from yarclang.cli.show import show_findings

    _check_usage(to, options)
    if is_compiled(file):
        _check_compiled_usage(first, options)
    loaded, diagnostics = load(file, first, options)
    show_findings(diagnostics)
    if loaded is None:
        raise SystemExit(1)
    from yarclang.cli.controllers import controller
    from yarclang.cli.performing import perform_run

    job = loaded.rest
    with controller(to, job.robot, job.start, options["rate"]) as address:
        raise SystemExit(perform_run(loaded, address, options, _again(file, to, options)))


def _check_usage(to: Address | None, options: dict[str, Any]) -> None:
    if options["log"] and options["no_log"]:
        raise click.UsageError("--log and --no-log exclude each other")
    if options["rate"] and to is not None:
        raise click.UsageError("--rate is for the simulator: a controller's time can't be hurried")
    if options["step"] and (options["loop"] or options["times"]):
        raise click.UsageError(f"--step and --{'loop' if options['loop'] else 'times'} exclude each other")
    if options["loop"] and options["times"]:
        raise click.UsageError("--loop and --times exclude each other")


def _check_compiled_usage(first: str | None, options: dict[str, Any]) -> None:
    given = {"from": first, **{name: options[name] for name in ("step", "start", "tm", "tolerance")}}
    if names := [f"--{name}" for name, value in given.items() if value]:
        raise click.UsageError(f"{', '.join(names)}: only with the program itself, the .yarc file")


def _again(file: str, to: Address | None, options: dict[str, Any]) -> str | None:
    """The command line without what is for one run only; empty for standard input, None for a simulator of our own."""
    if to is None:
        return None
    if file == "-":
        return ""
    words = ["yarc", "run", file, "--to", str(to)]
    for name in ("robot", "start", "tolerance", "tm"):
        if (value := options[name]) is not None:
            numbers = value if isinstance(value, tuple) else (value,)
            words += [f"--{name}", ",".join(f"{one:g}" if isinstance(one, float) else one for one in numbers)]
    return shlex.join(words)
