"""The robot, its cell, the program's frames, and notes, as each picture shows them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.cell.model import Cell
from yarclang.collision.scene import Scene, scene_of
from yarclang.hir import Program
from yarclang.report.pictures.drawn_frame import DrawnFrame, led_by
from yarclang.robot.model import Robot
from yarclang.view.bodies import axes_of, cell_items, robot_items
from yarclang.view.stage import Axes, Item


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """The surroundings in a scene; see `Stage`.

    Attributes:
        items: bodies and borders of zones.
        axes: coordinate frames.
        scene: bodies of the collision check; None if there is no body that could collide.
        notes: what can't be shown, with reasons.
        cell: the cell; None without one.
    """

    items: tuple[Item, ...]
    axes: tuple[Axes, ...]
    scene: Scene | None
    notes: tuple[str, ...]
    cell: Cell | None


def surroundings_of(
    robot: Robot, program: Program | None, followed: str, missing: str = "", given: Cell | None = None
) -> Surroundings:
    """Return the surroundings in a picture: robot, cell, frames and notes.

    Args:
        robot: the robot.
        program: program with frames and a cell; None without one.
        followed: name of the frame whose path is shown.
        missing: reason why there is no program; empty if none is needed.
        given: cell for pictures without a program.
    """
    cell = program.cell if program is not None else given
    links, unread = robot_items(robot)
    around, placeless = cell_items(robot, cell) if cell is not None else ((), ())
    axes, more = axes_of(robot, program, cell, followed)
    scene = scene_of(robot, cell).value
    what = "cell and frames" if cell is None else "frames"
    without = (f"without the program's {what}: {missing}",) if program is None and missing else ()
    return Surroundings(
        (*links, *around),
        axes,
        scene if scene is not None and len(scene.pairs.first) else None,
        (*without, *unread, *placeless, *more),
        cell,
    )


def followed_frame(robot: Robot, program: Program | None) -> DrawnFrame:
    """Return the frame whose path is drawn: the frame that a program's first Cartesian motion moves. Without
    such a motion, it is {TCP}, or the flange if the robot has no {TCP}.
    """
    for step in program.steps if program is not None else ():
        if (led := led_by(step)) is not None:
            return led
    name = "TCP" if "TCP" in robot.flange_from_frame else "FLANGE"
    return DrawnFrame(name, robot.flange_from_frame.get(name, np.eye(4)))
