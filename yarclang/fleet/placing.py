"""Search for the place of a fixture, a workpiece or the robot's base: the poses of a frame at which a program
compiles, and the best of them.

Each candidate is the program (or its cell) with another pose of the frame, and is compiled in the ordinary
way. The search begins with a coarse grid over the whole box of allowed shifts. From the best candidates of
the grid, it continues as a compass search: it compiles the candidates one step away along each axis, and goes
to the best of them. If none is better, the step is halved (Kolda, Lewis, Torczon: Optimization by direct
search, 2003). This method needs no derivatives. A cycle time has none, because it is a whole number of
segments. The candidates of a step are independent, so they can be compiled in parallel.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np

from yarclang.fleet.outcome import Lost
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.pipeline.checking import Checked, check_text
from yarclang.pipeline.inputs import Options, open_source
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.teaching.declaring import declare_pose
from yarclang.teaching.edits import Program, applied
from yarclang.teaching.holding import Around, around, holding
from yarclang.toml.changes import ChangeError
from yarclang.transforms import rpy_rotation
from yarclang.units import DEG, MM

AXES = ("X", "Y", "Z", "RX", "RY", "RZ")
"""Names of the shifts of a frame: along the axes of its parent [mm], and about axes through the frame's
origin that are parallel to the parent's axes [deg].
"""

Shift = tuple[float, ...]
"""Shift of a frame from its present pose: one number for each axis of the box [mm or deg]."""

_FINEST = {"X": 0.5, "Y": 0.5, "Z": 0.5, "RX": 0.1, "RY": 0.1, "RZ": 0.1}
"""The search ends when the steps along all axes are smaller than these [mm, deg]."""

_BEGINNINGS = 2
"""Number of candidates of the grid, the best ones, from which compass searches begin."""

Aim = Literal["time", "clearance"]


@frozen
class Range:
    """Allowed shifts along one axis [mm or deg]."""

    axis: str
    least: float
    most: float


@frozen
class Task:
    """A search: the frame to be placed, its allowed shifts, and the criterion.

    Attributes:
        program: source of the program.
        folder: folder of the program.
        options: options of the command line.
        frame: name of the frame, in upper case.
        cell: source of the cell, if the frame is declared there; otherwise None.
        place: path of the cell's file.
        parent: name of the frame's parent.
        pose: (4, 4) present parent_from_frame [m].
        box: the allowed shifts along each axis.
        aim: criterion for the best candidate: the shortest time, or the largest clearance.
    """

    program: SourceFile
    folder: Path
    options: Options
    frame: str
    cell: SourceFile | None
    place: Path | None
    parent: str
    pose: Array
    box: tuple[Range, ...]
    aim: Aim = "time"


@frozen
class Candidate:
    """Result of compiling the program with the frame at one pose.

    Attributes:
        shift: shift of the frame from its present pose.
        seconds: duration of the program [s]; None if it doesn't compile.
        clearance: smallest proved distance of the robot from the cell [m]; None if no distance was proved, or
            the program doesn't compile.
        errors: number of errors.
        reason: the first error; empty if the program compiles.
        code: code of the first error.
        label: index of the command with the first error, such as P0030; empty if the error belongs to no
            command.
    """

    shift: Shift
    seconds: float | None = None
    clearance: float | None = None
    errors: int = 0
    reason: str = ""
    code: str = ""
    label: str = ""

    @property
    def is_possible(self) -> bool:
        """True if the program compiles."""
        return self.seconds is not None


@frozen
class Placing:
    """The result of a search for the best pose of a frame.

    Attributes:
        grid: the candidates of the coarse grid, in order.
        others: the candidates of the compass searches.
        best: the best candidate that compiles; None if there is none.
        numbers: for each axis, the shifts of the grid [mm or deg].
    """

    grid: tuple[Candidate, ...]
    others: tuple[Candidate, ...]
    best: Candidate | None
    numbers: tuple[tuple[float, ...], ...]


Judge = Callable[[Sequence[Shift]], Iterator["Candidate | Lost"]]


def find_task(
    program: SourceFile, folder: Path, options: Options, frame: str, box: tuple[Range, ...], aim: Aim
) -> Task:
    """Return the search task for a frame that the program or its cell declares.

    Raises:
        Trouble: there is no such frame, the frame moves with the robot, or the program can't be opened.
    """
    name = frame.strip("{} ").upper()
    opened = open_source(program, folder, options)
    if opened.value is None:
        first = opened.diagnostics[0]
        raise Trouble(f"the program can't be opened: {first.clause}", first.help, first.code)
    request = opened.value.request
    shown = around(Program(program), folder, request.robot)
    declared = shown.program.sketch.names.declared(name, True)
    if declared is not None:
        parent, pose = _in_program(shown, name, declared.statement.line)
        return Task(program, folder, options, name, None, None, parent, pose, box, aim)
    checked = check_text(program, folder, options, plans=False)
    cell = None if checked.program is None else checked.program.cell
    if cell is None or name not in cell.frames:
        known = sorted(
            {one.name for one in shown.program.sketch.names.symbols if one.is_frame}
            | set(cell.frames if cell else ())
        )
        listed = ", ".join(f"{{{one}}}" for one in known) or "none"
        raise Trouble(
            f"neither the program nor its cell declares {{{name}}}", f"they declare {listed}", "frame"
        )
    own = cell.frames[name]
    if own.mount.on_flange:
        raise Trouble(f"{{{name}}} moves with the robot", "name a fixed frame", "frame")
    source = cell.source
    return Task(
        program, folder, options, name, source, Path(source.name), own.parent, own.parent_from_frame, box, aim
    )


def _in_program(shown: Around, name: str, line: int) -> tuple[str, Array]:
    """Return the parent of a frame that the program declares, and parent_from_frame (4, 4) [m]."""
    frame = shown.frame(name, shown.program.size + 1, moves=False)
    statement = shown.program.sketch.names.declared(name, True)
    assert statement is not None
    base = statement.statement.base
    parent = (
        base.name if base is not None else holding(shown.program, line, declares=True).base or "B"
    ).upper()
    if parent == "B":
        return parent, np.array(frame.transform)
    return parent, np.linalg.inv(shown.frame(parent, line, moves=False).transform) @ frame.transform


def moved(task: Task, shift: Shift) -> tuple[SourceFile, SourceFile | None]:
    """Return the texts of the program and its cell with the frame shifted from its present pose.

    Raises:
        Trouble: the text can't be changed in this way.
    """
    values = dict(zip((one.axis for one in task.box), shift, strict=True))
    turn = np.array([values.get(axis, 0.0) for axis in AXES[3:]]) * DEG
    pose = np.array(task.pose)
    pose[:3, 3] += np.array([values.get(axis, 0.0) for axis in AXES[:3]]) * MM
    pose[:3, :3] = rpy_rotation(turn) @ pose[:3, :3]
    if task.cell is not None:
        from yarclang.calibration.writing import with_frame

        try:
            text = with_frame(task.cell, _key(task.cell, task.frame), pose, task.parent)
        except ChangeError as error:
            raise Trouble(str(error), "write the frame's table by hand", "form") from None
        return task.program, SourceFile(task.cell.name, text)
    opened = open_source(task.program, task.folder, task.options)
    assert opened.value is not None  # `find_task` has opened it
    shown = around(Program(task.program), task.folder, opened.value.request.robot)
    made = declare_pose(shown, task.frame, pose, task.parent, again=True)
    return SourceFile(task.program.name, applied(task.program.text, made.edits)), None


def _key(cell: SourceFile, name: str) -> str:
    """Return a frame's name with the capital and small letters of the cell's file."""
    import tomllib

    tables = tomllib.loads(cell.text).get("frames", {})
    return next((one for one in tables if one.upper() == name), name)


def judged(shift: Shift, task: Task) -> Candidate:
    """Compile the program with the frame shifted from its present pose, and return the result."""
    from dataclasses import replace

    program, cell = moved(task, shift)
    options = task.options
    if cell is not None and task.place is not None:
        options = replace(options, texts={**options.texts, task.place.absolute(): cell})
    return _candidate(shift, check_text(program, task.folder, options))


def _candidate(shift: Shift, checked: Checked) -> Candidate:
    if checked.compiled is None:
        errors = [one for one in checked.diagnostics if one.is_error]
        first = errors[0] if errors else None
        if first is None:
            return Candidate(shift, errors=1, reason="it isn't certified")
        label = ""
        if first.source is not None and first.span is not None:
            words = first.source.line(first.span.line).split()
            label = words[0] if words else ""
        return Candidate(shift, None, None, len(errors), first.clause, first.code, label)
    certificate = checked.compiled.certificate
    distances = [one.clearance.distance for one in certificate.commands if one.clearance is not None]
    return Candidate(shift, certificate.lasting.most, min(distances, default=None))


def search(task: Task, judge: Judge, points: int, most: int) -> Placing:
    """Search for the best pose of a frame.

    Args:
        task: the frame to be placed, its allowed shifts, and the criterion.
        judge: function that compiles candidates and yields their results in order.
        points: number of grid points along each axis.
        most: largest number of candidates in total.

    Raises:
        Trouble: the processes that compiled a candidate were killed.
    """
    numbers = tuple(_spaced(one, points) for one in task.box)
    known: dict[Shift, Candidate] = {}

    def look(shifts: Sequence[Shift]) -> None:
        new = list(dict.fromkeys(one for one in shifts if one not in known))[: most - len(known)]
        for shift, candidate in zip(new, judge(new), strict=True):
            if isinstance(candidate, Lost):
                raise Trouble(
                    f"a candidate can't be evaluated: {candidate.reason}", "try --jobs 1", "process"
                )
            known[shift] = candidate

    look(list(itertools.product(*numbers)))
    grid = tuple(known.values())
    better = partial(_score, aim=task.aim)
    spacing = [max(np.diff(one), default=0.0) for one in numbers]
    for begin in sorted(known, key=lambda shift: better(known[shift]))[:_BEGINNINGS]:
        _refine(begin, spacing, task, look, known, most)
    best = min(known.values(), key=better)
    return Placing(grid, tuple(known.values())[len(grid) :], best if best.is_possible else None, numbers)


def _refine(
    begin: Shift,
    spacing: Sequence[float],
    task: Task,
    look: Callable[[Sequence[Shift]], None],
    known: dict[Shift, Candidate],
    most: int,
) -> None:
    """Do a compass search from one candidate of the grid, until all steps are smaller than those in `_FINEST`
    or `most` candidates are known.
    """
    center = begin
    steps = [0.5 * one for one in spacing]
    finest = [_FINEST[one.axis] for one in task.box]
    while any(step >= limit for step, limit in zip(steps, finest, strict=True)) and len(known) < most:
        around_ = [
            tuple(
                _within(task.box[axis], value + sign * steps[axis]) if axis == place else value
                for place, value in enumerate(center)
            )
            for axis in range(len(center))
            for sign in (-1.0, 1.0)
            if steps[axis] >= finest[axis]
        ]
        look(around_)
        best = min(
            (one for one in (center, *around_) if one in known), key=lambda one: _score(known[one], task.aim)
        )
        if best == center:
            steps = [0.5 * one for one in steps]
        else:
            center = best


def _within(allowed: Range, value: float) -> float:
    return min(max(round(value, 1 if len(allowed.axis) == 1 else 2), allowed.least), allowed.most)


def _spaced(allowed: Range, points: int) -> tuple[float, ...]:
    """Return the shifts of the grid along an axis. The shift 0 (the present pose) is always included if it
    is allowed.
    """
    found = {_within(allowed, float(one)) for one in np.linspace(allowed.least, allowed.most, points)}
    if allowed.least <= 0.0 <= allowed.most:
        found.add(0.0)
    return tuple(sorted(found))


def _score(candidate: Candidate, aim: Aim) -> tuple[float, ...]:
    """Return a sort key by which better candidates come first. Of candidates with the same clearance, the
    faster one comes first. Of equal candidates, the one with the smallest shift comes first.
    """
    least = float(np.abs(candidate.shift).sum())
    if candidate.seconds is None:
        return (1.0, float(candidate.errors), least)
    if aim == "time":
        return (0.0, round(candidate.seconds, 6), least)
    return (0.0, -round(candidate.clearance or 0.0, 7), candidate.seconds, least)
