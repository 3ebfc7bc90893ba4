"""A second kind of controller, as small as possible: it executes a table of control points, one a line.

It is the example of CONTRIBUTING.md. It reports what it can't do: outputs, waits, jogs and settings.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal

import numpy as np
from knots.simulator import Simulated as SimulatedTable

from yarclang.backend import Backend, Sendable, Simulated, Written
from yarclang.certify.read.header import read_preamble
from yarclang.certify.read.lines import Lines, Refusal, check_characters, shown
from yarclang.certify.read.reader import Fault, Reader, StartPlace
from yarclang.certify.read.text import ControllerText, Dwelt, Run, Start, Unreadable
from yarclang.diagnostics import Diagnostic, Result
from yarclang.emitted.quoting import allow_line, keep_line
from yarclang.frozen import frozen
from yarclang.handling.allowing import permitted
from yarclang.handling.keeping import kept_to
from yarclang.hir import Dwell, Motion
from yarclang.motion.limits import Grid
from yarclang.robot.controller import NO_SIGNAL, Kind, SignalVariable
from yarclang.units import MS

STEP = 1e-6  # resolution of segment times [s]
DECIMALS = 6


@frozen
class Knots:
    """The connection of a robot to this kind of controller."""

    axes: tuple[str, ...]
    motors: tuple[int, ...]
    largest_segment: float
    hold_time: float
    rapid_share: float
    kind: str = "knots"
    smallest_segment: float = 1.0 * MS
    text: str = "a table of knots"
    timing: str = "its clock"

    def signal(self, text: str) -> SignalVariable:
        return NO_SIGNAL


def _table():
    from yarclang.robot.schema import ControllerTable

    class KnotsTable(ControllerTable):
        kind: Literal["knots"] = "knots"

    return KnotsTable


def _made(table, motors):
    return Knots(
        tuple(table.axes),
        tuple(motors),
        table.largest_tm * MS,
        table.hold_time * MS,
        table.rapid_share,
    )


KIND = Kind(
    name="knots",
    title="a table of knots",
    table=_table,
    controller=_made,
    restored=lambda values: Knots(**values),
    lines=lambda size: ("[controller]", 'kind = "knots"', f"axes = {[f'Q{k + 1}' for k in range(size)]}"),
)


# writing the text


def _grid(robot, tm):
    largest = robot.controller.largest_segment if tm is None else tm * MS
    return Result(Grid(robot.controller.smallest_segment, largest, STEP))


def _row(values):
    return ",".join(f"{value:.{DECIMALS}f}" for value in values)


def _write(plan, target, tolerance, memory):
    units = plan.robot.axis_units
    motions = {motion.step: motion for motion in plan.motions}
    lines, entries = [], []
    for number, step in enumerate(plan.program.steps):
        first = len(lines)
        if isinstance(step, Motion):
            curve = motions[number].curve
            lines += [f"T,{curve.segment / MS:.6f}"]
            # the robot rests between motions: the first three points equal the row before, and the last three
            # are equal
            lines += [_row(np.round(point / units, DECIMALS) + 0.0) for point in curve.points[3:-2]]
        elif isinstance(step, Dwell):
            lines.append(f"D,{step.duration / MS:.6f}")
        else:
            what = f"{plan.robot.name}'s controller, a table of knots, has no {step.origin.name}"
            return Result(
                None, (Diagnostic("Y1104", what, step.origin.source, step.origin.span, "leave it out"),)
            )
        moves = isinstance(step, Motion)
        entries.append((number, step.origin, (first + 1, len(lines) - 1) if moves else None))

    spans = {number: span for number, _, span in entries}

    def text(header):
        allows = [one for one in permitted(plan.program) if spans[one.step] is not None]
        keeps = [one for one in kept_to(plan.program) if spans[one.step] is not None]
        behind = len(header) + len(entries) + len(allows) + len(keeps)
        head = [f"; {line}" for line in header]
        for number, origin, span in entries:
            place = "- -" if span is None else f"{behind + span[0] + 1} {behind + span[1] + 1}"
            head.append(f"; command {number} {origin.label or '-'} {origin.name} {origin.span.line} {place}")
        head += map(allow_line, allows)
        head += map(keep_line, keeps)
        return "\n".join([*head, *lines, "END"]) + "\n"

    times = sorted({motion.curve.segment / MS for motion in plan.motions})
    ends = tuple(dict.fromkeys(f"{time:.6f}" for time in (times[0], times[-1]))) if times else ()
    start = _row(np.round(plan.program.start / units, DECIMALS) + 0.0)
    start = "".join(
        f"{axis}{value}" for axis, value in zip(plan.robot.controller.axes, start.split(","), strict=True)
    )
    written = Written("table", "loading moves nothing", start, ends, lambda time: f"{time:.6f}", text)
    return Result(written)


# reading the text: this is the judge's own code, which shares nothing with the writer


def _read(text, controller, memory):
    lines = Lines(text)
    try:
        check_characters(text)
        preamble = read_preamble(lines)
        return _read_body(lines, preamble, controller)
    except Refusal as refusal:
        return Unreadable(*refusal.args)


_PLAIN = r"(?:0|[1-9][0-9]{0,6})\.[0-9]{6}"
_NUMBER = rf"(?!-0\.0{{6}})-?{_PLAIN}"
_TIMES = re.compile(rf"([TD]),({_PLAIN})")
_KNOT = re.compile(rf"{_NUMBER}(?:,{_NUMBER})*")


def _read_body(lines, preamble, controller):
    axes = "".join(rf"{axis}(-?[0-9]+\.[0-9]{{6}})" for axis in controller.axes)
    found = re.fullmatch(axes, preamble.header.start)
    if found is None:
        lines.refuse("starts nowhere")
    start = Start(6, np.array([float(value) for value in found.groups()]))
    course, points, numbers, segment = [], [], [], None

    def finish():
        if segment is not None and not points:
            lines.refuse("follows a time without knots")
        if segment is not None:
            course.append(Run(segment[0], segment[1], np.array(points), np.array(numbers)))
        points.clear()
        numbers.clear()

    while (line := lines.peek()) != "END":
        if found := _TIMES.fullmatch(line):
            finish()
            value, segment = float(found[2]), (float(found[2]), lines.line) if found[1] == "T" else None
            if found[1] == "D":
                course.append(Dwelt(lines.line, value))
        elif _KNOT.fullmatch(line) and segment is not None and line.count(",") == len(controller.axes) - 1:
            points.append([float(one) for one in line.split(",")])
            numbers.append(lines.line)
        else:
            lines.refuse(f"is {shown(line)}: no line of a table of knots")
        lines.skip()
    finish()
    lines.skip()
    if not lines.at_end:
        lines.refuse("stands behind END")
    return ControllerText(
        preamble.header,
        preamble.entries,
        start,
        tuple(course),
        (),
        DECIMALS,
        STEP,
        allows=preamble.allows,
        keeps=preamble.keeps,
    )


def _start(content, robot):
    exact = 0.5 * 10.0**-DECIMALS * robot.axis_units
    return StartPlace(content.start.printed * robot.axis_units, exact, is_printed=True)


def _faults(content, robot, outputs):
    smallest = robot.controller.smallest_segment
    for run in content.runs:
        if run.segment < smallest * (1.0 - 1e-9):
            yield Fault("Y1152", f"T,{run.segment_ms:g} in line {run.tm_line} is below {smallest / MS:g} ms")


def _sendable(content, robot):
    lines = [
        (item.tm_line, f"T,{item.segment_ms:.6f}")
        if part == "T"
        else (int(item.lines[part]), _row(item.points[part]))
        for item in content.runs
        for part in ("T", *range(len(item.lines)))
    ]
    dwells = [(item.line, f"D,{item.milliseconds:.6f}") for item in content.course if isinstance(item, Dwelt)]
    return Sendable(tuple(sorted(lines + dwells)), (), len(lines) + len(dwells))


@contextmanager
def _simulated(robot, stands, rate, cell) -> Iterator[Simulated]:
    with SimulatedTable(stands / robot.axis_units, rate) as simulator:
        yield Simulated(simulator.port, None)


def _scripts():
    from knots.scripts import SCRIPTS

    return SCRIPTS


BACKEND = Backend(
    kind=KIND,
    suffix=".knots",
    targets=("table",),
    port=5000,
    grid=_grid,
    write=_write,
    reader=lambda: Reader(_read, _start, _faults),
    sendable=_sendable,
    scripts=_scripts,
    simulated=_simulated,
)
