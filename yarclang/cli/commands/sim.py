"""`yarc sim`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.controller_options import inputs_option
from yarclang.cli.options import cell_option, complete_robots
from yarclang.cli.parameter import ParamType

if TYPE_CHECKING:
    from yarclang.backend import Backend, Bench, Server
    from yarclang.robot.model import Robot
    from yarclang.simulated_cell.playing import SimulatedCell


_LOOK = 0.2
"""Time between two checks for words that the simulator doesn't simulate [s]."""


class _Rate(ParamType[float | None]):
    """Parser of the speed of time: real, max, or a number. Returns None for max."""

    name = "real|N|max"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float | None:
        if not isinstance(value, str):
            return value  # type: ignore[no-any-return]  # converted already
        word = value.lower()
        if word == "max":
            return None
        if word == "real":
            return 1.0
        try:
            rate = float(value)
        except ValueError:
            rate = math.nan
        if not 0.0 < rate < math.inf:
            self.fail(f"{value!r} must be real, max or a positive number", param, ctx)
        return rate


class _Address(ParamType[str]):
    """Parser of an IP address or a host name on the command line. An empty text would mean all addresses, and
    is rejected.
    """

    name = "ADDRESS"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if not str(value).strip():
            self.fail("it is empty; use 0.0.0.0 for all addresses", param, ctx)
        return str(value).strip()


_FAULTS = """\b
Faults:
  drop@12.5       close all connections, 12.5 s after the start
  freeze@3:2      answer nothing from 3 s on, for 2 s (without :2 for ever)
  slow:0.02       each reply 0.02 s late; slow:0.005-0.02 by chance
  garble:0.001    one reply of 1000 has a wrong byte
  busy@4:1        answer lines with a NUL, and don't execute them, for 1 s
  reset@7         what $$$ does
  following@5:3   motor 3 is 100000 counts off; following@5:3,2500: 2500
  limit@5:2+      the positive limit switch of motor 2 is on; 2- the negative
  amplifier@6:1   the amplifier of motor 1 fails

Times are the machine's, in s. @line120 instead of one: when 120 program lines have been written (WRITEBUFFER). Switches stay
on and amplifiers stay bad until $$$.
"""  # noqa: E501


@click.command("sim", epilog=_FAULTS)
@click.option(
    "--robot",
    metavar="NAME|PATH",
    shell_complete=complete_robots,
    help="Start commissioned for this robot: its settings loaded and saved, motors homed and "
    "closed-loop, at HOME (default: a bare controller as after $$$***).",
)
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=1025,
    show_default=True,
    help="TCP port; 0 takes a free one.",
)
@click.option(
    "--host",
    type=_Address(),
    default="127.0.0.1",
    show_default=True,
    help="Address to listen on. Addresses other than loopback are reachable over the network.",
)
@click.option(
    "--rate",
    type=_Rate(),
    metavar="real|N|max",
    default="real",
    show_default=True,
    help=(
        "Speed of the simulated time: real time, N times as fast (if the computer can), or as fast as "
        "possible. `yarc "
        "run --to` needs real time."
    ),
)
@click.option(
    "--fault",
    "faults",
    metavar="FAULT",
    multiple=True,
    help="A fault and its start time: see below. May be given several times.",
)
@cell_option
@inputs_option
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of random faults.")
def command(
    robot: str | None,
    port: int,
    host: str,
    rate: float | None,
    faults: tuple[str, ...],
    seed: int,
    cell: str | None,
    inputs: str | None,
) -> None:
    """Simulate a Turbo PMAC on a TCP port until Ctrl-C.

    Standard error reports the begin of faults, and words of a program that aren't simulated.
    """
    import asyncio

    if cell is not None and robot is None:
        raise click.UsageError("--cell needs --robot: a cell belongs to a robot")
    bench, whose = _bench(robot)
    try:
        wrong = tuple(bench.fault(one) for one in faults)
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="'--fault'") from None
    around = None if inputs is None and cell is None else _around(robot, inputs, cell)
    server = bench.server(whose, around, host=host, port=port, rate=rate, faults=wrong, seed=seed, tell=_tell)
    what = bench.title if whose is None else f"{whose.name} at HOME"
    try:
        asyncio.run(_serve(server, what))
    except KeyboardInterrupt:
        click.echo("stopped", err=True)


def _tell(now: float, text: str) -> None:
    click.echo(f"{now:.3f} s: {text}", err=True)


def _bench(robot: str | None) -> tuple[Bench, Robot | None]:
    """Return the simulator to serve, and the robot whose settings it has."""
    from yarclang.backend import backend_called, backend_of
    from yarclang.cli.show import show_findings
    from yarclang.pipeline.inputs import named_robot
    from yarclang.pipeline.settings import settings_of
    from yarclang.robot.kinds import DEFAULT

    if robot is None:
        return _made(backend_called(DEFAULT)), None
    loaded = named_robot(Path(), robot)
    show_findings(loaded.diagnostics)
    if loaded.value is None:
        raise SystemExit(1)
    settings = settings_of(loaded.value)
    show_findings(settings.diagnostics)
    if settings.value is None:
        raise SystemExit(1)
    return _made(backend_of(loaded.value)), loaded.value


def _made(backend: Backend) -> Bench:
    if backend.bench is None:
        raise click.UsageError(
            f"{backend.kind.title} has no simulator with a TCP port: use `yarc run`, which simulates it"
        )
    return backend.bench()


def _around(robot: str | None, inputs: str | None, cell: str | None) -> SimulatedCell:
    """Return the machines around the simulated robot: those of a script, and the sensors of a cell. The
    script may use the cell's names.
    """
    from dataclasses import replace

    from yarclang.cli.show import show_findings
    from yarclang.cli.surroundings import surroundings_of
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.cells import session_cell
    from yarclang.pipeline.inputs import named_robot
    from yarclang.simulated_cell.script import Known, known_in

    known, whose, what = Known({}, {}), None, None
    if cell is not None:
        assert robot is not None  # --cell requires it
        whose = named_robot(Path(), robot).value
        assert whose is not None  # its settings were loaded
        around = session_cell(Path(), whose, cell)
        show_findings(around.diagnostics)
        if has_errors(around.diagnostics):
            raise SystemExit(1)
        what = around.value.loaded.value if around.value is not None else None
        known = known_in(None, what, whose.controller.signal)
    known = replace(known, has_places=False)
    made = surroundings_of({"set": (), "inputs": inputs}, known, whose, what, waits=False)
    show_findings(made.diagnostics)
    if made.value is None:
        raise SystemExit(1)
    return made.value


async def _serve(server: Server, what: str) -> None:
    import asyncio

    from yarclang.hosts import is_loopback

    try:
        await server.start()
    except OSError as error:
        raise click.ClickException(f"can't listen on {_place(server)}: {_reason(error)}") from None
    if not is_loopback(server.host):
        click.echo(
            f"warning: {server.host} can be reached over the network, and the protocol has no password: "
            "anyone there can give commands",
            err=True,
        )
    rate = "as fast as possible" if server.rate is None else f"{server.rate:g} times real time"
    if server.rate == 1.0:
        rate = "real time"
    click.echo(f"{what} listens on {_place(server)}, {rate}; Ctrl-C stops it")
    watching = asyncio.create_task(_watch(server))
    try:
        await server.serve()
    finally:
        watching.cancel()
        await server.close()


async def _watch(server: Server) -> None:
    """Report, once each, the words of a program that the simulator ignores or carries out differently from a
    controller.
    """
    import asyncio

    told: set[str] = set()
    while True:
        for text in [text for text in server.differences() if text not in told]:
            told.add(text)
            server.tell(text)
        await asyncio.sleep(_LOOK)


def _place(server: Server) -> str:
    """Format address and port."""
    host = f"[{server.host}]" if ":" in server.host else server.host
    return f"{host}:{server.port}"


def _reason(error: OSError) -> str:
    """Return the reason why the server can't listen on an address. The address, which asyncio adds to its
    message, is left out.
    """
    import os
    import socket

    if isinstance(error, socket.gaierror) or not error.errno:
        return (error.strerror or str(error)).lower()
    return os.strerror(error.errno).lower()
