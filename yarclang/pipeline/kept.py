"""Robots, cells and trajectories that were read before, as long as none of their files has changed.

They are the same values then, so that what was worked out for them holds.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from pathlib import Path

from yarclang.cell.model import Cell
from yarclang.diagnostics import Result
from yarclang.memory import NO_MEMORY, Memory
from yarclang.robot.model import Robot
from yarclang.semantics.trajectory_file import TrajectoryFile
from yarclang.shapes import Mesh, Shape

Stamp = Hashable


def robot_kept(
    memory: Memory, path: Path | None, text: str | None, load: Callable[[], Result[Robot]]
) -> Result[Robot]:
    """A robot that was loaded before, else the one that `load` gives; what has errors is loaded each time.

    Args:
        memory: keeps it.
        path: its robot.toml; None where there is none.
        text: what stands in it, where that isn't what is saved.
        load: reads it.
    """
    if path is None or memory is NO_MEMORY:
        return load()
    key = ("robot", path, path.absolute(), text)
    kept: tuple[Result[Robot], tuple[Path, ...], Stamp] | None = memory.get(key)
    if kept is not None and stamp_of(kept[1]) == kept[2]:
        return kept[0]
    before = stamp_of(_beside((path.parent,)))
    loaded = load()
    robot = loaded.value
    if robot is None:
        return loaded
    shapes = [one.shape for one in robot.shapes]
    shapes += [part.shape for tool in robot.tools for part in tool.shapes]
    folders = tuple(dict.fromkeys((path.parent, (path.parent / robot.urdf).parent)))
    files = (*folders, *_beside(folders), *_meshes(shapes))
    if stamp_of(_beside((path.parent,))) == before:  # nobody wrote meanwhile
        memory.keep(key, (loaded, files, stamp_of(files)))
    return loaded


def cell_kept(
    memory: Memory, path: Path, robot: Robot, text: str | None, load: Callable[[], Result[Cell]]
) -> Result[Cell]:
    """A cell that was read before for the same robot; else as `robot_kept`."""
    if memory is NO_MEMORY:
        return load()
    key = ("cell", path, path.absolute(), robot, text)
    kept: tuple[Result[Cell], tuple[Path, ...], Stamp] | None = memory.get(key)
    if kept is not None and stamp_of(kept[1]) == kept[2]:
        return kept[0]
    before = stamp_of((path,))
    loaded = load()
    cell = loaded.value
    if cell is not None and stamp_of((path,)) == before:
        files = (path, *meshes_of(cell))
        memory.keep(key, (loaded, files, stamp_of(files)))
    return loaded


def trajectory_kept(
    memory: Memory, path: Path, text: str | None, load: Callable[[], Result[TrajectoryFile]]
) -> Result[TrajectoryFile]:
    """A trajectory file that was read before; else as `robot_kept`."""
    if memory is NO_MEMORY:
        return load()
    key = ("trajectory", path, path.absolute(), text)
    before = stamp_of((path,))
    kept: tuple[Result[TrajectoryFile], Stamp] | None = memory.get(key)
    if kept is not None and (text is not None or kept[1] == before):
        return kept[0]
    loaded = load()
    if loaded.value is not None and stamp_of((path,)) == before:
        memory.keep(key, (loaded, before))
    return loaded


def meshes_of(cell: Cell) -> tuple[Path, ...]:
    """Return the mesh files of a cell's obstacles and parts."""
    return tuple(_meshes(one.shape for one in (*cell.obstacles, *(part.body for part in cell.parts))))


def _meshes(shapes: Iterable[Shape]) -> list[Path]:
    return [shape.path for shape in shapes if isinstance(shape, Mesh)]


def _beside(folders: Iterable[Path]) -> tuple[Path, ...]:
    """The files in some folders: a URDF may stand anywhere among them."""
    found: list[Path] = []
    for folder in folders:
        try:
            found += sorted(path for path in folder.iterdir() if path.suffix.lower() in _READ)
        except OSError:
            continue
    return tuple(found)


_READ = frozenset([".toml", ".urdf", ".xml", ".srdf"])
"""What a robot is read of, besides meshes."""


def stamp_of(files: Iterable[Path]) -> Stamp:
    """Return a value that changes when one of the files does."""
    stamps: list[Hashable] = []
    for path in files:
        try:
            seen = path.stat()
        except OSError:
            stamps.append((path, None))
        else:
            stamps.append((path, seen.st_mtime_ns, seen.st_size, seen.st_ino))
    return tuple(stamps)
