"""The stage in three dimensions, drawn by viser: bodies and axes are drawn once, then only what joints move is moved."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from yarclang.robot.model import Array
from yarclang.view import colours
from yarclang.view.camera import first_view, shown_box
from yarclang.view.labels import SHARE, Label, spots
from yarclang.view.lettering import Lettering, short
from yarclang.view.stage import Item, Stage, Way, moved_by

if TYPE_CHECKING:
    import viser

_AXES_LENGTH = 0.12
_WIDTH, _THIN, _THICK = 5.0, 2.5, 10.0
"""Widths of lines [pixels]: of the path, of the planned path beside it, of the chosen command."""

GROUPS = {
    "robot": "robot",
    "tool": "tool",
    "obstacle": "obstacles",
    "zone": "zones",
    "axes": "frames",
    "program_axes": "frames of the program",
    "way": "path",
    "marks": "findings",
    "grid": "floor",
}
"""What can be hidden, by the name of its node."""


class Picture:
    """All nodes of a stage in viser's scene."""

    def __init__(self, server: viser.ViserServer, stage: Stage) -> None:
        self._scene, self._server, self._stage = server.scene, server, stage
        self._bodies: dict[str, list[tuple[Any, Item]]] = {}
        self._touching: frozenset[str] = frozenset()
        self._chosen: Any = None
        self._written: Any = None
        self._lettering = Lettering(server.scene, stage.marks)
        self._groups: dict[str, list[Any]] = {name: [] for name in GROUPS}
        self._view = first_view(stage)
        low, high = shown_box(stage, whole=True)
        self._size = float(np.linalg.norm(high - low)) / 2.0
        self._joints = [
            self._scene.add_frame(f"/joint_{number}", show_axes=False)
            for number in range(stage.robot.size + 1)
        ]
        self._ghosts = self._draw_ghosts() if stage.ghost is not None else []
        self._draw_surroundings()
        for number, item in enumerate(stage.items):
            self._draw_item(number, item)
        self._draw_axes()
        self._way = self._draw_way("way", stage.way, _WIDTH)
        self._piece, self._shades = -1, np.zeros((len(_lines(stage.way)), 2, 3), dtype=np.uint8)
        if stage.ghost_way is not None:
            ghost_way = self._draw_way("ghost_way", stage.ghost_way, _THIN)
            if ghost_way is not None:
                ghost_way.colors = np.array(colours.PLANNED_WAY, dtype=np.uint8)
        self._draw_marks()
        self._lettering.write(*self._view)

    @property
    def groups(self) -> dict[str, str]:
        """What there is of what can be hidden: its name, and what people call it."""
        return {name: text for name, text in GROUPS.items() if self._groups[name]}

    def show_group(self, name: str, is_shown: bool) -> None:
        """Show or hide all nodes of a group."""
        for node in self._groups[name]:
            node.visible = is_shown
        if name == "marks":
            self._lettering.show_marks(is_shown)

    def move_to(self, time: float) -> None:
        """Move what the joints move to where it is at a time."""
        times, chain = np.array([time]), self._stage.robot.chain
        with self._server.atomic():
            _place(self._joints, moved_by(chain, self._stage.track.at(times)[0][0]))
            if self._stage.ghost is not None:
                _place(self._ghosts, moved_by(chain, self._stage.ghost.at(times)[0][0]))

    def colour_bodies(self, touching: frozenset[str]) -> None:
        """Give the bodies that are too near to others their colour, and all others theirs."""
        for name in touching ^ self._touching:
            for node, item in self._bodies.get(name, []):
                node.color = colours.TOUCHING if name in touching else item.colour
        self._touching = touching

    def colour_way(self, values: Array, most: float, ramp: str) -> None:
        """Colour the path by values (N,), one for each of its points, from 0 to `most`."""
        if self._way is not None:
            shades = colours.linear(colours.coloured(values, most, ramp))
            first = _lines(self._stage.way)
            self._way.colors = self._shades = np.stack([shades[first], shades[first + 1]], axis=1)
            self.choose_piece(self._piece)

    def choose_piece(self, number: int) -> None:
        """Make the piece of the path stand out that belongs to a command; -1 for none."""
        self._piece = number
        self._lettering.follow(number)
        if self._chosen is not None:
            self._chosen.remove()
            self._chosen = None
        way = self._stage.way
        first = _lines(way)
        (own,) = np.nonzero(way.piece[np.searchsorted(way.breaks, first, side="right") - 1] == number)
        if number < 0 or not len(own):
            return
        points = np.stack([way.points[first[own]], way.points[first[own] + 1]], axis=1)
        self._chosen = self._scene.add_line_segments(
            "/chosen", points, self._shades[own], thickness=_THICK, thickness_units="screen"
        )

    def choose_mark(self, number: int) -> None:
        """Write at a finding's place what it is; -1 for none."""
        if self._written is not None:
            self._written.remove()
            self._written = None
        mark = self._stage.marks[number] if number >= 0 else None
        if mark is not None and mark.place is not None:
            self._written = self._scene.add_label(
                "/written", short(mark), position=mark.place, font_screen_scale=1.0, anchor="top-left"
            )

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
        self._groups["grid"].append(grid)
        eye, middle = self._view
        camera = self._server.initial_camera
        camera.look_at = middle
        camera.position = eye
        camera.up = (0.0, 0.0, 1.0)

    def _draw_item(self, number: int, item: Item) -> None:
        node = self._add_mesh(f"/joint_{item.joint}/item_{number}", item, item.colour, item.opacity)
        self._bodies.setdefault(item.name, []).append((node, item))
        self._groups[item.kind].append(node)
        if item.kind in {"zone", "obstacle"}:
            top = (item.base_from_item[:3, :3] @ item.solid.vertices.T).T + item.base_from_item[:3, 3]
            where = top[int(np.argmax(top[:, 2] + 1e-3 * top[:, 0]))]
            self._lettering.give(Label(item.name, where, 0.8, "bottom-center"), self._groups[item.kind])

    def _add_mesh(self, name: str, item: Item, colour: tuple[int, int, int], opacity: float) -> Any:
        position, wxyz = _pose(item.base_from_item)
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
        )

    def _draw_ghosts(self) -> list[Any]:
        """The robot a second time, to be seen through."""
        nodes = [
            self._scene.add_frame(f"/planned_{number}", show_axes=False)
            for number in range(self._stage.robot.size + 1)
        ]
        for number, item in enumerate(self._stage.items):
            if item.kind in {"robot", "tool"} and item.joint > 0:
                self._add_mesh(f"/planned_{item.joint}/item_{number}", item, colours.GHOST, 0.22)
        return nodes

    def _draw_axes(self) -> None:
        axes = self._stage.axes
        for number, one in enumerate(axes):
            position, wxyz = _pose(one.base_from_frame)
            group = self._groups["program_axes" if one.of_program else "axes"]
            length = _AXES_LENGTH * (1.0 if one.joint == 0 else 0.7)
            group.append(
                self._scene.add_frame(
                    f"/joint_{one.joint}/axes_{number}",
                    axes_length=length,
                    axes_radius=length / 30.0,
                    position=position,
                    wxyz=wxyz,
                )
            )
        for kind in dict.fromkeys((one.joint, one.of_program) for one in axes):
            alike = [number for number, one in enumerate(axes) if (one.joint, one.of_program) == kind]
            places = np.array([axes[number].base_from_frame[:3, 3] for number in alike])
            for spot in spots(places, SHARE * self._size):
                group = self._groups["program_axes" if kind[1] else "axes"]
                text = " ".join(f"{{{axes[alike[one]].name}}}" for one in spot)
                if kind[0] == 0:
                    self._lettering.give(Label(text, places[spot[0]], 0.7, "top-left"), group)
                    continue
                label = self._scene.add_label(
                    f"/joint_{kind[0]}/axes_{alike[spot[0]]}/name",
                    text,
                    font_screen_scale=0.7,
                    # a frame that the robot brings to another one has its name on the other side
                    anchor="top-right",
                )
                group.append(label)

    def _draw_way(self, name: str, way: Way, width: float) -> Any:
        first = _lines(way)
        if not len(first):
            return None
        points = np.stack([way.points[first], way.points[first + 1]], axis=1)
        node = self._scene.add_line_segments(
            f"/{name}", points, (90, 90, 90), thickness=width, thickness_units="screen"
        )
        self._groups["way"].append(node)
        return node

    def _draw_marks(self) -> None:
        marks = self._stage.marks
        placed = [number for number, mark in enumerate(marks) if mark.place is not None]
        places = np.array([marks[number].place for number in placed]).reshape(-1, 3)
        for number, place in zip(placed, places, strict=True):
            ball = self._scene.add_icosphere(
                f"/marks/{number}",
                radius=0.012 + 0.004 * self._size,
                color=colours.SEVERITIES[marks[number].severity],
                position=place,
                cast_shadow=False,
            )
            self._groups["marks"].append(ball)
        for spot in spots(places, SHARE * self._size):
            self._lettering.give_marks([placed[one] for one in spot], places[spot[0]])


def _lines(way: Way) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """Which points begin a line that leads to the next one."""
    first = np.arange(max(len(way.points) - 1, 0))
    kept: np.ndarray[tuple[int, ...], np.dtype[np.int64]] = first[~np.isin(first + 1, way.breaks)]
    return kept


def _place(nodes: list[Any], poses: Array) -> None:
    """Move nodes (K) to poses (K, 4, 4); the first one, which no joint moves, stays."""
    for node, pose, turn in zip(nodes[1:], poses[1:], _quaternions(poses[1:]), strict=True):
        node.position, node.wxyz = pose[:3, 3], turn


def _pose(transform: Array) -> tuple[Array, Array]:
    """Position, and rotation as a quaternion w x y z."""
    return transform[:3, 3], _quaternions(transform[None])[0]


def _quaternions(poses: Array) -> Array:
    """The rotations of poses (K, 4, 4) as quaternions w x y z (K, 4)."""
    from scipy.spatial.transform import Rotation

    quaternions: Array = np.roll(Rotation.from_matrix(poses[:, :3, :3]).as_quat(), 1, axis=1)
    return quaternions
