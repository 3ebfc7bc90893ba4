"""The parts of a cell while its robot runs: as its coordinator told, and as grippers have moved them since. It knows no clock."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.cell.model import Cell, Item, Parts
from yarclang.coordinator.messages import replies
from yarclang.handling.parts import BUILT_IN, arrive, close, first_parts, open_, remove
from yarclang.handling.walk import flange_pose
from yarclang.robot.model import Array, Robot

_LEFT = 0.05
"""A gripper that is farther than this from where it took a part has left the place [m], and the next part may come."""


class LiveParts:
    """Where the parts of a cell are now.

    Args:
        robot: that carries them.
        cell: whose parts they are.

    Attributes:
        parts: where they are, as far as it is known.
        doubt: why nobody knows where they are; empty: it is known.
        is_late: True if they are where they were before what is under way began.
    """

    def __init__(self, robot: Robot, cell: Cell) -> None:
        self._robot, self._cell = robot, cell
        self._took: Array | None = None
        self.parts = first_parts(cell)
        self.doubt = ""
        self.is_late = False

    @property
    def rows(self) -> list[tuple[str, str]]:
        """What is to be said of the parts: name and value."""
        rows = [("holds", ", ".join(names))] if (names := [one.name for one in self.parts.held()]) else []
        if self.doubt:
            rows.append(("parts", f"nobody knows where they are: {self.doubt}"))
        elif self.is_late:
            rows.append(("parts", "as before this began; SETs from now on are followed"))
        return rows

    def told(self, told: replies.Parts, *, is_late: bool = False) -> None:
        """Take over where a coordinator says that the parts are; names that the cell doesn't have are left out.

        Args:
            told: by the coordinator.
            is_late: True if something has been under way, which the coordinator takes note of at its end.
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
        """Hear that an output was set while the joints are at `q` (n,) [rad or m]: a gripper closes or opens, or a machine takes parts away."""
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
        """Hear where the joints are (n,) [rad or m]: the next part comes as soon as the gripper has left its place."""
        if self._took is None or not self.parts.expected:
            return
        away = flange_pose(self._robot, q)[:3, 3] - self._took
        if float(np.linalg.norm(away)) > _LEFT:
            self._took = None
            self.parts = arrive(self.parts, ())


def _place(item: Item) -> tuple[str, str | None, bool, bytes]:
    return item.name, item.gripper, item.is_sure, item.pose
