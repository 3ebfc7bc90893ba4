"""`yarc exec`."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import SIM, Address, AddressType
from yarclang.cli.options import PositiveNumber, file_argument, planning_options, tm_option


@click.command("exec")
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
@click.option(
    "--times",
    type=click.IntRange(1),
    default=1,
    help="So many times, where the program ends where it starts.",
)
@click.option("--positions", is_flag=True, help="Tell where the robot is as well, 50 times a second.")
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
    """Run a program without a terminal: nobody is asked, and standard output has an event a line, as JSON.

    The last event is "ended"; its "status" is the exit status: 0 where the program came to its end, else 1. SIGTERM and SIGINT stop the robot on its path
    and end then; a terminal that is closed changes nothing. `yarc status`, hold, resume, override and stop work from other terminals.
    """
    if options["log"] and options["no_log"]:
        raise click.UsageError("--log and --no-log exclude each other")
    if options["rate"] and to is not None:
        raise click.UsageError("--rate is for the simulator: a controller's time can't be hurried")
    from yarclang.cli.executing import Lines, execute, findings_line, refused_line
    from yarclang.cli.loading import is_compiled, load
    from yarclang.runtime.performance import off_the_start

    if is_compiled(file) and (first or any(options[name] for name in ("start", "tm", "tolerance"))):
        raise click.UsageError(
            "--from, --start, --tm, --tolerance: only with the program itself, the .yarc file"
        )
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # a terminal that is closed is nothing
    lines = Lines()
    try:
        loaded, found = load(file, first, {**options, "step": False})
        if found:
            lines.say(findings_line(found))
        if loaded is None:
            lines.say(refused_line("the program has errors; nothing moved", "see the findings"))
            raise SystemExit(1)
        program = loaded.program
        if options["times"] > 1 and (off := off_the_start(program, program.end)):
            what = f"{program.name} doesn't end where it starts, so that it can't be repeated: {off.partition(': ')[2]}"
            lines.say(refused_line(what, "end it with a motion to its start"))
            raise SystemExit(1)
        from yarclang.cli.controllers import controller

        job = loaded.rest
        with controller(to, job.robot, job.start, options["rate"], tells=False) as address:
            raise SystemExit(execute(loaded, address, options, lines, own=to is None))
    finally:
        lines.close()
        signal.signal(signal.SIGHUP, before)
