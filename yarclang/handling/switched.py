"""Compute where workpieces are after outputs were set, from the data that an observer of the robot
receives.
"""

from __future__ import annotations

from collections.abc import Iterable

from yarclang.cell.model import Cell, Parts, Present
from yarclang.handling.parts import remove
from yarclang.handling.present import presently
from yarclang.handling.walk import flange_pose, handling_of
from yarclang.robot.model import Array, Robot

Switched = tuple[str, float, Array]
"""An output's variable, its new value, and the robot's position at that time (n,) [rad or m]."""


def parts_after(robot: Robot, cell: Cell, parts: Parts, switched: Iterable[Switched]) -> Parts:
    """Return the state of a cell's workpieces after outputs were set.

    Args:
        robot: robot that carries the workpieces.
        cell: cell whose grippers and machines are driven by the outputs.
        parts: where the workpieces were before.
        switched: changes of outputs in the order of time. Outputs that move no workpiece are allowed.
    """
    for variable, value, q in switched:
        if variable in cell.grips:
            handling = handling_of(robot, presently(cell, Present(parts)), ())
            grasp = handling.at_pose(parts, 0, variable, value, flange_pose(robot, q))
            parts = parts if grasp is None else grasp.after
        removal = cell.removals.get(variable)
        if removal is not None and value == removal.value:
            parts = remove(parts, removal)
    return parts
