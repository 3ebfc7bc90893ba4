"""Implement `yarc pendant`: where it is served, how it starts and ends, and its output on the terminal."""

from __future__ import annotations

import asyncio
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import click

from yarclang.cli.attaching import Place, check_cell, reached
from yarclang.cli.terminations import terminations
from yarclang.hosts import is_loopback
from yarclang.pendant.life import Life
from yarclang.pendant.serving import Place as Port
from yarclang.pendant.serving import served
from yarclang.pipeline.cells import session_cell
from yarclang.pipeline.inputs import robot_for
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.log import FOLDER


def check_usage(options: dict[str, Any]) -> None:
    """Reject options that exclude each other.

    Raises:
        click.UsageError: such options are given together.
    """
    certificate, key = options["tls_cert"], options["tls_key"]
    if (certificate is None) != (key is None):
        raise click.UsageError("--tls-cert and --tls-key belong together")
    if options["tls"] and certificate is not None:
        raise click.UsageError("--tls and --tls-cert exclude each other")
    if not options["host"].strip():
        raise click.UsageError("--host is empty; use 0.0.0.0 for all addresses")
    if not options["tls"] and certificate is None and not is_loopback(options["host"]):
        raise click.UsageError(
            f"{options['host']} is reachable from other computers, and passwords would be sent "
            "unencrypted: give --tls self-signed, or --tls-cert and --tls-key"
        )


@dataclass(frozen=True, slots=True)
class Again:
    """Request to restart the process, with `arguments` appended to its command line."""

    arguments: tuple[str, ...]


async def tablet(robot: Robot, place: Place, folder: Path, options: dict[str, Any]) -> Again | None:
    """Serve a pendant until a termination (SIGTERM or SIGINT), or until a user ends it on a page. Then bring
    the robot to rest on its path.

    Args:
        robot: robot that is served.
        place: controller or running coordinator of the robot.
        folder: folder of the project.
        options: options of the command line.

    Returns:
        The restart that a user has requested; None for none.

    Raises:
        Trouble: the coordinator can't be reached, the port is in use, or a file can't be used.
    """
    data = options["data"] or _state_folder()
    life = Life(lambda: _check_again(folder, place, options))
    with terminations() as ends:
        async with reached(place, robot, options, what="pendant", folder=folder, patient=True) as attach:
            if place.served is not None and options["cell"] is not None:
                looking = await attach("looking")
                check_cell(looking, options["cell"])
                await looking.leave()
            port, print_ = _port(options, data)
            database = data / "pendant.db"
            logs = None if options["no_log"] else (options["log"] or FOLDER).absolute()
            serving = served(robot, attach, folder, database, port, logs=logs, life=life)
            async with serving as (address, first):
                click.echo(f"the pendant of {robot.name} at {place}: {address}")
                if print_:
                    click.echo(f"SHA-256 fingerprint of its certificate: {print_}")
                if first:
                    click.echo(
                        "there is no user yet; open this link to create the first one: "
                        f"{address}#first={first}"
                    )
                waits = [asyncio.ensure_future(one) for one in (ends.wait(), life.ended())]
                await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
                for one in waits:
                    one.cancel()
    if life.wanted != "restart" or ends.is_set():
        return None
    # keep the port: open pages reconnect to it
    return Again(("--port", address.rstrip("/").rpartition(":")[2]))


def begin_again(again: Again) -> NoReturn:
    """Restart this process with the same command line. Connections and files must be closed first."""
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:], *again.arguments])


def _check_again(folder: Path, place: Place, options: dict[str, Any]) -> None:
    """Check, before a restart, that a new process with the same command line would start.

    Raises:
        Trouble: the new process wouldn't start. The message has the reason.
    """
    read = robot_for(folder.absolute(), options["robot"])
    cell = None if read.value is None else session_cell(folder, read.value, options["cell"])
    found = (*read.diagnostics, *(() if cell is None else cell.diagnostics))
    for one in found:
        if one.is_error:
            where = "" if one.source is None else f"{Path(one.source.name).name}: "
            what = f"a restarted pendant couldn't start: {where}{one.message}"
            raise Trouble(what, one.help or "correct it first", one.code)
    known = None if place.served is None else place.served.fingerprint
    if known is not None and read.value is not None and read.value.fingerprint != known:
        what = "robot.toml was changed, but `yarc serve` still uses the previous version"
        raise Trouble(what, "restart `yarc serve`, then the pendant", "Y1392")


def _port(options: dict[str, Any], data: Path) -> tuple[Port, str]:
    """Return the address to listen on, and the fingerprint of a self-signed certificate."""
    host, names = options["host"].strip(), frozenset(options["names"])
    if options["tls"] is None:
        return Port(host, options["port"], names, options["tls_cert"], options["tls_key"]), ""
    from yarclang.pendant.certificates import self_signed

    certificate, key, print_ = self_signed(data, names | {host})
    return Port(host, options["port"], names, certificate, key), print_


def _state_folder() -> Path:
    given = Path(os.environ.get("XDG_STATE_HOME", ""))
    return (given if given.is_absolute() else Path.home() / ".local" / "state") / "yarc" / "pendant"
