"""Switches that show and hide groups of nodes in the picture. A node may belong to several groups, and is
visible if all of them are switched on.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from yarclang.view.stage import Item

GROUPS = {
    "robot": "robot",
    "tool": "tool",
    "planned": "planned robot",
    "obstacle": "obstacles",
    "part": "parts",
    "zone": "zones",
    "rule": "rules (KEEP)",
    "shape": "collision shapes",
    "axes": "frames",
    "other_axes": "other frames",
    "way": "path",
    "planned_way": "planned path",
    "marks": "findings",
    "names": "names",
    "grid": "floor",
}
"""Groups that can be hidden, with their names for people."""
OFF_AT_FIRST = frozenset({"other_axes", "shape"})
_OF_RUN = {"robot": "actual robot", "way": "actual path"}
"""Names of groups in a picture that also contains a planned robot."""


class Switches:
    """The groups of a picture's nodes.

    Args:
        hidden: groups that are switched off.
    """

    def __init__(self, hidden: Iterable[str] = OFF_AT_FIRST) -> None:
        self._hidden = set(hidden)
        self._nodes: dict[str, list[tuple[Any, tuple[str, ...]]]] = {name: [] for name in GROUPS}
        self._offered: set[str] = set()

    def offer(self, name: str) -> None:
        """Show a switch for a group that will have nodes later."""
        self._offered.add(name)

    @property
    def groups(self) -> dict[str, str]:
        """Return the groups that have nodes or will have some, with their names for people."""
        found = {name: text for name, text in GROUPS.items() if self._nodes[name] or name in self._offered}
        return found | {name: text for name, text in _OF_RUN.items() if "planned" in found and name in found}

    @property
    def hidden(self) -> frozenset[str]:
        """Return the groups that are switched off."""
        return frozenset(self._hidden)

    def is_shown(self, *groups: str) -> bool:
        """Return True if all of the given groups are switched on."""
        return self._hidden.isdisjoint(groups)

    def add(self, node: Any, *groups: str) -> None:
        """Add a node to its groups."""
        for name in groups:
            self._nodes[name].append((node, groups))
        if not self.is_shown(*groups):
            node.visible = False

    def switch(self, name: str, is_shown: bool) -> None:
        """Switch a group on or off, with its nodes. Nodes of workpieces are left out, since `Parts` switches
        them.
        """
        (self._hidden.discard if is_shown else self._hidden.add)(name)
        for node, groups in self._nodes[name]:
            if "part" not in groups:
                node.visible = self.is_shown(*groups)

    def forget(self, name: str) -> None:
        """Forget the nodes of a group after their removal from the picture. The group's switch is kept."""
        for each, nodes in self._nodes.items():
            self._nodes[each] = [(node, groups) for node, groups in nodes if name not in groups]


class Parts:
    """The nodes of workpieces. Each node is visible while its workpiece is at the node's place. Only changes
    are sent.

    Args:
        switches: switches of the picture.
    """

    def __init__(self, switches: Switches) -> None:
        self._switches = switches
        self._nodes: list[tuple[Any, tuple[str, ...]]] = []
        self._begins: list[float] = []
        self._ends: list[float] = []
        self._visible = self._switched = np.zeros(0, dtype=np.bool_)
        self._time = 0.0

    def give(self, item: Item, node: Any, *groups: str) -> None:
        """Add a node of a workpiece. It isn't visible yet."""
        self._nodes.append((node, groups))
        self._begins.append(item.begins)
        self._ends.append(item.ends)
        self._visible = np.append(self._visible, False)
        self._switched = np.append(self._switched, self._switches.is_shown(*groups))
        self._switches.add(node, *groups)

    def move_to(self, time: float) -> None:
        """Show the workpieces as they are at a time [s]."""
        self._time = time
        wanted = (np.array(self._begins) <= time) & (time < np.array(self._ends)) & self._switched
        for number in np.flatnonzero(wanted != self._visible).tolist():
            self._nodes[number][0].visible = bool(wanted[number])
        self._visible = wanted

    def look(self) -> None:
        """Show the workpieces whose groups are switched on, and hide all others."""
        shown = [self._switches.is_shown(*groups) for _, groups in self._nodes]
        self._switched = np.array(shown, dtype=np.bool_)
        self.move_to(self._time)

    def clear(self) -> None:
        """Remove all workpieces."""
        # names are children of their workpieces, and must be removed first
        for node, _ in reversed(self._nodes):
            node.remove()
        self._switches.forget("part")
        self._nodes, self._begins, self._ends = [], [], []
        self._visible = self._switched = np.zeros(0, dtype=np.bool_)
