"""Read a program's file and the user's options. The result is a syntax tree, and a request with which it is
compiled.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from pathlib import Path

import numpy as np

from yarclang.diagnostics import Collector, Diagnostic, Result, has_errors
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.memory import NO_MEMORY, Memory
from yarclang.pipeline.cells import cell_loader
from yarclang.pipeline.kept import robot_kept
from yarclang.pipeline.modules import loader
from yarclang.pipeline.project import Project, find_project
from yarclang.pipeline.sources import NO_TEXTS, STANDARD_INPUT, read_source
from yarclang.pipeline.stages import CellNow, Request
from yarclang.pipeline.trajectories import TrajectoryLoader
from yarclang.robot.description import load_robot, read_robot
from yarclang.robot.library import find_robot, list_robots
from yarclang.robot.model import Robot, Tolerance
from yarclang.semantics.declared.whole_file import check_robot, declared_robot
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Module
from yarclang.syntax.parse import parse
from yarclang.units import DEG, MM


@frozen
class Options:
    """Options that the user gives besides the files.

    Attributes:
        start: joint position at which the program starts [deg, mm for prismatic joints].
        tm: longest segment time [ms].
        tolerance: tolerance of the path [mm, deg]; None: the robot's own.
        cell: path of a cell.toml.
        texts: files that are open in an editor, by their absolute paths. They replace the saved modules,
            cells and robots.
        memory: cache for later checks (created by pipeline/incremental.py).
        enough: number of lines in loops and SUBs after which a quick check stops; None: no limit.
        present: function that returns the places of the cell's parts when the program starts; None: the
            places in the cell's file.
        avoid_effort: number of paths around obstacles to search for; the fastest of them is used.
    """

    robot: str | None = None
    start: tuple[float, ...] | None = None
    tm: float | None = None
    tolerance: tuple[float, float | None] | None = None
    target: str = ""
    texts: Mapping[Path, SourceFile] = field(default_factory=lambda: NO_TEXTS)
    memory: Memory = NO_MEMORY
    enough: int | None = None
    cell: str | None = None
    present: CellNow | None = None
    avoid_effort: int = 1

    @property
    def said(self) -> tuple[object, ...]:
        """Return the user's options as a key for results that are stored on the disk.

        Raises:
            ValueError: a result also depends on something that isn't on the disk, such as a file open in an
                editor.
        """
        if self.texts or self.present is not None:
            raise ValueError("open texts and moved parts differ from the files on the disk")
        given = (self.robot, self.start, self.tm, self.tolerance, self.target)
        return (*given, self.enough, self.cell, self.avoid_effort)


@frozen(eq=False)
class Opened:
    """A parsed program, and the settings with which it is compiled."""

    module: Module
    request: Request


def open_program(path: str, options: Options) -> Result[Opened]:
    """Read and parse a program, and find its robot.

    Returns:
        None if the file or the robot can't be read. With only syntax errors, the program is returned, so that
        the rest of it can still be checked.
    """
    read = read_source(path)
    if read.value is None:
        return Result(None, read.diagnostics)
    folder = Path.cwd() if path == STANDARD_INPUT else Path(path).parent
    return open_source(read.value, folder, options)


def open_source(source: SourceFile, folder: Path, options: Options) -> Result[Opened]:
    """Parse a program, and find its robot.

    Args:
        source: the program.
        folder: folder of the program, in which modules, cells and yarc.toml are looked for.
        options: the user's options.
    """
    if source.text.startswith("; yarcc "):
        message = "this is controller text that yarcc has written, not a program"
        return Result(
            None, (Diagnostic("Y0108", message, source, Span.on_line(1, 1, 8), "give the .yarc file"),)
        )
    parsed = parse(source)
    module = parsed.value
    assert module is not None  # parsing always gives a tree
    if not parsed.diagnostics and not module.statements:
        span = Span.on_line(1, 1, 2)
        return Result(
            None,
            (Diagnostic("Y0104", "the file has no command", source, span, "check which file was given"),),
        )
    project = find_project(folder, options.texts)
    if project.value is None:
        return Result(None, (*parsed.diagnostics, *project.diagnostics))
    found = _robot(module, folder, project.value, options)
    diagnostics = (*parsed.diagnostics, *found.diagnostics)
    if found.value is None:
        return Result(None, diagnostics)
    robot = found.value
    findings = Collector(source)
    start = _start(robot, options.start, "--start", findings, None)
    found_in = project.value
    settings = Collector(found_in.source or source)
    fallback = _start(robot, found_in.start, "start", settings, found_in.span_of("start"))
    findings.found += settings.found
    load_cell = cell_loader(folder, robot, options.texts, options.memory)
    cell = load_cell.given(found_in, options.cell)
    diagnostics = (*diagnostics, *findings.found, *cell.diagnostics)
    if has_errors((*findings.found, *cell.diagnostics)):
        return Result(None, diagnostics)
    request = Request(
        robot=robot,
        start=start,
        fallback_start=fallback,
        tm=options.tm,
        tolerance=tolerance_of(robot, options.tolerance),
        target=options.target,
        load=loader(folder, options.texts),
        load_cell=load_cell,
        load_table=TrajectoryLoader(folder, options.texts, options.memory),
        cell=cell.value,
        memory=options.memory,
        enough=options.enough,
        present=options.present,
        avoid_effort=options.avoid_effort,
    )
    return Result(Opened(module, request), diagnostics)


def _robot(module: Module, folder: Path, project: Project, options: Options) -> Result[Robot]:
    """Return the robot that the command line or a ROBOT line names (they must agree), or else the robot of
    yarc.toml.
    """
    declared = declared_robot(module)
    if options.robot is not None:
        robot = _on_command_line(options.robot, project, options)
        if declared is None or robot.value is None:
            return robot
        other = _named(declared[0], folder, module.source, declared[1], options)
        if other.value is not None and other.value.fingerprint != robot.value.fingerprint:
            message = f"the program is for {other.value.name}, but the command line names {robot.value.name}"
            if other.value.name == robot.value.name:
                message = (
                    f"two robots are named {robot.value.name}: {other.value.folder} and {robot.value.folder}"
                )
            help_ = "remove --robot, or change the ROBOT line"
            return Result(None, (Diagnostic("Y1392", message, module.source, declared[1], help_),))
        return Result(robot.value if other.value else None, other.diagnostics)
    if declared is not None:
        return _named(declared[0], folder, module.source, declared[1], options)
    malformed = [one for one in module.statements if one.index is None and one.name.name == "ROBOT"]
    if malformed:
        findings = Collector(module.source)
        check_robot(malformed[0], findings)
        return Result(None, tuple(findings.found))
    return _of_project(project, module.source, options)


def _on_command_line(name_or_path: str, project: Project, options: Options) -> Result[Robot]:
    """Return the robot that the command line gives by name or path: a robot of the library, the robot at the
    path, or the robot of yarc.toml if it has this name.
    """
    if project.robot is not None and find_robot(name_or_path)[0] is None:
        own = _of_project(project, None, options).value
        if own is not None and own.name.lower() == name_or_path.lower():
            return Result(own)
    return _loaded(name_or_path, options.texts, options.memory)


def robot_for(folder: Path, name: str | None, texts: Mapping[Path, SourceFile] = NO_TEXTS) -> Result[Robot]:
    """Return the robot with the given name or, without a name, that of the folder's yarc.toml, for work that
    has no program yet. `texts` are files that are open in an editor.
    """
    if name is not None:
        return named_robot(folder, name)
    project = find_project(folder, texts)
    return (
        Result(None, project.diagnostics)
        if project.value is None
        else _of_project(project.value, None, Options(texts=texts))
    )


def named_robot(folder: Path, name_or_path: str) -> Result[Robot]:
    """Return the robot with a name or path: a robot of the library, the robot at the path, or the robot of
    the folder's yarc.toml if it has this name.
    """
    if find_robot(name_or_path)[0] is None and (own := _folder_robot(folder, name_or_path)) is not None:
        return Result(own)
    return load_robot(name_or_path)


def robot_made_for(folder: Path, name: str) -> Result[Robot]:
    """Return the robot that a controller text or a log names: the robot of the folder's yarc.toml if it has
    this name, else the library's robot with this name.
    """
    own = _folder_robot(folder, name)
    return load_robot(name) if own is None else Result(own)


def _folder_robot(folder: Path, name: str) -> Robot | None:
    """Return the robot of the folder's yarc.toml if it has this name."""
    robot = robot_for(folder, None).value
    return robot if robot is not None and robot.name.lower() == name.lower() else None


def joint_position(robot: Robot, values: tuple[float, ...] | None, name: str) -> Result[Array]:
    """Convert the values of a command line option to a joint position, for work that has no program yet.

    Args:
        robot: the robot.
        values: one per joint, in deg (mm for prismatic joints); None: the robot's home.
        name: name of the values in messages.
    """
    if values is None:
        return Result(robot.home)
    findings = Collector(SourceFile("", ""))
    q = _start(robot, values, name, findings, None)
    return Result(q, tuple(replace(one, source=None) for one in findings.found))


def _of_project(project: Project, program: SourceFile | None, options: Options) -> Result[Robot]:
    """Return the robot of yarc.toml; if yarc.toml names none, a finding that the program needs a robot."""
    if project.robot is not None:
        return _named(project.robot, project.folder, project.source, project.span_of("robot"), options)
    names = ", ".join(robot.name for robot in list_robots())
    help_ = f'give --robot NAME, a ROBOT line, or robot = "NAME" in yarc.toml; the robots are {names}'
    return Result(None, (Diagnostic("Y1391", "no robot is named", program, help=help_),))


def _named(
    name: str,
    folder: Path,
    source: SourceFile | None,
    span: Span | None,
    options: Options,
) -> Result[Robot]:
    """Return the robot that a program or yarc.toml names, by name or path. A wrong name is reported at its
    place in that file.
    """
    found = _loaded(_placed(name, folder), options.texts, options.memory)
    placed = tuple(
        one if one.source is not None else replace(one, source=source, span=span) for one in found.diagnostics
    )
    return Result(found.value, placed)


def _loaded(name_or_path: str, texts: Mapping[Path, SourceFile], memory: Memory) -> Result[Robot]:
    """Return the robot with a name or path. If its robot.toml is open in an editor, the open text is read."""
    path = find_robot(name_or_path)[0] if texts or memory is not NO_MEMORY else None
    text = texts.get(path.absolute()) if path is not None else None

    def load() -> Result[Robot]:
        return load_robot(name_or_path) if path is None or text is None else read_robot(text, path.parent)

    return robot_kept(memory, path, None if text is None else text.text, load)


def _placed(name_or_path: str, folder: Path) -> str:
    """Resolve a path relative to the file that contains it. A plain name isn't changed."""
    if "/" in name_or_path or name_or_path.endswith(".toml"):
        return str(folder / name_or_path)
    return name_or_path


def _start(
    robot: Robot, values: tuple[float, ...] | None, what: str, findings: Collector, span: Span | None
) -> Array | None:
    """Check joint values [deg or mm], and return them as a joint position in SI."""
    if values is None:
        return None
    names = " ".join(robot.joint_names)
    if len(values) != robot.size:
        message = (
            f"{what} has {len(values)} value{'s' * (len(values) != 1)}, but {robot.name} has {robot.size} "
            f"joints ({names})"
        )
        findings.add("Y1394", message, span, "give one value per joint, in deg (mm for prismatic joints)")
        return None
    q: Array = np.array(values, dtype=np.float64) * robot.axis_units
    excess = np.maximum(robot.limits.lower - q, q - robot.limits.upper) / robot.axis_units
    if not np.isfinite(q).all():
        findings.add("Y1394", f"{what} has a value that isn't finite", span, "the robot can't stand there")
        return None
    joint = int(np.argmax(excess))
    if excess[joint] > 1e-9:
        name, unit = robot.joint_names[joint], robot.axis_unit_names[joint]
        message = f"{what} has {name} {excess[joint]:.4g} {unit} outside of its limits"
        findings.add("Y1394", message, span, "the robot can't stand there")
        return None
    q.setflags(write=False)
    return q


def tolerance_of(robot: Robot, requested: tuple[float, float | None] | None) -> Tolerance | None:
    """Return a requested path tolerance [mm, deg]; None without a request. If only a length is given, the
    angle is that of the robot's own tolerance.
    """
    if requested is None:
        return None
    position, angle = requested
    return Tolerance(position * MM, robot.tolerance.angle if angle is None else angle * DEG)
