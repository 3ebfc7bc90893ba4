"""`yarc exec`."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import Address
from yarclang.cli.controller_options import check_controller_usage, motion_options, run_options
from yarclang.cli.options import planning_options, tm_option

if TYPE_CHECKING:
    from yarclang.cli.executing import Lines
    from yarclang.coordinator.loading import Source


@click.command("exec")
@run_options
@click.option(
    "--times",
    type=click.IntRange(1),
    default=1,
    help="Number of times; the program must end where it starts.",
)
@click.option("--positions", is_flag=True, help="Report the robot's position as well, 50 times a second.")
@motion_options
@planning_options
@tm_option
def command(file: str, to: Address | None, first: str | None, **options: Any) -> None:
    """Run a program without a terminal and without questions; standard output has one JSON event per line.

    The last event is "ended"; its "status" is the exit status: 0 if the program came to its end, else 1.
    SIGTERM and SIGINT stop the robot on its path and end the process; closing the terminal changes nothing.
    `yarc status`, hold, resume, override and stop work from other terminals.
    """
    check_controller_usage(to, options)
    from yarclang.cli.executing import Lines, execute, findings_line, not_repeated, refused_line
    from yarclang.cli.loading import load, source_of
    from yarclang.coordinator.describing import program_described
    from yarclang.pipeline.controller_text import is_compiled
    from yarclang.report.cell import cell_text
    from yarclang.runtime.actions import Trouble

    if is_compiled(file) and (first or any(options[name] for name in ("start", "tm"))):
        raise click.UsageError("--from, --start, --tm: only with the program itself, the .yarc file")
    source = source_of(file, first, options)
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # ignore that the terminal is closed
    lines = Lines()
    try:
        if (status := _served(source, to, options, lines)) is not None:
            raise SystemExit(status)
        loaded, found = load(source)
        if found:
            lines.say(findings_line(found))
        if loaded is None:
            lines.say(refused_line("the program has errors; nothing moved", "see the findings"))
            raise SystemExit(1)
        if loaded.around is not None:
            lines.say({"event": "message", "text": cell_text(loaded.around.source.name), "warning": False})
        if refused := not_repeated(program_described(0, loaded), options):
            lines.say(refused)
            raise SystemExit(1)
        from yarclang.cli.attaching import place_of
        from yarclang.cli.surroundings import surroundings_of
        from yarclang.simulated_cell.script import known_in

        job = loaded.rest
        known = known_in(loaded.origins().program, loaded.around, job.robot.controller.signal)
        around = surroundings_of(options, known, job.robot, loaded.around, waits=True)
        if around.value is None:
            lines.say(findings_line(around.diagnostics))
            lines.say(refused_line("the script of inputs can't be used; nothing moved", "see the findings"))
            raise SystemExit(1)
        with place_of(
            to, job.robot, job.start, options["rate"], tells=False, surroundings=around.value
        ) as place:
            raise SystemExit(execute(loaded, loaded.name, place, options, lines))
    except Trouble as trouble:
        lines.say(refused_line(trouble.what, trouble.remedy, trouble.code))
        raise SystemExit(1) from None
    finally:
        lines.close()
        signal.signal(signal.SIGHUP, before)


def _served(source: Source, to: Address | None, options: dict[str, Any], lines: Lines) -> int | None:
    """Run a program on a robot that a running coordinator serves, and return the exit status; None if no
    coordinator serves the robot.
    """
    from yarclang.cli.attaching import place_served, served_at
    from yarclang.cli.executing import execute
    from yarclang.cli.loading import load_order, robot_of

    served = served_at(to, lambda: robot_of(source))
    if served is None:
        return None
    place = place_served(served, robot_of(source), options)
    return execute(load_order(source), source.name, place, options, lines)
