"""Where cells are: the path of a CELL line counts from the file that it stands in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from yarclang.cell.description import Names, load_cell, read_cell
from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.memory import NO_MEMORY, Memory
from yarclang.pipeline.kept import cell_kept
from yarclang.pipeline.sources import NO_TEXTS
from yarclang.robot.description import load_robot
from yarclang.robot.library import DESCRIPTION
from yarclang.robot.model import Robot
from yarclang.semantics.naming import is_word
from yarclang.source import SourceFile

SUFFIX = ".toml"


def cell_loader(
    folder: Path, robot: Robot, texts: Mapping[Path, SourceFile] = NO_TEXTS, memory: Memory = NO_MEMORY
) -> Callable[[str, SourceFile | None], Result[Cell]]:
    """How cells of a program in `folder` are read: the path of a CELL line, and the module that it stands in (None: the program).

    The same file gives the same cell, whatever paths lead to it. `texts` are files that are open somewhere, as for modules.
    """
    known: dict[Path, Result[Cell]] = {}

    def load(path: str, module: SourceFile | None) -> Result[Cell]:
        place = (folder if module is None else Path(module.name).parent) / path
        try:
            key = place.resolve()
        except (OSError, ValueError, RuntimeError):  # a name that can't be one, links in a circle
            key = place
        if key not in known:
            text, names = texts.get(place.absolute()) or texts.get(key), Names(is_word, robot)

            def read() -> Result[Cell]:
                return load_cell(place, names) if text is None else read_cell(text, place.parent, names)

            # findings name the file as it was asked for
            known[key] = cell_kept(memory, place, robot, None if text is None else text.text, read)
        return known[key]

    return load


def check_cell(source: SourceFile, folder: Path, robot: Robot | None = None) -> tuple[Diagnostic, ...]:
    """The findings of a cell.toml's text by itself, for example of one that is being edited.

    Args:
        source: the text.
        folder: where it stands; mesh files are seen from there.
        robot: for which joint values are checked; without one, all is checked that holds for any.
    """
    return _whole(read_cell(source, folder, Names(is_word, robot)), robot)


def check_description(path: str, robot_name: str | None) -> tuple[Diagnostic, ...]:
    """The findings of a cell.toml, or of a robot.toml, by itself.

    Args:
        path: the file; one that is called robot.toml is a robot's.
        robot_name: the robot for which joint values of a cell are checked; without one, all is checked that holds for any.
    """
    if Path(path).name.lower() == DESCRIPTION:
        return load_robot(path).diagnostics
    robot: Robot | None = None
    if robot_name is not None:
        found = load_robot(robot_name)
        if found.value is None:
            return found.diagnostics
        robot = found.value
    return _whole(load_cell(Path(path), Names(is_word, robot)), robot)


def _whole(loaded: Result[Cell], robot: Robot | None) -> tuple[Diagnostic, ...]:
    """All that is to be said of a cell by itself."""
    found = [*loaded.diagnostics]
    if robot is not None:
        found += _of_zones(loaded, robot)
        if loaded.value is not None and not has_errors(found):
            from yarclang.collision.zones.possible import home_in_zones

            found += home_in_zones(robot, loaded.value)
    return in_order(found)


def _of_zones(loaded: Result[Cell], robot: Robot) -> list[Diagnostic]:
    """What is wrong with zones that are right in form."""
    cell = loaded.value
    if cell is None or not cell.zones or has_errors(loaded.diagnostics):
        return []
    from yarclang.collision.zones.possible import impossible_zones

    return list(impossible_zones(robot, cell))
