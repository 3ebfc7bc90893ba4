"""The right side of a motion's picture: the tool's path in space, in equal scales."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from yarclang.hir import Array
from yarclang.report.pictures.palette import CORNER_COLOUR, Bar
from yarclang.report.pictures.passed import Passed
from yarclang.report.pictures.toolpath import MOST_DOTS, ToolPath

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PLACE = (0.645, 0.10, 0.345, 0.78)
"""Left, bottom, width and height, as shares of the figure."""

_MARGIN = 50.0
"""Space for the labels of the axes around the box [pixels]."""

_SLIMMEST = 0.35
"""Least side of the box as a share of the longest, so that a plane path has space around it."""

_SMALLEST = 10.0
"""Least length of the longest side [mm]."""


def draw_scene(figure: Figure, path: ToolPath, bars: tuple[Bar, ...], corners: Passed) -> None:
    """Draw the path with each command in its colour, the way-points, corners passed in motion, and start and
    end.
    """
    axes: Any = figure.add_axes(_square(figure), projection="3d", computed_zorder=False)
    axes.patch.set_visible(False)  # the background would cover the panels
    low, high = _box(path.points)
    width = 2.2 if len(bars) <= 20 else 1.4 if len(bars) <= 100 else 0.7
    if bars:
        _draw_floor(axes, path, float(low[2]), max(width / 2.0, 0.5))
    for bar in bars:
        line = path.points[path.bounds[bar.first] : path.bounds[bar.behind]]
        axes.plot(*line.T, color=bar.colour, linewidth=width, zorder=4, solid_capstyle="round")
    if len(path.waypoints):
        label = "way-points" if path.every == 1 else f"way-points (one of {path.every})"
        size = 22 if len(path.waypoints) <= 60 else 6
        axes.scatter(
            *path.waypoints.T,
            s=size,
            color="0.1",
            edgecolors="white",
            linewidths=0.6,
            depthshade=False,
            zorder=6,
            label=label,
        )
    if len(corners):
        _draw_corners(axes, corners)
    # a ring around a square: both are visible if a program ends at its start
    axes.scatter(
        *path.points[0],
        s=130,
        facecolors="none",
        edgecolors="0.1",
        linewidths=1.8,
        depthshade=False,
        zorder=7,
        label="start",
    )
    axes.scatter(
        *path.points[-1],
        s=34,
        marker="s",
        color=_END,
        edgecolors="white",
        linewidths=0.6,
        depthshade=False,
        zorder=8,
        label="end",
    )
    _dress(axes, path, low, high, corners)


_END = "#D55E00"

_VIEW = (24.0, -52.0)
"""Elevation and azimuth of the view on the box [deg]."""

_MOST_BALLS = 60
"""Most balls that are drawn. More would cover the path."""


def _draw_corners(axes: Any, corners: Passed) -> None:
    """Draw a cross in each corner that is passed in motion, and the outline of the ball within which the path
    may be left.
    """
    every = -(-len(corners) // MOST_DOTS)
    label = "corners passed in motion" if every == 1 else f"corners passed (one of {every})"
    axes.scatter(
        *corners.places[::every].T,
        s=26 if len(corners) <= 12 else 10 if len(corners) <= _MOST_BALLS else 2,
        marker="x",
        color=CORNER_COLOUR,
        linewidths=1.2 if len(corners) <= 12 else 0.8 if len(corners) <= _MOST_BALLS else 0.4,
        depthshade=False,
        zorder=7,
        label=label,
    )
    if len(corners) > _MOST_BALLS:
        return
    elevation, azimuth = np.deg2rad(_VIEW)
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    up = np.array(
        [-np.sin(elevation) * np.cos(azimuth), -np.sin(elevation) * np.sin(azimuth), np.cos(elevation)]
    )
    around = np.linspace(0.0, 2.0 * np.pi, 49)[:, None]
    circle = np.cos(around) * across + np.sin(around) * up  # a ball appears as a circle that faces the viewer
    label = "BLEND: as far as it may be left"
    for place, radius in zip(corners.places, corners.radii, strict=True):
        if radius > 0.0:
            axes.plot(*(place + radius * circle).T, color=CORNER_COLOUR, linewidth=0.9, zorder=5, label=label)
            label = "_"  # only one entry in the legend


def _box(points: Array) -> tuple[Array, Array]:
    """Return the least and the largest coordinates (3,) of the box to show [mm]."""
    low, high = points.min(axis=0), points.max(axis=0)
    longest = max(float((high - low).max()), _SMALLEST)
    half = np.maximum((high - low) / 2.0, _SLIMMEST * longest / 2.0) * 1.08
    middle = (low + high) / 2.0
    return middle - half, middle + half


def _draw_floor(axes: Any, path: ToolPath, height: float, width: float) -> None:
    """Draw the path's shadow on the floor of the box, which shows its depth."""
    floor = path.points.copy()
    floor[:, 2] = height
    axes.plot(*floor.T, color="0.7", linewidth=width, zorder=1, label="shadow")


def _dress(axes: Any, path: ToolPath, low: Array, high: Array, corners: Passed) -> None:
    """Draw scales, labels, legend and title."""
    for name, least, most in zip("xyz", low, high, strict=True):
        getattr(axes, f"set_{name}lim")(least, most)
        getattr(axes, f"set_{name}label")(f"{name} [mm]", labelpad=10 if name == "z" else 6)
        axis = getattr(axes, f"{name}axis")
        axis.set_pane_color((0.97, 0.97, 0.97, 1.0))
        axis.pane.set_edgecolor("0.75")
        axes.locator_params(axis=name, nbins=max(2, round(6.0 * float((most - least) / (high - low).max()))))
    axes.tick_params(labelsize=8, pad=2)
    axes.tick_params(axis="z", pad=5)
    axes.view_init(elev=_VIEW[0], azim=_VIEW[1])
    bottom, top = _fill(axes, low, high)
    middle = _PLACE[0] + _PLACE[2] / 2.0
    title = f"path of {{{path.frame}}} in {{B}}, coloured by command"
    if path.bounds[-1] == 1:
        title = f"position of {{{path.frame}}} in {{B}}"
    axes.figure.text(
        middle, top + 0.025, title, ha="center", va="bottom", fontsize=9.5, fontweight="bold", color="0.1"
    )
    axes.figure.legend(
        handles=axes.get_legend_handles_labels()[0],
        loc="upper center",
        bbox_to_anchor=(middle, bottom - 0.045),
        ncols=4 if not len(corners) else 3,
        frameon=False,
        fontsize=9,
        columnspacing=1.8,
    )


def _square(figure: Figure) -> tuple[float, float, float, float]:
    """Return the square around `_PLACE`: matplotlib draws 3D axes in squares, and clips at their borders."""
    left, bottom, width, height = _PLACE
    size = figure.get_size_inches()
    side = max(width * size[0], height * size[1])
    across, up = side / size[0], side / size[1]
    return left + (width - across) / 2.0, bottom + (height - up) / 2.0, across, up


def _fill(axes: Any, low: Array, high: Array) -> tuple[float, float]:
    """Set equal scales, and a zoom with which the box from `low` to `high` (3,) fills `_PLACE`.

    Returns:
        Bottom and top of the box, as shares of the figure.
    """
    size = axes.figure.get_size_inches() * axes.figure.dpi
    room = np.array(_PLACE[2:]) * size - 2.0 * _MARGIN
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True), [1.0])).reshape(4, -1)
    zoom = 1.0
    for _ in range(4):  # with perspective, the size isn't exactly proportional to the zoom
        axes.set_box_aspect(high - low, zoom=zoom)
        projected = axes.get_proj() @ corners
        pixels = axes.transData.transform((projected[:2] / projected[3]).T)
        zoom *= float((room / np.ptp(pixels, axis=0)).min())
    return float(pixels[:, 1].min() / size[1]), float(pixels[:, 1].max() / size[1])
