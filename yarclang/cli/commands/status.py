"""`yarc status`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
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
    from yarclang.runtime.actions import Script
    from yarclang.runtime.feedback import MotorStatus
    from yarclang.runtime.operation import Operation

_GUARD = {
    0.0: "not armed",
    1.0: "armed: it holds when the rotary buffer runs low",
    2.0: "it has held the motion: the rotary buffer had run low",
}


_LEAST_WIDTH = 11


@click.command("status")
@run_option
@controller_options
@click.option(
    "--format",
    "format_",
    type=click.Choice(["text", "json"]),
    default="text",
    help="How to write it.",
)
def command(run: str | None, to: Address | None, robot: str | None, format_: str) -> None:
    """Say how a run is going. With --to and --robot: ask a controller how it is, without changing anything."""
    check_controller_options(to, robot, run)
    with trouble_is_said():
        from yarclang.cli.ordering import status_of
        from yarclang.runtime.transports.runs import the_run

        if to is not None and robot is not None:
            picture = _ask_controller(to, robot)
            content, lines = asdict(picture), _picture_lines(picture)
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
    """Titles and texts in two columns, however long the names of joints are."""
    width = max(_LEAST_WIDTH, *(len(title) for title, _ in lines))
    return "\n".join(f"{title:<{width}} {text}" for title, text in lines)


def _status_lines(status: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """A run's status for people."""
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


@dataclass(frozen=True, slots=True)
class Place:
    """Where a joint is, in `unit`: `commanded`, and `actual` as PLC 0 reckons; None where it can't be asked."""

    name: str
    unit: str
    commanded: float
    actual: float | None


@dataclass(frozen=True, slots=True)
class Picture:
    """What a controller says of itself."""

    controller: str
    kind: str
    firmware: str
    program: str
    override: float
    guard: float
    motors: dict[int, str]
    joints: tuple[Place, ...]


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
        click.echo(f"{run.name} drives this controller: `yarc status --run {run.name}` tells more", err=True)
    elif (holder := holder_of(to.host, to.port)) is not None:
        click.echo(f"{holder} drives this controller", err=True)
    return asyncio.run(_look(to, loaded.value))


async def _look(to: Address, robot: Robot) -> Picture:
    from yarclang.runtime.performance import connect
    from yarclang.runtime.session import Session

    session = Session(to.host, to.port)
    try:
        await session.perform(connect(session.operation))
        return await session.perform(_picture(session.operation, robot, str(to)))
    finally:
        session.close()


def _picture(operation: Operation, robot: Robot, address: str) -> Script[Picture]:
    """Ask only what is never stored in a buffer: a run that was killed may have left its rotary open."""
    from yarclang.pmac.variables import ARMED
    from yarclang.runtime.rest import motor_statuses, system_words

    kind = yield from operation.one("TYPE")
    identity = yield from operation.one("CID")
    firmware = yield from operation.one("VERSION")
    system = yield from system_words(operation, robot)
    motors = yield from motor_statuses(operation, robot)
    number = robot.controller.coordinate_system
    (override,) = yield from operation.numbers(f"&{number}%", 1)
    (guard,) = yield from operation.numbers(ARMED, 1)
    if not system.running:
        program = f"none runs in coordinate system {number}"
    elif all(motor.at_rest for motor in motors):
        program = "one is in the middle, held or starved: `yarc stop --to ...` ends it"
    else:
        program = "one runs"
    words = {
        motor: _motor_words(status) for motor, status in zip(robot.controller.motors, motors, strict=True)
    }
    places = yield from _places(operation, robot)
    return Picture(
        address, f"{kind} (CID {identity})", firmware, program, round(override, 3), guard, words, places
    )


def _places(operation: Operation, robot: Robot) -> Script[tuple[Place, ...]]:
    """Where the joints are: by ^P and ^F, since M161 would go into an open buffer."""
    from yarclang.robot.actuation import from_counts
    from yarclang.runtime.actions import Lost
    from yarclang.runtime.feedback import ReportError, counts_in, groups_of, in_order
    from yarclang.runtime.operation import Refused

    motors = robot.controller.motors
    counts: dict[int, float] = {}
    for group in groups_of(motors):
        yield from operation.ask(f"##{group}")
        try:
            actual = counts_in((yield from operation.report("\x10")), group, motors)
            following = counts_in((yield from operation.report("\x06")), group, motors)
        except ReportError as error:
            raise Lost(str(error)) from None
        counts |= {motor: actual[motor] + following[motor] for motor in actual}
    commanded = from_counts(robot, in_order(counts, motors)) / robot.axis_units
    reckoned: tuple[float | None, ...]
    try:
        reckoned = yield from operation.numbers("".join(robot.controller.feedback), robot.size)
    except Refused:
        reckoned = (None,) * robot.size
    return tuple(
        Place(name, unit, round(float(one), 6), None if other is None else round(other, 6))
        for name, unit, one, other in zip(
            robot.joint_names, robot.axis_unit_names, commanded, reckoned, strict=True
        )
    )


def _motor_words(status: MotorStatus) -> str:
    """A motor's status words in plain language."""
    if trouble := status.trouble:
        return trouble
    words = ["closed-loop", "homed" if status.has("home complete") else "not homed"]
    words.append("at rest" if status.at_rest else "moves")
    if status.has("warning following error"):
        words.append("its following error is beyond Ixx12")
    return ", ".join(words)


def _picture_lines(picture: Picture) -> Iterator[tuple[str, str]]:
    """A controller's state for people."""
    yield "controller", f"{picture.kind}, firmware {picture.firmware}, at {picture.controller}"
    yield "program", picture.program
    yield "override", f"{picture.override:g} %"
    yield "guard", f"{_GUARD.get(picture.guard, 'a value that nobody writes')} (P8100 is {picture.guard:g})"
    for motor, words in picture.motors.items():
        yield f"motor {motor}", words
    for place in picture.joints:
        actual = "not known" if place.actual is None else f"{place.actual:.3f} {place.unit}"
        yield place.name, f"commanded {place.commanded:.3f} {place.unit}, actual {actual}"
