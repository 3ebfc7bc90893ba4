"""`yarc status`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import (
    Address,
    check_controller_options,
    controller_options,
    run_option,
    trouble_is_said,
)

if TYPE_CHECKING:
    from yarclang.robot.model import Robot
    from yarclang.runtime.scripts import Picture

_LEAST_WIDTH = 11


@click.command("status")
@run_option
@controller_options
@click.option(
    "--format",
    "format_",
    type=click.Choice(["text", "json"]),
    default="text",
    help="Output format.",
)
def command(run: str | None, to: Address | None, robot: str | None, format_: str) -> None:
    """Print the state of a run. With --to and --robot: ask a controller for its state, without changing
    anything.
    """
    check_controller_options(to, robot, run)
    with trouble_is_said():
        from yarclang.cli.ordering import status_of
        from yarclang.runtime.transports.runs import the_run

        if to is not None and robot is not None:
            picture = _ask_controller(to, robot)
            content = {"controller": str(to), **asdict(picture)}
            del content["guard_text"]
            lines = _picture_lines(picture, str(to))
        else:
            told = status_of(the_run(run))
            status = {key: value for key, value in told.items() if key not in ("ok", "id")}
            content, lines = status, _status_lines(status)
    if format_ == "json":
        import json

        click.echo(json.dumps(content, indent=2, ensure_ascii=False))
    else:
        click.echo(_columns(list(lines)))


def _columns(lines: list[tuple[str, str]]) -> str:
    """Return pairs of a title and a text as lines with two columns, which are aligned for any length of
    joint names.
    """
    width = max(_LEAST_WIDTH, *(len(title) for title, _ in lines))
    return "\n".join(f"{title:<{width}} {text}" for title, text in lines)


def _status_lines(status: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the lines that describe a run's status to people."""
    yield "program", status["program"]
    yield "robot", f"{status['robot']} at {status['controller']}"
    yield "state", f"{status['state']}: {status['why']}" if status["why"] else status["state"]
    if status["command"] is not None:
        yield "command", f"{status['command']['title']}, line {status['command']['line']}"
    yield "time", f"{status['done']:.1f} s done, {status['left']:.1f} s left"
    yield "override", f"{status['override']:g} %"
    for joint in status["joints"]:
        position = joint["position"]
        yield joint["name"], "not known yet" if position is None else f"{position:.3f} {joint['unit']}"
    if status.get("cell"):
        yield "cell", status["cell"]
    if others := [one for one in status.get("clients", ()) if one != status["owner"]]:
        watch = f"{', '.join(others)} watch{'es' if len(others) == 1 else ''}"
        yield "owner", f"{status['owner'] or 'nobody'}; {watch}"
    yield "run", f"process {status['pid']}, since {status['since']}"


def _ask_controller(to: Address, name: str) -> Picture:
    import asyncio

    from yarclang.cli.show import show_findings
    from yarclang.pipeline.inputs import named_robot
    from yarclang.runtime.transports.lock import holder_of
    from yarclang.runtime.transports.runs import run_on

    loaded = named_robot(Path(), name)
    show_findings(loaded.diagnostics)
    if loaded.value is None:
        raise SystemExit(1)
    if (run := run_on(to.host, to.port)) is not None:
        click.echo(f"{run.name} drives this controller: use `yarc status --run {run.name}`", err=True)
    elif (holder := holder_of(to.host, to.port)) is not None:
        click.echo(f"{holder} drives this controller", err=True)
    return asyncio.run(_look(to, loaded.value))


async def _look(to: Address, robot: Robot) -> Picture:
    from yarclang.runtime.scripts import scripts_of
    from yarclang.runtime.session import Session

    scripts = scripts_of(robot.controller.kind)
    session = Session(to.host, to.port, scripts=scripts)
    try:
        await session.perform(scripts.connect(session.operation))
        return await session.perform(scripts.picture(session.operation, robot))
    finally:
        session.close()


def _picture_lines(picture: Picture, address: str) -> Iterator[tuple[str, str]]:
    """Yield the lines that describe a controller's state to people."""
    yield "controller", f"{picture.kind}, firmware {picture.firmware}, at {address}"
    yield "program", picture.program
    yield "override", f"{picture.override:g} %"
    yield "guard", picture.guard_text
    for motor, words in picture.motors.items():
        yield f"motor {motor}", words
    for place in picture.joints:
        actual = "not known" if place.actual is None else f"{place.actual:.3f} {place.unit}"
        yield place.name, f"commanded {place.commanded:.3f} {place.unit}, actual {actual}"
