"""`yarc place`."""

from __future__ import annotations

import json
import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import trouble_is_said
from yarclang.cli.garbage import seldom_look_for_garbage
from yarclang.cli.options import (
    avoid_effort_option,
    file_argument,
    format_option,
    jobs_option,
    planning_options,
    scheduler_option,
    tm_option,
)
from yarclang.cli.threads import one_for_products

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from yarclang.fleet.outcome import Lost
    from yarclang.fleet.placing import Candidate, Placing, Range, Shift, Task

_RANGE = re.compile(r"(X|Y|Z|RX|RY|RZ)=(-?\d+(?:\.\d+)?):(-?\d+(?:\.\d+)?)", re.IGNORECASE)
_POINTS = {1: 17, 2: 7, 3: 5}
"""Number of places along each axis of the grid, by the number of axes."""

_LARGEST = {"X": 10_000.0, "Y": 10_000.0, "Z": 10_000.0, "RX": 180.0, "RY": 180.0, "RZ": 180.0}


def _ranges(
    context: click.Context,  # noqa: ARG001 - the signature is click's
    parameter: click.Parameter,  # noqa: ARG001
    values: tuple[str, ...],
) -> tuple[tuple[str, float, float], ...]:
    """Return the ranges of --within: each an axis, and the least and the largest shift along or about it."""
    found: dict[str, tuple[str, float, float]] = {}
    for value in values or ("X=-300:300", "Y=-300:300"):
        match = _RANGE.fullmatch(value.strip())
        if match is None:
            raise click.BadParameter(f"'{value}' isn't like X=-300:300 or RZ=-45:45 (mm, deg).")
        axis, least, most = match[1].upper(), float(match[2]), float(match[3])
        if axis in found:
            raise click.BadParameter(f"{axis} is given twice.")
        if not -_LARGEST[axis] <= least <= most <= _LARGEST[axis]:
            unit = "mm" if len(axis) == 1 else "deg"
            raise click.BadParameter(
                f"'{value}': the first value must not exceed the second, and both must be within "
                f"{_LARGEST[axis]:g} {unit}."
            )
        found[axis] = axis, least, most
    return tuple(found.values())


@click.command("place")
@file_argument("file", metavar="PROGRAM")
@click.argument("frame", metavar="FRAME")
@click.option(
    "--within",
    multiple=True,
    metavar="AXIS=FROM:TO",
    callback=_ranges,
    help="Range in which the frame may be moved from its present place, along or about an axis of its "
    "parent: X, Y, "
    "Z in mm, RX, RY, RZ in deg; once for each axis (default: X=-300:300 and Y=-300:300).",
)
@click.option(
    "--for",
    "aim",
    type=click.Choice(["time", "clearance"]),
    default="time",
    help="What to optimize: the shortest time (default), or the largest clearance from the cell.",
)
@click.option(
    "--grid",
    type=click.IntRange(2, 50),
    metavar="N",
    help=(
        "Number of places along each axis in the first grid (default: 17 along one axis, 7 along two, 5 "
        "along three, "
        "otherwise 3)."
    ),
)
@click.option(
    "--most",
    type=click.IntRange(1, 100_000),
    default=300,
    metavar="N",
    help="Total number of candidates to try (default: 300).",
)
@click.option(
    "--apply", "applies", is_flag=True, help="Write the best place into the file that declares the frame."
)
@planning_options
@tm_option
@avoid_effort_option
@jobs_option
@scheduler_option
@format_option
def command(
    file: str,
    frame: str,
    within: tuple[tuple[str, float, float], ...],
    aim: Any,
    grid: int | None,
    most: int,
    applies: bool,
    jobs: int | None,
    scheduler: str,
    format_: str,
    **planning: Any,
) -> None:
    """Find where a fixture or a part could stand so that all motions are possible and the program is
    quickest.

    FRAME is the name of a frame that the program or its cell declares, and that doesn't move with the robot.
    Everything whose position is given in this frame moves with it. The command tries many places of the
    frame, and compiles and proves the program for each of them. To find a place for the robot's base instead,
    declare one frame in {B}, give the whole cell in this frame, and name it as FRAME. The command prints a
    map: for each place of the grid, the program's time, or the first error.
    """
    if grid is None:
        grid = _POINTS.get(len(within), 3)
    count = grid ** len(within)
    if count > most:
        axes = f"{len(within)} ax{'i' if len(within) == 1 else 'e'}s"
        raise click.UsageError(
            f"a grid of {grid} places along {axes} has {count:,} candidates, more than --most {most:,}"
        )
    one_for_products()
    seldom_look_for_garbage()
    from yarclang.cli.fleet import Fleet
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import Progress, options_from
    from yarclang.fleet.placing import Range, find_task, judged, search
    from yarclang.pipeline.sources import read_source

    read = read_source(file)
    if read.value is None:
        show_findings(read.diagnostics)
        raise SystemExit(1)
    box = tuple(Range(*one) for one in within)
    folder = Path.cwd() if file == "-" else Path(file).parent
    fleet = Fleet(jobs, scheduler)
    with trouble_is_said(), Progress() as progress:
        task = find_task(read.value, folder, options_from(planning), frame, box, aim)
        done = 0
        with fleet.workers(partial(judged, task=task)) as do:

            def judge(shifts: Sequence[Shift]) -> Iterator[Candidate | Lost]:
                nonlocal done
                for one in do(shifts):
                    done += 1
                    progress("candidates", done, most)
                    yield one

            placing = search(task, judge, grid, most)
    _show(task, placing, format_, applies=applies)


def _show(task: Task, placing: Placing, format_: str, *, applies: bool) -> None:
    from yarclang.cli.differences import difference
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_whole
    from yarclang.fleet.placing import moved

    best = placing.best
    if format_ == "json":
        click.echo(json.dumps(_report(task, placing), indent=2))
    else:
        for line in _map(task, placing):
            click.echo(line)
    if best is None:
        click.echo("no candidate compiles", err=True)
        raise SystemExit(1)
    program, cell = moved(task, best.shift)
    before, after = (task.program, program) if cell is None or task.cell is None else (task.cell, cell)
    if format_ != "json":
        click.echo(f"\nbest: {_said(task.box, best)}")
        click.echo(
            difference(before.name, before.text, after.text) or "it is at the best place already", nl=False
        )
    if applies and before.text != after.text:
        if before.name == "<stdin>":
            raise click.ClickException("--apply can't write to standard input: give a file")
        from yarclang.cli.differences import with_mark

        path = Path(before.name)
        if faults := write_whole(path, with_mark(path, after.text)):
            show_findings(faults)
            raise SystemExit(1)
        click.echo(f"written to {path}", err=True)


def _said(box: Sequence[Range], one: Candidate) -> str:
    """Return a description of a candidate."""
    moves = [
        f"{allowed.axis} {value:+g} {'mm' if len(allowed.axis) == 1 else 'deg'}"
        for allowed, value in zip(box, one.shift, strict=True)
        if value
    ]
    clearance = "" if one.clearance is None else f", {one.clearance * 1e3:.1f} mm from the cell"
    return f"{', '.join(moves) or 'the present place'}: {one.seconds:.2f} s{clearance}"


def _map(task: Task, placing: Placing) -> Iterator[str]:
    """Yield the lines of a map of the tried positions: along the first two axes, at the best values of the
    other axes.
    """
    first = task.box[0]
    second = task.box[1] if len(task.box) > 1 else None
    cells: dict[tuple[float, float], Candidate] = {}
    for one in placing.grid:
        key = one.shift[0], one.shift[1] if second else 0.0
        if key not in cells or _is_better(one, cells[key], task.aim):
            cells[key] = one
    letters: dict[tuple[str, str, str], str] = {}
    for one in cells.values():
        if not one.is_possible:
            letters.setdefault((one.code, one.label, one.reason), _letter(len(letters)))
    unit = "s" if task.aim == "time" else "mm from the cell"
    yield f"{{{task.frame}}} in {{{task.parent}}}: {unit}, by its shift along {first.axis}" + (
        f" (across) and {second.axis} (up)" if second else ""
    )
    columns = placing.numbers[0]
    width = max(8, *(len(f"{one:+g}") + 2 for one in columns))
    for row in reversed(placing.numbers[1]) if second else (0.0,):
        head = f"{row:+8g} " if second else " " * 9
        yield head + "".join(_shown(cells.get((one, row)), letters, task.aim).rjust(width) for one in columns)
    yield " " * 9 + "".join(f"{one:+g}".rjust(width) for one in columns)
    for (code, label, reason), letter in letters.items():
        yield f"{letter}: {code} {label}{': ' if label else ''}{reason}"


def _is_better(one: Candidate, other: Candidate, aim: str) -> bool:
    if one.seconds is None or other.seconds is None:
        return one.seconds is not None or (other.seconds is None and one.errors < other.errors)
    return one.seconds < other.seconds if aim == "time" else (one.clearance or 0.0) > (other.clearance or 0.0)


def _shown(one: Candidate | None, letters: dict[tuple[str, str, str], str], aim: str) -> str:
    if one is None:
        return "?"
    if one.seconds is None:
        return letters[one.code, one.label, one.reason]
    if aim == "clearance":
        return "-" if one.clearance is None else f"{one.clearance * 1e3:.1f}"
    return f"{one.seconds:.2f}"


def _letter(number: int) -> str:
    """Return the letters for a number from 0: a, b, ... z, aa, ab, ..."""
    return (_letter(number // 26 - 1) if number >= 26 else "") + chr(ord("a") + number % 26)


def _report(task: Task, placing: Placing) -> dict[str, Any]:
    def of(one: Candidate) -> dict[str, Any]:
        shift = {allowed.axis: value for allowed, value in zip(task.box, one.shift, strict=True)}
        clearance = None if one.clearance is None else one.clearance * 1e3
        error = (
            None
            if one.is_possible
            else {"code": one.code, "command": one.label, "message": one.reason, "errors": one.errors}
        )
        return {"shift": shift, "seconds": one.seconds, "clearance_mm": clearance, "error": error}

    return {
        "frame": task.frame,
        "parent": task.parent,
        "for": task.aim,
        "best": None if placing.best is None else of(placing.best),
        "grid": [of(one) for one in placing.grid],
        "search": [of(one) for one in placing.others],
    }
