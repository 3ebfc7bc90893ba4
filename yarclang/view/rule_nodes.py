"""Draw the path constraints (KEEP rules) that are in force at the shown instant. Each has a translucent cone
or plane, and the line that must stay in the cone or above the plane.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from yarclang.robot.model import Array
from yarclang.view import colours
from yarclang.view.placing import position_and_turn
from yarclang.view.rules import MOST_SHOWN
from yarclang.view.stage import Stage
from yarclang.view.switches import Switches

GROUP = "rule"
_OPACITY = 0.16
_WIDTH = 3.0
"""Width of the line [pixels]."""


class RuleNodes:
    """The viser nodes of the path constraints (KEEP rules) that are in force. Rules that aren't in force have
    no nodes, since a program may have thousands of them.

    Args:
        scene: viser's scene.
        stage: the scene as data.
        switches: switches of the picture.
    """

    def __init__(self, scene: Any, stage: Stage, switches: Switches) -> None:
        self._scene, self._robot, self._rules, self._switches = scene, stage.robot, stage.rules, switches
        self._nodes: dict[int, tuple[Any, Any]] = {}
        if stage.rules.held:
            switches.offer(GROUP)

    def move_to(self, time: float, q: Array) -> None:
        """Draw the path constraints (KEEP rules) in force at a time [s], at joint positions (n,) [rad or
        m].
        """
        holds = self._rules.at(time)[:MOST_SHOWN]
        if gone := self._nodes.keys() - set(holds):
            self._switches.forget(GROUP)
            for number in gone:
                for node in self._nodes.pop(number):
                    node.remove()
            for nodes in self._nodes.values():
                for node in nodes:
                    self._switches.add(node, GROUP)
        for number in holds:
            rule = self._rules.shown[number]
            now = rule.at(self._robot, q)
            position, wxyz = position_and_turn(now.base_from_surface)
            colour = colours.ZONES["allowed"] if now.is_kept else colours.TOUCHING
            if number not in self._nodes:
                self._nodes[number] = self._drawn(number, now.pointer)
                for node in self._nodes[number]:
                    self._switches.add(node, GROUP)
            surface, line = self._nodes[number]
            surface.position, surface.wxyz, surface.color = position, wxyz, colour
            line.points = now.pointer[None].astype(np.float32)
            line.colors = np.array(colour, dtype=np.uint8)

    def _drawn(self, number: int, pointer: Array) -> tuple[Any, Any]:
        solid = self._rules.shown[number].surface()
        surface = self._scene.add_mesh_simple(
            f"/rule_{number}/surface",
            solid.vertices.astype(np.float32),
            solid.faces.astype(np.uint32),
            color=colours.ZONES["allowed"],
            opacity=_OPACITY,
            side="double",
            flat_shading=False,
            cast_shadow=False,
            receive_shadow=False,
        )
        line = self._scene.add_line_segments(
            f"/rule_{number}/line",
            pointer[None].astype(np.float32),
            colours.ZONES["allowed"],
            thickness=_WIDTH,
            thickness_units="screen",
        )
        return surface, line
