"""Find the cell.toml files that a program or a project names: the path in a CELL line is relative to the file
with this line, and the path in yarc.toml is relative to the folder of yarc.toml.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from yarclang.cell.description import Names, load_cell, read_cell
from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.files import LARGEST_MESH
from yarclang.memory import NO_MEMORY, Memory
from yarclang.pipeline.kept import Stamp, cell_kept, meshes_of, stamp_of
from yarclang.pipeline.project import FILE_NAME, Project, find_project, read_project
from yarclang.pipeline.sources import NO_TEXTS, read_content, read_source
from yarclang.robot.description import load_robot
from yarclang.robot.library import DESCRIPTION
from yarclang.robot.model import Robot
from yarclang.semantics.context import GivenCell
from yarclang.semantics.declared.meanings import is_word
from yarclang.shapes import Mesh
from yarclang.source import SourceFile
from yarclang.toml.reading import read_text

SUFFIX = ".toml"


class CellLoader:
    """Reader of a program's cells: those that its CELL lines name, and the cell of the command line or
    yarc.toml.

    All paths to the same file give the same result.

    Args:
        folder: folder of the program.
        robot: robot for the cells' joint values.
        texts: files that are open in an editor, by their paths; they replace the saved files.
        memory: cache of what was read.
    """

    def __init__(
        self,
        folder: Path,
        robot: Robot,
        texts: Mapping[Path, SourceFile] = NO_TEXTS,
        memory: Memory = NO_MEMORY,
    ) -> None:
        self._folder = folder
        self._robot = robot
        self._texts = texts
        self._memory = memory
        self._known: dict[Path, Result[Cell]] = {}
        self._stamps: dict[Path, Stamp] = {}

    def __call__(self, path: str, module: SourceFile | None) -> Result[Cell]:
        """Read the cell that a CELL line names.

        Args:
            path: path in the line.
            module: module with the line; None: the program.
        """
        return self.at((self._folder if module is None else Path(module.name).parent) / path)

    def at(self, place: Path) -> Result[Cell]:
        """Read a cell file. Its findings show the path by which the file was first requested."""
        key = file_of(place)
        if key not in self._known:
            text = self._texts.get(place.absolute()) or self._texts.get(key)
            names = Names(is_word, self._robot)

            def read() -> Result[Cell]:
                return load_cell(place, names) if text is None else read_cell(text, place.parent, names)

            saved = None if text is None else text.text
            if text is None:
                self._stamps[place] = stamp_of((place,))
            made = cell_kept(self._memory, place, self._robot, saved, read)
            if made.value is not None:
                self._stamps |= {mesh: stamp_of((mesh,)) for mesh in meshes_of(made.value)}
            self._known[key] = made
        return self._known[key]

    @property
    def is_current(self) -> bool:
        """Return True if none of the files that were read has changed. Reads the disk."""
        return all(stamp_of((path,)) == stamp for path, stamp in self._stamps.items())

    def given(self, project: Project, named: str | None) -> Result[GivenCell]:
        """Read the cell that the command line or yarc.toml names; it applies even if the program has no CELL
        line.

        Args:
            project: project whose `cell` is used if `named` is None.
            named: path of the cell on the command line; None: not given.

        Returns:
            None without findings if neither names a cell; None with an error if both name a cell and the
            files differ. Errors in the cell's own file are in `GivenCell.loaded`.
        """
        if project.cell is None and named is None:
            return Result(None)
        if project.cell is None:
            assert named is not None  # one of `project.cell` and `named` is given
            return Result(GivenCell(named, self.at(Path(named)), "the command line", "remove --cell"))
        cell_path, span = project.folder / project.cell, project.span_of("cell")
        remedy = f"change cell in {FILE_NAME}"
        if named is not None and not is_same_file(cell_path, Path(named)):
            message = f"{FILE_NAME} names the cell {project.cell}, but the command line names {named}"
            help_ = f"remove --cell, or {remedy}"
            return Result(None, (Diagnostic("Y1373", message, project.source, span, help_),))
        place = cell_path if self._folder.is_absolute() else _from_here(cell_path)
        return Result(GivenCell(str(place), self.at(place), FILE_NAME, remedy, project.source, span))


def cell_loader(
    folder: Path, robot: Robot, texts: Mapping[Path, SourceFile] = NO_TEXTS, memory: Memory = NO_MEMORY
) -> CellLoader:
    """Return a loader for the cells of a program.

    Args:
        folder: folder of the program.
        robot: robot for the cells' joint values.
        texts: files that are open in an editor, by their paths; they replace the saved files.
        memory: cache of what was read.
    """
    return CellLoader(folder, robot, texts, memory)


def cell_for(folder: Path, project: Project, robot: Robot, named: str | None) -> Result[GivenCell]:
    """Read the cell for work that has no program yet: the cell `named`, or else the cell of the project.

    Args:
        folder: folder to which `named` is relative.
        project: project of the folder.
        robot: robot for the cell's joint values.
        named: path of the cell on the command line; None: not given.

    Returns:
        None without errors if neither names a cell; None with errors if the cell can't be used.
    """
    found = CellLoader(folder, robot).given(project, named)
    given = found.value
    if given is None:
        return found
    told = in_order(given.findings)
    return Result(None if has_errors(told) else given, told)


def holds_still(cell: Cell) -> bool:
    """Return True if a cell file and its mesh files haven't changed on the disk since the cell was read."""
    read = read_text(Path(cell.source.name), "")
    if isinstance(read, Diagnostic) or read.text != cell.source.text:
        return False
    for body in (*cell.obstacles, *(part.body for part in cell.parts)):
        if isinstance(body.shape, Mesh):
            content = read_content(str(body.shape.path), LARGEST_MESH).value
            if content is None or hashlib.sha256(content).hexdigest() != body.shape.digest:
                return False
    return True


def session_cell(folder: Path, robot: Robot, named: str | None) -> Result[GivenCell]:
    """Read the cell for an interactive session in a folder: the cell `named`, or else the cell of the
    folder's yarc.toml.
    """
    project = find_project(folder)
    if project.value is None:
        return Result(None, project.diagnostics)
    return cell_for(folder, project.value, robot, named)


def is_same_file(path: Path, other: Path) -> bool:
    """Return True if two paths lead to the same file, or would lead to it if it existed."""
    return file_of(path) == file_of(other)


def file_of(place: Path) -> Path:
    """Return the file that a path leads to after all symbolic links. If there is none (an invalid name, or a
    circle of links), return the path itself.
    """
    try:
        return place.resolve()
    except (OSError, ValueError, RuntimeError):
        return place


def _from_here(place: Path) -> Path:
    """Return a path relative to the working folder if it is inside this folder."""
    here = Path.cwd()
    return place.relative_to(here) if place.is_relative_to(here) else place


def check_cell(source: SourceFile, folder: Path, robot: Robot | None = None) -> tuple[Diagnostic, ...]:
    """Check a cell.toml's text by itself, for example while it is being edited.

    Args:
        source: the text.
        folder: its folder, to which mesh files are relative.
        robot: robot for joint values; None: check only what is valid for any robot.
    """
    return _whole(read_cell(source, folder, Names(is_word, robot)), robot)


def check_project(
    source: SourceFile, folder: Path, texts: Mapping[Path, SourceFile] = NO_TEXTS
) -> tuple[Diagnostic, ...]:
    """Check the text of a yarc.toml without any program, including whether the cell that it names can be
    read.

    Args:
        source: the text.
        folder: its folder.
        texts: files that are open in an editor; a cell among them needn't be saved.
    """
    read = read_project(source, folder)
    project = read.value
    if project is None or project.cell is None or (folder / project.cell).absolute() in texts:
        return read.diagnostics
    cell = load_cell(folder / project.cell, Names(is_word))
    missing = [one for one in cell.diagnostics if one.source is None]
    return (
        *read.diagnostics,
        *(replace(one, source=source, span=project.span_of("cell")) for one in missing),
    )


def check_description(path: str, robot_name: str | None) -> tuple[Diagnostic, ...]:
    """Check a cell.toml, a robot.toml or a yarc.toml without any program.

    Args:
        path: the file. robot.toml describes a robot, yarc.toml a project, and any other name a cell.
        robot_name: robot for the joint values of a cell; None: check only what is valid for any robot.
    """
    if Path(path).name.lower() == DESCRIPTION:
        return load_robot(path).diagnostics
    if Path(path).name == FILE_NAME:
        read = read_source(path)
        return read.diagnostics if read.value is None else check_project(read.value, Path(path).parent)
    robot: Robot | None = None
    if robot_name is not None:
        found = load_robot(robot_name)
        if found.value is None:
            return found.diagnostics
        robot = found.value
    return _whole(load_cell(Path(path), Names(is_word, robot)), robot)


def _whole(loaded: Result[Cell], robot: Robot | None) -> tuple[Diagnostic, ...]:
    """Return all findings about a cell that can be made without a program."""
    findings = [*loaded.diagnostics]
    if robot is not None:
        findings += _of_zones(loaded, robot)
        if loaded.value is not None and not has_errors(findings):
            from yarclang.collision.zones.possible import home_in_zones

            findings += home_in_zones(robot, loaded.value)
    return in_order(findings)


def _of_zones(loaded: Result[Cell], robot: Robot) -> list[Diagnostic]:
    """Return the findings about the zones of a cell that otherwise has no errors."""
    cell = loaded.value
    if cell is None or not cell.zones or has_errors(loaded.diagnostics):
        return []
    from yarclang.collision.zones.possible import impossible_zones

    return list(impossible_zones(robot, cell))
