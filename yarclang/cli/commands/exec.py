"""`yarc exec`."""

from __future__ import annotations

import signal
from typing import Any

import click

from yarclang.cli.address import Address
from yarclang.cli.controller_options import check_controller_usage, log_options, run_options
from yarclang.cli.options import planning_options, tm_option


@click.command("exec")
@run_options
@click.option(
    "--times",
    type=click.IntRange(1),
    default=1,
    help="So many times, where the program ends where it starts.",
)
@click.option("--positions", is_flag=True, help="Tell where the robot is as well, 50 times a second.")
@log_options
@planning_options
@tm_option
def command(file: str, to: Address | None, first: str | None, **options: Any) -> None:
    """Run a program without a terminal: nobody is asked, and standard output has an event a line, as JSON.

    The last event is "ended"; its "status" is the exit status: 0 where the program came to its end, else 1. SIGTERM and SIGINT stop the robot on its path
    and end then; a terminal that is closed changes nothing. `yarc status`, hold, resume, override and stop work from other terminals.
    """
    check_controller_usage(to, options)
    from yarclang.cli.executing import Lines, execute, findings_line, refused_line
    from yarclang.cli.loading import is_compiled, load
    from yarclang.report.cell import cell_text
    from yarclang.runtime.actions import Trouble
    from yarclang.runtime.rest import off_the_start

    if is_compiled(file) and (first or any(options[name] for name in ("start", "tm"))):
        raise click.UsageError("--from, --start, --tm: only with the program itself, the .yarc file")
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # a terminal that is closed is nothing
    lines = Lines()
    try:
        loaded, found = load(file, first, {**options, "step": False})
        if found:
            lines.say(findings_line(found))
        if loaded is None:
            lines.say(refused_line("the program has errors; nothing moved", "see the findings"))
            raise SystemExit(1)
        if loaded.around is not None:
            lines.say({"event": "message", "text": cell_text(loaded.around), "warning": False})
        program = loaded.program
        if options["times"] > 1 and (off := off_the_start(program, program.end)):
            what = f"{program.name} doesn't end where it starts, so that it can't be repeated: {off.partition(': ')[2]}"
            lines.say(refused_line(what, "end it with a motion to its start"))
            raise SystemExit(1)
        from yarclang.cli.controllers import controller

        job = loaded.rest
        with controller(to, job.robot, job.start, options["rate"], tells=False) as address:
            raise SystemExit(execute(loaded, address, options, lines, own=to is None))
    except Trouble as trouble:
        lines.say(refused_line(trouble.what, trouble.remedy, trouble.code))
        raise SystemExit(1) from None
    finally:
        lines.close()
        signal.signal(signal.SIGHUP, before)
