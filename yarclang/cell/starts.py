"""Read start zones of a cell: ranges of joint positions from which a robot may move to the start of a program
without an order of the user.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from yarclang.cell.model import Array, StartZone
from yarclang.cell.windows import joint_window
from yarclang.robot.model import Robot

if TYPE_CHECKING:
    from yarclang.cell.measures import Measures
    from yarclang.cell.model import Cell
    from yarclang.cell.schema import StartTable
    from yarclang.toml.places import Path


def read_start(table: StartTable, path: Path, measures: Measures, robot: Robot | None) -> StartZone | None:
    """Read a start zone of a cell.toml, and report its mistakes. Return None if it has mistakes, or if the
    robot isn't known.

    The entry must name every joint. If it could omit a joint, the robot might start at any position of this
    joint, and nobody would have checked all these positions.
    """
    units = measures.of_entry(table.units, path)
    if table.name is None or table.joints is None:
        return None
    window = joint_window(table.joints, (*path, "joints"), units, measures, robot)
    if window is None or robot is None:
        return None
    open_ = [
        name
        for name, low, high in zip(robot.joint_names, window.lower, window.upper, strict=True)
        if not np.isfinite([low, high]).all()
    ]
    if open_:
        message = (
            f"The start zone {table.name[:40]} doesn't limit {', '.join(open_)}: it would apply at any "
            "position of these joints."
        )
        remedy = f"Name all {robot.size} joints, each with its smallest and its largest value."
        measures.file.say("Y1308", (*path, "joints"), message, remedy)
        return None
    return StartZone(table.name.upper(), window)


def start_zone(cell: Cell | None, q: Array) -> StartZone | None:
    """Return the start zone of a cell that contains the joint positions `q` (n,) [rad or m]; None if there
    is none.
    """
    for one in () if cell is None else cell.starts:
        if bool(((one.window.lower <= q) & (q <= one.window.upper)).all()):
            return one
    return None
