"""Follow the workpieces of a cell while its robot runs: begin with the coordinator's report, and update it by
the grippers' actions.

This module reads no clock.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.cell.model import Cell, Item, Parts
from yarclang.coordinator.messages import replies
from yarclang.handling.parts import BUILT_IN, arrive, close, first_parts, open_, remove
from yarclang.handling.walk import flange_pose
from yarclang.robot.model import Array, Robot

_LEFT = 0.05
"""Distance by which the flange must move after a gripper has closed, before the next workpiece appears at
this place [m].
"""


class LiveParts:
    """The current places of a cell's workpieces.

    Args:
        robot: the robot that carries the workpieces.
        cell: cell with the workpieces.

    Attributes:
        parts: the workpieces whose places are known.
        doubt: reason why the places aren't known; empty if they are.
        is_late: True if the places were reported while a program was running. The program may have moved
            workpieces before the report.
    """

    def __init__(self, robot: Robot, cell: Cell) -> None:
        self._robot, self._cell = robot, cell
        self._took: Array | None = None
        self.parts = first_parts(cell)
        self.doubt = ""
        self.is_late = False

    @property
    def rows(self) -> list[tuple[str, str]]:
        """Return table rows about the workpieces: name and value."""
        rows = [("holds", ", ".join(names))] if (names := [one.name for one in self.parts.held()]) else []
        if self.doubt:
            rows.append(("parts", f"the places aren't certain: {self.doubt}"))
        elif self.is_late:
            rows.append(("parts", "as before this page was opened; later SETs are shown"))
        return rows

    def told(self, told: replies.Parts, *, is_late: bool = False) -> None:
        """Use the places of workpieces that a coordinator has reported. Workpieces that aren't in the cell's
        file are ignored.

        Args:
            told: the coordinator's message.
            is_late: True if a program is running. Only at the end of the program, the coordinator reports
                which workpieces the program has moved.
        """
        self.doubt = told.doubt or ""
        self.is_late = is_late
        if not told.moved:
            self.parts = first_parts(self._cell)
            return
        items = tuple(self._items(told))
        closed = frozenset(one.gripper for one in items if one.gripper)
        if [_place(one) for one in items] != [_place(one) for one in self.parts.items]:
            self.parts = Parts(items, closed, self.parts.expected)

    def _items(self, told: replies.Parts) -> Iterator[Item]:
        grippers = {name: one.variable for name, one in self._cell.outputs.items() if one.grip is not None}
        kinds = {one.body.name: one for one in self._cell.parts}
        for one in told.parts:
            kind, _, number = one.name.rpartition(" ")
            part = kinds.get(one.name) or kinds.get(kind)
            pose = np.array(one.pose, dtype=np.float64)
            if part is None or pose.shape != (4, 4) or not np.isfinite(pose).all():
                continue
            count = int(number) if part.count > 1 and number.isdecimal() else 1
            held = None if one.held is None else grippers.get(one.held, BUILT_IN)
            yield Item(part, count, pose.tobytes(), held, one.sure)

    def output_set(self, variable: str, value: float, q: Array) -> None:
        """Update the workpieces after an output was set: a gripper closes or opens, or a machine removes
        workpieces.

        Args:
            variable: variable of the output.
            value: new value of the output.
            q: (n,) joint positions at this moment [rad or m].
        """
        grip, removal = self._cell.grips.get(variable), self._cell.removals.get(variable)
        if grip is not None:
            flange = flange_pose(self._robot, q)
            if value != grip.value:
                self.parts = open_(self.parts, variable, flange)
            elif variable not in self.parts.closed:
                self.parts, _ = close(self.parts, variable, grip, flange, 0)
                self._took = flange[:3, 3]
        if removal is not None and value == removal.value:
            self.parts = remove(self.parts, removal)

    def stands(self, q: Array) -> None:
        """Update the workpieces for new joint positions (n,) [rad or m]. If the gripper has moved away from a
        place with a supply of workpieces, the next workpiece appears there.
        """
        if self._took is None or not self.parts.expected:
            return
        away = flange_pose(self._robot, q)[:3, 3] - self._took
        if float(np.linalg.norm(away)) > _LEFT:
            self._took = None
            self.parts = arrive(self.parts, ())


def _place(item: Item) -> tuple[str, str | None, bool, bytes]:
    return item.name, item.gripper, item.is_sure, item.pose
