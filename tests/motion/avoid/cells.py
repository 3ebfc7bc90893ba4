"""Cells for tests of motions around obstacles: a post in front of the arm, and walls."""

import numpy as np

from yarclang.cell.model import Cell, Mount, Obstacle
from yarclang.collision.zones.watched import tool_frame
from yarclang.diagnostics import Result
from yarclang.motion.avoid.room import room_of
from yarclang.robot.description import load_robot
from yarclang.shapes import Box
from yarclang.source import SourceFile

ROBOT = load_robot("INDUSTRIAL6").value
LEFT, RIGHT = (np.radians([side, 20, -20, 0, -30, 0]) for side in (-60, 60))


def box(name, xyz, size, margin=0.0):
    placed = np.eye(4)
    placed[:3, 3] = xyz
    return Obstacle(name, Box(np.array(size, float)), Mount(placed, False), margin)


POST = box("POST", [0, 0.7, 0.9], [0.12, 0.12, 1.8])
WALL = (
    box("WALL", [0, 0.9, 1.5], [0.04, 1.4, 3.0]),
    box("BACK_WALL", [0, -1.0, 1.5], [0.04, 1.4, 3.0]),
    box("LID", [0, 0, 2.9], [4.0, 4.0, 0.04]),
)
"""Walls that divide the room into two parts."""


def cell_of(*obstacles):
    return Cell(SourceFile("cell.toml", ""), {}, {}, {}, {}, obstacles, (), {})


def room(*obstacles):
    return room_of(ROBOT, cell_of(*obstacles), tool_frame(ROBOT))


def loading(*obstacles):
    """Return a function that returns the cell of a program."""
    return lambda name, source: Result(cell_of(*obstacles))
