"""`yarc pendant`."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import click

from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.preparing import machines, prepared, session_options

_LIBRARIES = ("argon2", "cryptography", "starlette", "uvicorn", "websockets")


@click.command("pendant")
@session_options
@click.option(
    "--folder",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    default=Path(),
    help="The project: its programs, modules, cell and yarc.toml (default: the working directory).",
)
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    help="Address to listen on. Other addresses than loopback require TLS.",
)
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8080,
    show_default=True,
    help="TCP port; 0 takes a free one.",
)
@click.option(
    "--name",
    "names",
    multiple=True,
    help="Another host name under which browsers may reach this server. May be given several times.",
)
@click.option(
    "--tls",
    type=click.Choice(["self-signed"]),
    help="Make a self-signed certificate; its fingerprint is printed.",
)
@click.option(
    "--tls-cert", type=click.Path(dir_okay=False, path_type=Path), help="The certificate, in PEM form."
)
@click.option("--tls-key", type=click.Path(dir_okay=False, path_type=Path), help="Its key, in PEM form.")
@click.option(
    "--data",
    type=click.Path(file_okay=False, path_type=Path),
    help="Folder of users, sessions and the audit trail (default: yarc/pendant in the user's state folder).",
)
def command(to: Address | None, folder: Path, **options: Any) -> None:
    """Serve the pendant: pages for a browser or a tablet, to watch, run and jog a robot. Ctrl-C ends.

    The first start prints a link that makes the first user. Where `yarc serve` owns the robot, the pendant
    attaches to it. docs/pendant.md is a tour.
    """
    from importlib.util import find_spec

    if missing := [one for one in _LIBRARIES if find_spec(one) is None]:
        raise click.ClickException(
            f"yarc pendant needs {', '.join(missing)}: in the project's folder, pip install '.[pendant]' "
            "brings them"
        )
    from yarclang.cli.attaching import place_of, place_served, served_at
    from yarclang.cli.tablet import begin_again, check_usage, tablet

    check_usage(options)
    found = prepared(folder, to, options)
    robot = found.robot
    with trouble_is_said():
        if (served := served_at(to, lambda: robot)) is not None:
            again = asyncio.run(tablet(robot, place_served(served, robot, options), folder, options))
        else:
            around = machines(folder, robot, options)
            with place_of(to, robot, found.stands, options["rate"], surroundings=around) as place:
                again = asyncio.run(tablet(robot, place, folder, options))
    if again is not None:
        begin_again(again)
