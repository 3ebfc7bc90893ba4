"""`yarc follow`."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import SIM, Address, AddressType
from yarclang.cli.controller_options import patience_option
from yarclang.cli.options import PositiveNumber, cell_option, robot_option


@click.command("follow")
@click.option(
    "--to",
    type=AddressType(),
    default=SIM,
    metavar="sim|tcp://HOST[:PORT]",
    help="The controller: a built-in simulator (default), or a Turbo PMAC's address.",
)
@click.option(
    "--unix",
    type=click.Path(),
    metavar="PATH",
    help=(
        "The Unix socket to listen on, for processes of this user (default: one in the user's runtime "
        "folder)."
    ),
)
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    help=(
        "Listen on this TCP port of this computer instead (0: any that is free). Masters must send the token."
    ),
)
@click.option(
    "--token-file",
    type=click.Path(path_type=Path),
    metavar="PATH",
    help=(
        "With --port: write the token to this file, which only this user can read, and not to standard "
        "output."
    ),
)
@click.option("--moving", default="TCP", help="The frame that poses and twists refer to (default: TCP).")
@click.option(
    "--speed",
    type=PositiveNumber("MM_S"),
    help="The largest speed of that frame, mm/s (default: the robot's, [jog] speed of its robot.toml).",
)
@cell_option
@click.option("--positions", is_flag=True, help="Report the robot's position as well, 50 times a second.")
@click.option(
    "--log",
    type=click.Path(path_type=Path),
    help="File for the run log (default: a new file in yarc-runs/).",
)
@click.option("--no-log", is_flag=True, help="Run without a log.")
@patience_option
@robot_option
def command(to: Address | None, robot: str | None, **options: Any) -> None:
    """Let another process steer the robot: joints, poses or velocities, one JSON object per line.

    docs/coordinator.md describes the lines. Each motion is proved before it is streamed. After 200 ms without
    a line the robot comes to rest. Standard output has one event per line; the first is "listening", with the
    socket, or with port and token. SIGTERM and SIGINT bring the robot to rest; then the command ends.
    """
    if options["log"] and options["no_log"]:
        raise click.UsageError("--log and --no-log exclude each other")
    if options["unix"] is not None and options["port"] is not None:
        raise click.UsageError("--unix and --port exclude each other")
    if options["token_file"] is not None and options["port"] is None:
        raise click.UsageError("--token-file needs --port: a Unix socket needs no token")
    from yarclang.cli.attaching import place_of, place_served, served_at
    from yarclang.cli.executing import Lines, findings_line, refused_line
    from yarclang.cli.following import follow
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.cells import session_cell
    from yarclang.pipeline.inputs import robot_for
    from yarclang.runtime.actions import Trouble

    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # ignore that the terminal is closed
    lines = Lines()
    try:
        found = robot_for(Path(), robot)
        if found.diagnostics:
            lines.say(findings_line(found.diagnostics))
        if (whose := found.value) is None:
            lines.say(refused_line("the robot can't be read; nothing moved", "see the findings"))
            raise SystemExit(1)
        if (served := served_at(to, lambda: whose)) is not None:
            raise SystemExit(follow(whose, place_served(served, whose, options), options, lines))
        around = session_cell(Path(), whose, options["cell"])
        if around.diagnostics:
            lines.say(findings_line(around.diagnostics))
        if has_errors(around.diagnostics):
            lines.say(refused_line("the cell can't be used; nothing moved", "see the findings"))
            raise SystemExit(1)
        with place_of(to, whose, whose.home, tells=False) as place:
            raise SystemExit(follow(whose, place, options, lines))
    except Trouble as trouble:
        lines.say(refused_line(trouble.what, trouble.remedy, trouble.code))
        raise SystemExit(1) from None
    finally:
        lines.close()
        signal.signal(signal.SIGHUP, before)
