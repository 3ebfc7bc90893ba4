"""Draw a scene in three dimensions with viser. Bodies and frames are drawn once, and then only moved with the
joints.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.model import Array
from yarclang.view import colours
from yarclang.view.bodies import shapes_beside
from yarclang.view.camera import first_view, shown_box
from yarclang.view.detail import FINEST, drawn_lines, exact_lines
from yarclang.view.labels import SHARE, Label, spots
from yarclang.view.lettering import Lettering, short
from yarclang.view.placing import move_nodes, position_and_turn
from yarclang.view.rule_nodes import RuleNodes
from yarclang.view.stage import Item, Rows, Stage, Way, moved_by
from yarclang.view.switches import OFF_AT_FIRST, Parts, Switches
from yarclang.view.triads import names_of, triads_of

if TYPE_CHECKING:
    import viser

_AXES_LENGTH = 0.12
_HANDLES = 0.25
"""Length of the handles of a frame that can be dragged [m]."""
_WIDTH, _THIN, _THICK = 5.0, 2.5, 10.0
"""Widths of lines [pixels]: of the path, of the planned path beside it, and of the chosen command."""


_AROUND = 200
"""Number of commands before and after the chosen command whose path is drawn exactly, if the whole path is
simplified.
"""
_MOST_MARKS = 200
"""Largest number of findings that are drawn on the path, the most severe ones first. The list contains all
findings.
"""


class Picture:
    """All viser nodes of the drawn scene.

    Args:
        server: web server of the page.
        stage: the scene that is drawn.
        hidden: groups of nodes that are switched off.
    """

    def __init__(self, server: viser.ViserServer, stage: Stage, hidden: Iterable[str] = OFF_AT_FIRST) -> None:
        self._scene, self._server, self._stage = server.scene, server, stage
        self.switches = Switches(hidden)
        self._bodies: dict[str, list[tuple[Any, Item]]] = {}
        self._touching: frozenset[str] = frozenset()
        self._chosen: list[Any] = []
        self._written: Any = None
        self._handles: Any = None
        self._lettering = Lettering(server.scene, stage.marks, self.switches)
        self._named: set[tuple[str, str]] = set()
        self._parts = Parts(self.switches)
        self._view = first_view(stage)
        low, high = shown_box(stage, whole=True)
        self._size = float(np.linalg.norm(high - low)) / 2.0
        self._top = np.array([0.0, 0.0, shown_box(stage, whole=False)[1][2] + 0.1])
        self._joints = [
            self._scene.add_frame(f"/joint_{number}", show_axes=False)
            for number in range(stage.robot.size + 1)
        ]
        self._ghosts = self._draw_ghosts() if stage.ghost is not None else []
        self._draw_surroundings()
        for number, item in enumerate(stage.items):
            self._draw_item(number, item)
        shapes = shapes_beside(stage.robot, stage.items)
        for number, item in enumerate(shapes, len(stage.items)):
            self._draw_item(number, item)
        self._count = len(stage.items) + len(shapes)
        self._rules = RuleNodes(server.scene, stage, self.switches)
        self._draw_axes()
        self._way = self._draw_way("way", stage.way, _WIDTH)
        self._first = exact_lines(stage.way)
        self._drawn = drawn_lines(stage.way)
        self._owners = stage.way.piece[np.searchsorted(stage.way.breaks, self._first, side="right") - 1]
        self._piece, self._shades = -1, np.zeros((len(stage.way.points), 3), dtype=np.uint8)
        if stage.ghost_way is not None:
            ghost_way = self._draw_way("planned_way", stage.ghost_way, _THIN)
            if ghost_way is not None:
                ghost_way.colors = np.array(colours.PLANNED_WAY, dtype=np.uint8)
        self._draw_marks()
        self._lettering.write(*self._view)

    def show_group(self, name: str, is_shown: bool) -> None:
        """Show or hide all nodes of a group."""
        self.switches.switch(name, is_shown)
        if name in {"part", "names"}:
            self._parts.look()
        if name == "marks":
            self._lettering.look()

    def move_to(self, time: float) -> None:
        """Move the bodies to their places at a time [s]."""
        times, chain = np.array([time]), self._stage.robot.chain
        with self._server.atomic():
            q = self._stage.track.at(times)[0][0]
            move_nodes(self._joints, moved_by(chain, q))
            self._rules.move_to(time, q)
            if self._stage.ghost is not None:
                move_nodes(self._ghosts, moved_by(chain, self._stage.ghost.at(times)[0][0]))
            self._parts.move_to(time)

    def stand_at(self, q: Array) -> None:
        """Move the bodies to their places at joint positions (n,) [rad or m]."""
        with self._server.atomic():
            move_nodes(self._joints, moved_by(self._stage.robot.chain, q))

    def show_parts(self, items: Iterable[Item]) -> None:
        """Replace the workpieces in the picture."""
        with self._server.atomic():
            self._parts.clear()
            self._bodies = {
                name: kept
                for name, nodes in self._bodies.items()
                if (kept := [one for one in nodes if one[1].kind != "part"])
            }
            for item in items:
                self._count += 1
                self._draw_item(self._count, item)
            self._parts.move_to(0.0)

    def fade(self, text: str) -> None:
        """Draw all bodies grey and write the reason for this above the robot. An empty text restores the
        colours.
        """
        self._touching = frozenset()
        for nodes in self._bodies.values():
            for node, item in nodes:
                node.color = colours.STALE if text else item.colour
        self.write(text)

    def write(self, text: str) -> None:
        """Write a text above the robot; remove the text if it is empty."""
        if self._written is not None:
            self._written.remove()
            self._written = None
        if text:
            self._written = self._scene.add_label(
                "/written", text, position=self._top, font_screen_scale=1.2, anchor="bottom-center"
            )

    def colour_bodies(self, touching: frozenset[str]) -> None:
        """Highlight the bodies that are too near to others. All other bodies get their own colours back."""
        for name in touching ^ self._touching:
            for node, item in self._bodies.get(name, []):
                node.color = colours.TOUCHING if name in touching else item.colour
        self._touching = touching

    def colour_way(self, values: Array, most: float, ramp: str) -> None:
        """Colour the drawn path by values, such as the frame's speed.

        Args:
            values: (N,) value of each point of the path.
            most: value at the end of the colour scale.
            ramp: name of the colour ramp.
        """
        if self._way is not None:
            self._shades = shades = colours.linear(colours.coloured(values, most, ramp))
            self._drawn = drawn = drawn_lines(self._stage.way, values, most)
            with self._server.atomic():
                self._way.points = _between(self._stage.way.points, drawn.first, drawn.second)
                self._way.colors = _between(shades, drawn.first, drawn.second)
            self.choose_piece(self._piece)

    def choose_piece(self, number: int) -> None:
        """Highlight the path of a command; for -1 highlight none."""
        self._piece = number
        self._lettering.follow(number)
        for node in self._chosen:
            node.remove()
        self._chosen = []
        if number < 0:
            return
        self._draw_exactly("/chosen", self._owners == number, _THICK)
        if self._drawn.off > FINEST:
            # Users look at this part of the path more closely than at the whole path.
            self._draw_exactly("/around", np.abs(self._owners - number) <= _AROUND, _WIDTH)

    def _draw_exactly(self, name: str, wanted: NDArray[np.bool_], width: float) -> None:
        """Draw some sections of the path without simplification, through all of its points.

        Args:
            name: name of the node.
            wanted: True for the lines between points that are drawn.
            width: width of the lines [pixels].
        """
        first = self._first[wanted]
        if len(first):
            self._chosen.append(
                self._scene.add_line_segments(
                    name,
                    _between(self._stage.way.points, first, first + 1),
                    _between(self._shades, first, first + 1),
                    thickness=width,
                    thickness_units="screen",
                )
            )

    def choose_mark(self, number: int) -> None:
        """Write the text of a finding at its place in the scene; for -1 write none."""
        if self._written is not None:
            self._written.remove()
            self._written = None
        mark = self._stage.marks[number] if number >= 0 else None
        if mark is not None and mark.place is not None:
            self._written = self._scene.add_label(
                "/written", short(mark), position=mark.place, font_screen_scale=1.0, anchor="top-left"
            )

    def drag(self, number: int, dragged: Callable[[Array, Array], object]) -> None:
        """Show the handles by which users drag a frame; for -1 show none.

        Args:
            number: index of the frame in the scene's list of draggable frames.
            dragged: function that is called with the frame's new position (3,) [m] and quaternion w x y z,
                with all joints at zero.
        """
        if self._handles is not None:
            self._handles.remove()
            self._handles = None
        if number < 0:
            return
        one = self._stage.draggable[number]
        position, wxyz = position_and_turn(one.base_from_frame)
        handles: Any = self._scene.add_transform_controls(
            f"/joint_{one.joint}/handles", scale=_HANDLES, depth_test=False, position=position, wxyz=wxyz
        )
        handles.on_update(lambda _: dragged(np.array(handles.position), np.array(handles.wxyz)))
        self._handles = handles

    def _draw_surroundings(self) -> None:
        self._scene.set_up_direction("+z")
        self._scene.configure_default_lights(enabled=True, cast_shadow=False)
        width = 2.0 * float(np.ceil(1.2 * self._size))
        grid = self._scene.add_grid(
            "/grid",
            width=width,
            height=width,
            cell_size=0.1,
            section_size=0.5,
            cell_color=(222, 226, 230),
            section_color=(184, 190, 196),
            shadow_opacity=0.0,
        )
        self.switches.add(grid, "grid")
        eye, middle = self._view
        camera = self._server.initial_camera
        camera.look_at = middle
        camera.position = eye
        camera.up = (0.0, 0.0, 1.0)

    def _draw_item(self, number: int, item: Item) -> None:
        node = self._add_mesh(f"/joint_{item.joint}/item_{number}", item, item.colour, item.opacity)
        self._bodies.setdefault(item.name, []).append((node, item))
        if item.kind == "part":
            self._parts.give(item, node, "part")
            if item.is_named:
                self._parts.give(item, self._part_label(number, item), "part", "names")
            return
        self.switches.add(node, item.kind)
        if item.kind in {"zone", "obstacle"} and (item.kind, item.name) not in self._named:
            self._named.add((item.kind, item.name))
            top = (item.base_from_item[:3, :3] @ item.solid.vertices.T).T + item.base_from_item[:3, 3]
            where = top[int(np.argmax(top[:, 2] + 1e-3 * top[:, 0]))]
            self._lettering.give(Label(item.name, where, 0.8, "bottom-center"), item.kind, "names")

    def _part_label(self, number: int, item: Item) -> Any:
        top = item.solid.vertices[:, 2].max()
        return self._scene.add_label(
            f"/joint_{item.joint}/item_{number}/name",
            item.name if item.opacity >= 1.0 else f"{item.name}?",
            position=(0.0, 0.0, float(top)),
            font_screen_scale=0.7,
            anchor="bottom-center",
            visible=False,
        )

    def _add_mesh(self, name: str, item: Item, colour: tuple[int, int, int], opacity: float) -> Any:
        position, wxyz = position_and_turn(item.base_from_item)
        return self._scene.add_mesh_simple(
            name,
            item.solid.vertices.astype(np.float32),
            item.solid.faces.astype(np.uint32),
            color=colour,
            opacity=None if opacity >= 1.0 else opacity,
            side="double",
            flat_shading=False,
            cast_shadow=False,
            receive_shadow=False,
            position=position,
            wxyz=wxyz,
            visible=item.kind != "part",
        )

    def _draw_ghosts(self) -> list[Any]:
        """Draw the planned robot, transparently, and return its nodes."""
        nodes = [
            self._scene.add_frame(f"/planned_{number}", show_axes=False)
            for number in range(self._stage.robot.size + 1)
        ]
        for number, item in enumerate(self._stage.items):
            if item.kind in {"robot", "tool"} and item.joint > 0:
                node = self._add_mesh(f"/planned_{item.joint}/item_{number}", item, colours.GHOST, 0.22)
                self.switches.add(node, "planned")
        return nodes

    def _draw_axes(self) -> None:
        axes = self._stage.axes
        for number, one in enumerate(triads_of(axes)):
            position, wxyz = position_and_turn(one.base_from_frame)
            length = _AXES_LENGTH * (1.0 if one.joint == 0 else 0.7)
            node = self._scene.add_frame(
                f"/joint_{one.joint}/axes_{number}",
                axes_length=length,
                axes_radius=length / 30.0,
                position=position,
                wxyz=wxyz,
            )
            self.switches.add(node, "axes" if one.matters else "other_axes")
        for number, name in enumerate(names_of(axes, SHARE * self._size)):
            groups = ("axes" if name.matters else "other_axes", "names")
            if name.joint == 0:
                self._lettering.give(Label(name.text, name.place, 0.7, "top-left"), *groups)
                continue
            label = self._scene.add_label(
                f"/joint_{name.joint}/name_{number}",
                name.text,
                position=name.place,
                font_screen_scale=0.7,
                # A moving frame has its label on the other side than a fixed frame, since the robot may move
                # it to a fixed frame.
                anchor="top-right" if name.matters else "bottom-right",
            )
            self.switches.add(label, *groups)

    def _draw_way(self, name: str, way: Way, width: float) -> Any:
        drawn = drawn_lines(way)
        if not len(drawn.first):
            return None
        points = _between(way.points, drawn.first, drawn.second)
        node = self._scene.add_line_segments(
            f"/{name}", points, (90, 90, 90), thickness=width, thickness_units="screen"
        )
        self.switches.add(node, name)
        return node

    def _draw_marks(self) -> None:
        marks = self._stage.marks
        placed = [number for number, mark in enumerate(marks) if mark.place is not None][:_MOST_MARKS]
        places = np.array([marks[number].place for number in placed]).reshape(-1, 3)
        for number, place in zip(placed, places, strict=True):
            ball = self._scene.add_icosphere(
                f"/marks/{number}",
                radius=0.012 + 0.004 * self._size,
                color=colours.SEVERITIES[marks[number].severity],
                position=place,
                cast_shadow=False,
            )
            self.switches.add(ball, "marks")
        for spot in spots(places, SHARE * self._size):
            self._lettering.give_marks([placed[one] for one in spot], places[spot[0]])


def _between(values: Any, first: Rows, second: Rows) -> Any:
    """Return the values at both ends of line segments, stacked to (L, 2, 3)."""
    return np.stack([values[first], values[second]], axis=1)
