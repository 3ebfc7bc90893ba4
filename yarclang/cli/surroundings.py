"""Create the machines around a simulated robot from the options of a command line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from yarclang.cell.model import Cell
from yarclang.diagnostics import Diagnostic, Result
from yarclang.robot.model import Robot
from yarclang.simulated_cell.camera import CameraForm
from yarclang.simulated_cell.cameras import load_cameras
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulated_cell.script import Change, Known, load_script, read_setting


def surroundings_of(
    options: dict[str, Any], known: Known, robot: Robot | None, cell: Cell | None, *, waits: bool
) -> Result[SimulatedCell]:
    """Return the machines around a simulated robot: those of the options --set and --inputs, and the sensors
    of a cell.

    Args:
        options: options of the command line.
        known: names that may be used.
        robot: the simulated robot.
        cell: cell whose sensors set inputs.
        waits: True if times count from the beginning of a run, False if from the beginning of the simulation.

    Returns:
        None with findings if a name or the script is wrong.
    """
    settings: list[Change] = []
    script: tuple[Change, ...] = ()
    found: list[Diagnostic] = []
    for text in options["set"]:
        read = read_setting(text, known)
        found += read.diagnostics
        settings += read.value or ()
    if options["inputs"] is not None:
        loaded = load_script(Path(options["inputs"]), known)
        found += loaded.diagnostics
        script = loaded.value or ()
    cameras: tuple[CameraForm, ...] = ()
    if options["inputs"] is not None and not found:
        seen = load_cameras(Path(options["inputs"]), known, cell)
        found += seen.diagnostics
        cameras = seen.value or ()
    if found:
        return Result(None, tuple(found))
    return Result(
        SimulatedCell(script, known, settings=settings, cell=cell, robot=robot, waits=waits, cameras=cameras)
    )
