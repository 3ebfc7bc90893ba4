"""`yarc run`."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.controller_options import check_controller_usage, motion_options, run_options
from yarclang.cli.options import planning_options, tm_option

if TYPE_CHECKING:
    from yarclang.coordinator.loading import Source


@click.command("run")
@run_options
@click.option("--step", is_flag=True, help="Pause after each command; continue with Enter or `yarc resume`.")
@click.option("--loop", is_flag=True, help="Repeat without end; the program must end where it starts.")
@click.option("--times", type=click.IntRange(1), help="Repeat N times, as --loop.")
@click.option(
    "--job",
    type=click.IntRange(0),
    metavar="N",
    help="FILE is a project's folder: run the program that its yarc.toml lists as job N.",
)
@click.option(
    "--recover",
    is_flag=True,
    help=(
        "Only move slowly from the robot's position to the program's start, or to the nearest place at "
        "which it may begin."
    ),
)
@click.option("--dry-run", is_flag=True, help="Run all checks without moving.")
@click.option(
    "--yes", "-y", is_flag=True, help="Don't ask for confirmation before an approach or a recovery."
)
@motion_options
@planning_options
@tm_option
def command(file: str, to: Address | None, first: str | None, job: int | None, **options: Any) -> None:
    """Run a program on a controller: compile it, check the controller, stream, and watch until the robot
    stands.

    Ctrl-C holds on the path, a second one aborts. Without --to the robot is simulated, and stands where the
    program starts.
    """
    from yarclang.cli.loading import load, source_of
    from yarclang.cli.show import show_findings, show_without_notes
    from yarclang.pipeline.controller_text import is_compiled
    from yarclang.report.cell import cell_text

    _check_usage(to, options)
    if job is not None:
        from yarclang.cli.commands.jobs import file_of_job

        file = file_of_job(file, job)
    if is_compiled(file):
        _check_compiled_usage(first, options)
    source = source_of(file, first, options)
    if (status := _served(source, to, options)) is not None:
        raise SystemExit(status)
    if options["step"] and to is None:
        from yarclang.cli.terminal import has_keys

        if not has_keys():
            raise click.UsageError(
                "--step waits for Enter after each command, and standard input isn't a terminal; leave "
                "--step out, or use `yarc sim` and --to, and continue with `yarc resume`"
            )
    loaded, diagnostics = load(source)
    if is_compiled(file):
        show_findings(diagnostics)
    else:
        show_without_notes(diagnostics, file)
    if loaded is None:
        raise SystemExit(1)
    if loaded.around is not None:
        click.echo(cell_text(loaded.around.source.name), err=True)
    from yarclang.cli.attaching import place_of
    from yarclang.cli.controllers import robot_argument
    from yarclang.cli.running import Wanted, run_program
    from yarclang.cli.surroundings import surroundings_of
    from yarclang.simulated_cell.script import known_in

    rest = loaded.rest
    known = known_in(loaded.origins().program, loaded.around, rest.robot.controller.signal)
    around = surroundings_of(options, known, rest.robot, loaded.around, waits=True)
    show_findings(around.diagnostics)
    if around.value is None:
        raise SystemExit(1)
    with (
        trouble_is_said(),
        place_of(to, rest.robot, rest.start, options["rate"], surroundings=around.value) as place,
    ):
        where = f"--to {place.address} --robot {robot_argument(rest.robot, options['robot'])}"
        wanted = Wanted(loaded, None, rest.robot, loaded.name, where, _again(file, to, options))
        raise SystemExit(run_program(wanted, place, options))


def _served(source: Source, to: Address | None, options: dict[str, Any]) -> int | None:
    """Run a program on a robot that a running coordinator serves, and return the exit status; None if no
    coordinator serves the robot.
    """
    from yarclang.cli.attaching import place_served, served_at
    from yarclang.cli.loading import load_order, robot_of

    with trouble_is_said():
        served = served_at(to, lambda: robot_of(source))
        if served is None:
            return None
        from yarclang.cli.running import Wanted, run_program

        robot = robot_of(source)
        place = place_served(served, robot, options)
        click.echo(f"{served.run.name} serves the robot", err=True)
        where = f"--to {place.address} --robot {shlex.quote(options['robot'] or served.run.robot)}"
        wanted = Wanted(
            None,
            load_order(source, recover=options["recover"]),
            None,
            source.name,
            where,
            _again(source.file, place.address, options),
        )
        return run_program(wanted, place, options)
    return 1


def _check_usage(to: Address | None, options: dict[str, Any]) -> None:
    check_controller_usage(to, options)
    if options["step"] and (options["loop"] or options["times"]):
        raise click.UsageError(f"--step and --{'loop' if options['loop'] else 'times'} exclude each other")
    if options["recover"] and (
        names := [f"--{name}" for name in ("step", "loop", "times", "approach") if options[name]]
    ):
        raise click.UsageError(
            f"--recover and {', '.join(names)} exclude each other: a recovery doesn't run the program"
        )
    if options["loop"] and options["times"]:
        raise click.UsageError("--loop and --times exclude each other")


def _check_compiled_usage(first: str | None, options: dict[str, Any]) -> None:
    given = {"from": first, **{name: options[name] for name in ("step", "start", "tm")}}
    if names := [f"--{name}" for name, value in given.items() if value]:
        raise click.UsageError(f"{', '.join(names)}: only with the program itself, the .yarc file")


def _again(file: str, to: Address | None, options: dict[str, Any]) -> str:
    """Return the command line without the options that apply to a single run, for running the program again;
    empty for standard input.
    """
    if file == "-":
        return ""
    words = ["yarc", "run", file, *(["--to", str(to)] if to is not None else [])]
    for name in ("robot", "cell", "start", "tolerance", "tm"):
        if (value := options[name]) is not None:
            numbers = value if isinstance(value, tuple) else (value,)
            words += [f"--{name}", ",".join(f"{one:g}" if isinstance(one, float) else one for one in numbers)]
    if to is None:  # the next simulator gets machines with the same behaviour
        words += [word for one in options["set"] for word in ("--set", one)]
        words += ["--inputs", options["inputs"]] if options["inputs"] else []
    return shlex.join(words)
