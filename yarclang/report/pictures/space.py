"""Draw three-dimensional axes with equal scales in a picture, and the path of a tool in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from yarclang.hir import Array
from yarclang.report.pictures.palette import Bar, Sort
from yarclang.report.pictures.toolpath import ToolPath

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

Place = tuple[float, float, float, float]
"""Left, bottom, width and height, as shares of the figure."""

UPPER: Place = (0.648, 0.525, 0.343, 0.425)
LOWER: Place = (0.648, 0.085, 0.343, 0.375)
WHOLE: Place = (0.648, 0.13, 0.343, 0.76)

VIEW = (24.0, -52.0)
"""Elevation and azimuth of the view on the box [deg]."""

_MARGINS = np.array([76.0, 40.0])
"""Space for the labels of the axes: at the sides of the box, and below and above it [pixels]."""

_SLIMMEST = 0.35
"""Smallest side of the drawn box as a share of the longest side, so that a path in a plane has space
around it.
"""

_SMALLEST = 10.0
"""Smallest length of the longest side [mm]."""

_LINES: dict[Sort, tuple[float, Any, str]] = {
    "process": (1.6, "-", "tool at the speed of [V ..]"),
    "led": (1.0, "-", "other path of the tool"),
    "joints": (0.75, (0, (3.5, 1.6)), "motion of the joints"),
}
"""Relative line width, line style and label for each kind of motion."""


def space_axes(figure: Figure, place: Place, label: str) -> Any:
    """Add 3D axes for a rectangle of the figure. They are larger than the rectangle, because matplotlib draws
    3D axes in squares and clips at their borders.
    """
    left, bottom, width, height = place
    size = figure.get_size_inches()
    side = max(width * size[0], height * size[1])
    across, up = side / size[0], side / size[1]
    square = (left + (width - across) / 2.0, bottom + (height - up) / 2.0, across, up)
    axes: Any = figure.add_axes(square, projection="3d", computed_zorder=False, label=label)
    axes.patch.set_visible(False)  # the background would cover the panels
    return axes


def box_around(points: Array) -> tuple[Array, Array]:
    """Return the smallest and the largest coordinates (3,) of the box to show [mm]."""
    low, high = points.min(axis=0), points.max(axis=0)
    longest = max(float((high - low).max()), _SMALLEST)
    half = np.maximum((high - low) / 2.0, _SLIMMEST * longest / 2.0) * 1.08
    middle = (low + high) / 2.0
    return middle - half, middle + half


def line_width(bars: tuple[Bar, ...]) -> float:
    """Return the width of a path's lines. It is smaller for many commands."""
    return 1.9 if len(bars) <= 20 else 1.4 if len(bars) <= 100 else 0.7


def draw_path(axes: Any, path: ToolPath, bars: tuple[Bar, ...], width: float) -> None:
    """Draw a tool's path with each command in its colour. The motions of each kind are one collection with
    a label.
    """
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    for sort in dict.fromkeys(bar.sort for bar in bars):
        chosen = [
            bar for bar in bars if bar.sort == sort and path.bounds[bar.behind] > path.bounds[bar.first]
        ]
        wide, style, label = _LINES[sort]
        lines = Line3DCollection(
            [path.points[path.bounds[bar.first] : path.bounds[bar.behind]] for bar in chosen],
            colors=[bar.colour for bar in chosen],
            linewidths=wide * width,
            linestyles=style,
            zorder=4,
            capstyle="round" if style == "-" else "butt",
            label=label,
        )
        axes.add_collection(lines, autolim=False)  # matplotlib before 3.10 has no autolim in add_collection3d


def dress(axes: Any, low: Array, high: Array, place: Place, title: str) -> None:
    """Set the scales of axes that show the box from `low` to `high` (3,) [mm], and write labels and title."""
    for name, least, most in zip("xyz", low, high, strict=True):
        getattr(axes, f"set_{name}lim")(least, most)
        getattr(axes, f"set_{name}label")(f"{name} [mm]", labelpad=7 if name == "z" else 6)
        axis = getattr(axes, f"{name}axis")
        axis.set_pane_color((0.97, 0.97, 0.97, 1.0))
        axis.pane.set_edgecolor("0.75")
        axes.locator_params(axis=name, nbins=max(2, round(5.0 * float((most - least) / (high - low).max()))))
    axes.tick_params(labelsize=8, pad=2)
    axes.tick_params(axis="z", pad=5)
    axes.view_init(elev=VIEW[0], azim=VIEW[1])
    _fill(axes, low, high, place)
    left, bottom, width, height = place
    axes.figure.text(
        left + width / 2.0,
        bottom + height + 0.006,
        title,
        ha="center",
        va="bottom",
        fontsize=9.5,
        fontweight="bold",
        color="0.1",
    )


def space_legend(figure: Figure, handles: Sequence[Artist], place: Place, columns: int) -> None:
    """Draw a legend below the rectangle `place` of the figure."""
    figure.legend(
        handles=list(handles),
        loc="upper center",
        bbox_to_anchor=(place[0] + place[2] / 2.0, place[1] - 0.002),
        ncols=max(columns, 1),
        frameon=False,
        fontsize=8,
        columnspacing=1.4,
        handlelength=1.8,
        borderaxespad=0.0,
    )


def _fill(axes: Any, low: Array, high: Array, place: Place) -> None:
    """Set equal scales, and a zoom with which the box from `low` to `high` (3,) fills the rectangle `place`
    of the figure.
    """
    size = axes.figure.get_size_inches() * axes.figure.dpi
    room = np.array(place[2:]) * size - 2.0 * _MARGINS
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True), [1.0])).reshape(4, -1)
    zoom = 1.0
    for _ in range(4):  # with perspective, the size isn't exactly proportional to the zoom
        axes.set_box_aspect(high - low, zoom=zoom)
        projected = axes.get_proj() @ corners
        pixels = axes.transData.transform((projected[:2] / projected[3]).T)
        zoom *= float((room / np.ptp(pixels, axis=0)).min())
