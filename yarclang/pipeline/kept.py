"""A cache of robots, cells and trajectories that stays valid as long as none of their files has changed.

While the files are unchanged, the cache returns the same objects. Other results that are cached for these
objects then stay valid too.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from pathlib import Path
from typing import TypeVar

from yarclang.cell.model import Cell
from yarclang.diagnostics import Result
from yarclang.memory import NO_MEMORY, Memory
from yarclang.robot.model import Robot
from yarclang.semantics.motions.trajectory_file import TrajectoryFile
from yarclang.shapes import Mesh, Shape

T = TypeVar("T")
Stamp = Hashable


def robot_kept(
    memory: Memory, path: Path | None, text: str | None, load: Callable[[], Result[Robot]]
) -> Result[Robot]:
    """Return a robot from the cache, or else from `load`. A robot with errors isn't cached.

    Args:
        memory: the cache.
        path: the robot's robot.toml; None if there is none.
        text: content of the file if it is open in an editor; None: the saved content.
        load: function that reads the robot.
    """
    if path is None:
        return load()

    def files(robot: Robot) -> tuple[Path, ...]:
        shapes = [one.shape for one in robot.shapes]
        shapes += [part.shape for tool in robot.tools for part in tool.shapes]
        folders = tuple(dict.fromkeys((path.parent, (path.parent / robot.urdf).parent)))
        return (*folders, *_beside(folders), *_meshes(shapes))

    key = ("robot", path, path.absolute(), text)
    return _kept(memory, key, load, lambda: _beside((path.parent,)), files)


def cell_kept(
    memory: Memory, path: Path, robot: Robot, text: str | None, load: Callable[[], Result[Cell]]
) -> Result[Cell]:
    """Return a cell from the cache, like `robot_kept`, if it was read for the same robot."""
    key = ("cell", path, path.absolute(), robot, text)
    return _kept(memory, key, load, lambda: (path,), lambda cell: (path, *meshes_of(cell)))


def trajectory_kept(
    memory: Memory, path: Path, text: str | None, load: Callable[[], Result[TrajectoryFile]]
) -> Result[TrajectoryFile]:
    """Return a trajectory file from the cache, like `robot_kept`."""
    files = (path,) if text is None else ()
    key = ("trajectory", path, path.absolute(), text)
    return _kept(memory, key, load, lambda: files, lambda _: files)


def _kept(
    memory: Memory,
    key: Hashable,
    load: Callable[[], Result[T]],
    begins_with: Callable[[], tuple[Path, ...]],
    made_of: Callable[[T], tuple[Path, ...]],
) -> Result[T]:
    """Return a result from the cache while its files are unchanged, or else from `load`.

    Args:
        memory: the cache.
        key: key of the result.
        load: function that computes the result.
        begins_with: function that returns the files that are known before `load`. If one of them changes
            during `load`, the result isn't cached.
        made_of: function that takes the result and returns all files from which it was read.
    """
    if memory is NO_MEMORY:
        return load()
    kept: tuple[Result[T], tuple[Path, ...], Stamp] | None = memory.get(key)
    if kept is not None and stamp_of(kept[1]) == kept[2]:
        return kept[0]
    before = stamp_of(begins_with())
    loaded = load()
    if loaded.value is not None and stamp_of(begins_with()) == before:
        files = made_of(loaded.value)
        memory.keep(key, (loaded, files, stamp_of(files)))
    return loaded


def meshes_of(cell: Cell) -> tuple[Path, ...]:
    """Return the mesh files of a cell's obstacles and parts."""
    return tuple(_meshes(one.shape for one in (*cell.obstacles, *(part.body for part in cell.parts))))


def _meshes(shapes: Iterable[Shape]) -> list[Path]:
    return [shape.path for shape in shapes if isinstance(shape, Mesh)]


def _beside(folders: Iterable[Path]) -> tuple[Path, ...]:
    """Return all files in a robot's folders that have a suffix in `_READ`, since the robot's URDF may refer
    to any of them.
    """
    files: list[Path] = []
    for folder in folders:
        try:
            files += sorted(path for path in folder.iterdir() if path.suffix.lower() in _READ)
        except OSError:
            continue
    return tuple(files)


_READ = frozenset([".toml", ".urdf", ".xml", ".srdf"])
"""Suffixes of the files from which a robot is read, besides meshes."""


def stamp_of(files: Iterable[Path]) -> Stamp:
    """Return a value that changes if one of the files changes."""
    stamps: list[Hashable] = []
    for path in files:
        try:
            seen = path.stat()
        except OSError:
            stamps.append((path, None))
        else:
            stamps.append((path, seen.st_mtime_ns, seen.st_size, seen.st_ino))
    return tuple(stamps)
