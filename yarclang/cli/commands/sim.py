"""`yarc sim`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from yarclang.simulator.faults import Fault
    from yarclang.simulator.machine import Machine
    from yarclang.simulator.server import SimulatorServer


class _Rate(click.ParamType[float | None]):
    """real, max, or a number: how fast time passes. None is max."""

    name = "real|N|max"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float | None:
        if not isinstance(value, str):
            return value  # type: ignore[no-any-return]  # converted already
        if value == "max":
            return None
        if value == "real":
            return 1.0
        from yarclang.cli.options import PositiveNumber

        return PositiveNumber("N").convert(value, param, ctx)


class _Fault(click.ParamType["Fault"]):
    """A fault in the syntax of yarclang.simulator.faults."""

    name = "FAULT"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Fault:
        from yarclang.simulator.faults import Fault, parse_fault

        if isinstance(value, Fault):
            return value
        try:
            return parse_fault(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)


@click.command("sim")
@click.option(
    "--robot",
    metavar="NAME|PATH",
    help="Start commissioned for this robot: its settings loaded, homed, standing at HOME "
    "(default: a bare controller as after $$$***).",
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
    default="127.0.0.1",
    show_default=True,
    help="Address to listen on. Others than loopback let the network in.",
)
@click.option(
    "--rate",
    type=_Rate(),
    metavar="real|N|max",
    default="real",
    show_default=True,
    help="How fast time passes: real time, N times as fast, or as fast as it goes.",
)
@click.option(
    "--fault",
    "faults",
    type=_Fault(),
    multiple=True,
    help="Something that goes wrong, such as drop@12.5, freeze@3:2, slow:0.02, garble:0.001, busy@4:1, reset@7, "
    "following@5:3, limit@5:2+, amplifier@6:1; the number behind @ is the machine's time in s, @line120 a number of "
    "program lines. May be given several times.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Of what faults do at random.")
def command(
    robot: str | None, port: int, host: str, rate: float | None, faults: tuple[Fault, ...], seed: int
) -> None:
    """Be a Turbo PMAC on a TCP port until Ctrl-C."""
    import asyncio

    from yarclang.simulator.server import SimulatorServer

    machine, what = _machine(robot)
    server = SimulatorServer(machine, host=host, port=port, rate=rate, faults=faults, seed=seed)
    try:
        asyncio.run(_serve(server, what))
    except KeyboardInterrupt:
        click.echo("stopped", err=True)


def _machine(robot: str | None) -> tuple[Machine, str]:
    """The machine to serve, and what it is."""
    from yarclang.simulator.machine import Machine

    if robot is None:
        return Machine(), "a bare Turbo PMAC"
    from yarclang.backend_pmac.settings import settings_text
    from yarclang.cli.show import show_findings
    from yarclang.robot.description import load_robot
    from yarclang.simulator.machine import commissioned

    loaded = load_robot(robot)
    show_findings(loaded.diagnostics)
    if loaded.value is None:
        raise SystemExit(1)
    return commissioned(loaded.value, settings_text(loaded.value)), f"{loaded.value.name} at HOME"


async def _serve(server: SimulatorServer, what: str) -> None:
    from yarclang.simulator.server import is_loopback

    try:
        await server.start()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise click.ClickException(f"can't listen on {server.host}:{server.port}: {reason}") from None
    if not is_loopback(server.host):
        click.echo(
            f"warning: {server.host} can be reached over the network, and the protocol has no password: "
            "anyone there can give commands",
            err=True,
        )
    rate = "as fast as it goes" if server.rate is None else f"{server.rate:g} times real time"
    if server.rate == 1.0:
        rate = "real time"
    click.echo(f"{what} listens on {server.host}:{server.port}, {rate}; Ctrl-C stops it")
    try:
        await server.serve()
    finally:
        await server.close()
