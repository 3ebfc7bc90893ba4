"""Draw the upper right of the picture of a program's motion: the robot in its cell at the start, with the
path of its tool.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from yarclang.hir import Array
from yarclang.report.pictures.bodies import Body, Kind, Surroundings, box_of, within
from yarclang.report.pictures.palette import Bar, Colour
from yarclang.report.pictures.space import (
    VIEW,
    Place,
    box_around,
    draw_path,
    dress,
    line_width,
    space_axes,
    space_legend,
)
from yarclang.report.pictures.style import short_name
from yarclang.report.pictures.toolpath import ToolPath

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS: dict[Kind, Colour] = {
    "robot": (0.80, 0.84, 0.90),
    "tool": (0.42, 0.50, 0.64),
    "part": (0.78, 0.58, 0.38),
    "obstacle": (0.66, 0.71, 0.66),
}

_ZONES: dict[str, Colour] = {
    "allowed": (0.18, 0.63, 0.35),
    "forbidden": (0.84, 0.24, 0.20),
    "slow": (0.85, 0.65, 0.05),
    "posture": (0.51, 0.35, 0.78),
}

_AROUND = 0.25
"""Distance around the robot and the path within which the cell is drawn, as a share of the longest side of
the box around robot and path.
"""

_FINEST = 14
"""Number of triangles along the longest side of the box, for sorting by depth."""

_LIGHT = np.array([0.35, -0.55, 0.76])
"""Direction to the light, a unit vector."""

_FACING_AWAY = -0.25
"""Cosine of the angle between a triangle's normal and the direction to the viewer below which the triangle
isn't drawn. It is less than 0 because of the perspective: triangles that face slightly away may be visible.
"""

_MOST_NAMES = 24
"""Largest number of bodies and zones whose names are written."""


def draw_cell(
    figure: Figure, path: ToolPath, bars: tuple[Bar, ...], surroundings: Surroundings, place: Place
) -> None:
    """Draw the robot, its cell and the path."""
    axes = space_axes(figure, place, "cell")
    low, high = _box(path.points, surroundings)
    longest = float((high - low).max())
    drawn = [
        (body, within(body.triangles, low, high, longest / _FINEST))
        for body in surroundings.bodies
        if body.kind != "zone"
    ]
    drawn = [(body, triangles) for body, triangles in drawn if len(triangles)]
    _draw_bodies(axes, drawn)
    zones = [
        (zone, within(zone.triangles, low, high, longest / 4.0))
        for zone in surroundings.bodies
        if zone.kind == "zone"
    ]
    zones = [(zone, triangles) for zone, triangles in zones if len(triangles)]
    for zone, triangles in zones:
        _draw_zone(axes, zone, triangles)
    draw_path(axes, path, bars, 0.6 * line_width(bars))
    dress(axes, low, high, place, _title(surroundings))
    _name(axes, [one for one in (*drawn, *zones) if one[0].kind not in ("robot", "tool")])
    _draw_legend(axes, [one for one, _ in drawn], [one for one, _ in zones], place)


def _title(surroundings: Surroundings) -> str:
    left_out = surroundings.left_out
    more = f"; without {short_name(left_out[0])}" if left_out else ""
    if len(left_out) > 1:
        more += f" and {len(left_out) - 1} more"
    return f"robot and cell at the start, in {{B}}{more}"


def _box(points: Array, surroundings: Surroundings) -> tuple[Array, Array]:
    """Return the corners of the box around robot, tools and path. On sides with other bodies, the box is
    larger by up to the margin `_AROUND`.
    """
    low, high = box_of(body for body in surroundings.bodies if body.kind in ("robot", "tool"))
    low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    spare = _AROUND * float((high - low).max())
    other_low, other_high = box_of(
        body for body in surroundings.bodies if body.kind in ("part", "obstacle", "zone")
    )
    least = np.minimum(low, np.maximum(other_low, low - spare))
    most = np.maximum(high, np.minimum(other_high, high + spare))
    return box_around(np.stack((least, most)))


def _draw_bodies(axes: Any, drawn: list[tuple[Body, Array]]) -> None:
    """Draw all bodies as one matplotlib collection, since only triangles of the same collection are sorted
    by depth.
    """
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    if not drawn:
        return
    triangles = np.concatenate([one for _, one in drawn])
    base = np.concatenate([np.tile(_COLOURS[body.kind], (len(one), 1)) for body, one in drawn])
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    elevation, azimuth = np.deg2rad(VIEW)
    viewer = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    faces_viewer = normal @ viewer > _FACING_AWAY
    shade = 0.62 + 0.38 * np.clip(normal[faces_viewer] @ _LIGHT, 0.0, 1.0)
    colours = np.clip(base[faces_viewer] * shade[:, None], 0.0, 1.0)
    axes.add_collection(
        Poly3DCollection(
            triangles[faces_viewer],
            facecolors=colours,
            edgecolors=colours,
            linewidths=0.35,
            zorder=2,
            gid="bodies",
        ),
        autolim=False,
    )


def _draw_zone(axes: Any, zone: Body, triangles: Array) -> None:
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    colour = _ZONES[zone.rule]
    axes.add_collection(
        Poly3DCollection(triangles, facecolors=(*colour, 0.10), linewidths=0.0, zorder=3), autolim=False
    )
    edges = _edges(zone.triangles)
    axes.add_collection(
        Line3DCollection(edges, colors=[(*colour, 0.8)], linewidths=0.8, zorder=3), autolim=False
    )


def _edges(triangles: Array) -> Array:
    """Return the edges (E, 2, 3) at which the surface of a body has a crease."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    sides = np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=2).reshape(-1, 2, 3)
    owner = np.repeat(np.arange(len(triangles)), 3)
    keys = np.sort(np.round(sides, 3).view([("", float)] * 3)[..., 0], axis=1)
    _, first, which, count = np.unique(
        keys, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    which = which.ravel()
    total = np.zeros((len(first), 3))
    np.add.at(total, which, normal[owner])
    flat = (count == 2) & (np.linalg.norm(total, axis=1) > 2.0 * np.cos(np.deg2rad(15.0)))
    edges: Array = sides[first[~flat]]
    return edges


def _name(axes: Any, named: list[tuple[Body, Array]]) -> None:
    """Write names at bodies and zones, except names that would overlap others."""
    renderer = axes.figure.canvas.get_renderer()
    taken_boxes: list[Any] = []
    texts: dict[str, tuple[Body, Array]] = {}
    for body, triangles in named:
        texts.setdefault(body.name, (body, triangles))
    for name, (body, triangles) in list(texts.items())[:_MOST_NAMES]:
        corners = triangles.reshape(-1, 3)
        low, high = corners.min(axis=0), corners.max(axis=0)
        x, y, z = (low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, high[2]
        projected = axes.get_proj() @ np.array([x, y, z, 1.0])
        text = axes.text2D(
            *(projected[:2] / projected[3]),
            short_name(name),
            transform=axes.transData,
            fontsize=7.5,
            color=tuple(0.55 * part for part in _ZONES[body.rule]) if body.kind == "zone" else "0.15",
            ha="center",
            va="bottom",
            zorder=9,
        )
        box = text.get_window_extent(renderer)
        if any(box.overlaps(other) for other in taken_boxes):
            text.remove()
        else:
            taken_boxes.append(box)


def _draw_legend(axes: Any, bodies: list[Body], zones: list[Body], place: Place) -> None:
    from matplotlib.patches import Patch

    handles = [Patch(color=_COLOURS[kind], label=kind) for kind in dict.fromkeys(one.kind for one in bodies)]
    handles += [
        Patch(color=(*_ZONES[rule], 0.35), label=f"{rule} zone")
        for rule in dict.fromkeys(one.rule for one in zones)
    ]
    space_legend(axes.figure, handles, place, 4)
