"""Draw pictures of programs, of logs and of robots."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.door import failure_of, is_failure
from yarclang.cli.fleet import Fleet, ended
from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.outputs import STANDARD

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.inputs import Options


@dataclass(frozen=True, slots=True)
class Drawn:
    """Result of drawing a file or a robot.

    Attributes:
        picture: the picture; None if there is nothing to draw.
        what: a description of the picture; without a picture, the reason.
        found: findings.
    """

    picture: bytes | None
    what: str
    found: tuple[Diagnostic, ...] = ()


def draw_programs(files: Sequence[tuple[str, str]], options: Options, fleet: Fleet) -> Iterator[Drawn]:
    """Draw programs, and yield their pictures in the order of the files.

    Args:
        files: for each program its path, and the format of its picture.
        options: options of the command line.
        fleet: processes that draw the pictures.
    """
    formats = dict(files)
    return fleet.results(
        partial(_draw_program, formats=formats, options=options),
        list(formats),
        name=lambda path: ("plot", path, formats[path], options.said),
        is_lasting=lambda _: False,
        lost=lambda path, why: Drawn(None, f"{path}: nothing drawn", (ended(path, why),)),
    )


def draw_robots(robots: Sequence[str], fleet: Fleet) -> Iterator[Drawn]:
    """Draw the workspaces of robots, in the order of the robots."""
    return fleet.results(
        _draw_robot,
        robots,
        name=lambda robot: ("reach", robot),
        is_lasting=lambda _: False,
        lost=lambda robot, why: Drawn(None, f"{robot}: nothing drawn", (ended(robot, why),)),
    )


def draw_run(file: str, format_: Any) -> Drawn:
    """Draw a run from its log. This process reads the log, since logs are too large to be sent to other
    processes.
    """
    from yarclang.report.runs.log import read_run
    from yarclang.report.runs.planned import planned_motion

    run = read_run(file)
    found = run.diagnostics
    if run.value is not None:
        planned = planned_motion(run.value)
        found = (*found, *planned.diagnostics)
        if planned.value is not None:
            from yarclang.report.runs.plot import draw_run as draw

            picture = draw(run.value, planned.value, format_)
            return Drawn(picture, f"{file}: a run of {run.value.end:.3f} s", found)
    return Drawn(None, f"{file}: nothing drawn", found)


def _draw_program(path: str, formats: dict[str, Any], options: Options) -> Drawn:
    """Draw one program. An exception becomes a finding."""
    name = "<stdin>" if path == STANDARD else path
    try:
        return _drawn(path, name, formats[path], options)
    except Exception as error:  # a bug of ours: continue with the other files
        if not is_failure(error):
            raise
        return Drawn(None, f"{name}: nothing drawn", (failure_of(error, path),))


def _drawn(path: str, name: str, format_: Any, options: Options) -> Drawn:
    seldom_look_for_garbage()  # in each process that draws
    from yarclang.diagnostics import has_errors, in_order
    from yarclang.pipeline.checking import settled_in_folder
    from yarclang.pipeline.inputs import open_program
    from yarclang.pipeline.stages import plan_module
    from yarclang.report.finding import count_text

    opened = open_program(path, options)
    diagnostics, plan = opened.diagnostics, None
    if opened.value is not None:
        planned = plan_module(opened.value.module, opened.value.request)
        folder = Path.cwd() if path == STANDARD else Path(path).parent
        diagnostics = settled_in_folder(
            (*diagnostics, *planned.diagnostics), opened.value.module.source, folder, opened.value
        )
        plan = planned.value
    found = in_order(diagnostics)
    if plan is None or has_errors(found):
        return Drawn(None, f"{name}: {count_text(found) or 'no motion'}; nothing drawn", found)
    from yarclang.report.pictures.plot import draw

    return Drawn(draw(plan, format_), f"{name}: {plan.lasting.text()}", found)


def _draw_robot(name: str) -> Drawn:
    try:
        seldom_look_for_garbage()
        from yarclang.report.pictures.held import draw_held
        from yarclang.robot.description import load_robot

        robot = load_robot(name).value
        assert robot is not None  # the robot was read before
        return Drawn(draw_held(robot, "png"), f"{robot.name}: reachable places of the flange")
    except Exception as error:
        if not is_failure(error):
            raise
        return Drawn(None, f"{name}: nothing drawn", (failure_of(error, name),))


def put(drawn: Drawn, destination: str) -> bool:
    """Write a picture, and print what it shows. Return True if there was a picture and it was written."""
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_whole

    show_findings(drawn.found)
    if drawn.picture is None:
        click.echo(drawn.what, err=True)
        return False
    if destination == STANDARD:
        click.echo(drawn.picture, nl=False)
    elif faults := write_whole(Path(destination), drawn.picture):
        show_findings(faults)
        return False
    where = "standard output" if destination == STANDARD else destination
    click.echo(f"{drawn.what} drawn to {where}", err=True)
    return True
