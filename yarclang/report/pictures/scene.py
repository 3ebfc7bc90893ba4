"""Draw the lower right of a motion's picture: the tool's path in space."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from yarclang.hir import Array
from yarclang.report.pictures.palette import CORNER_COLOUR, Bar
from yarclang.report.pictures.passed import Passed
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
from yarclang.report.pictures.toolpath import MOST_DOTS, ToolPath

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_scene(figure: Figure, path: ToolPath, bars: tuple[Bar, ...], corners: Passed, place: Place) -> None:
    """Draw the tool's path with each command in its colour, the waypoints, the corners that are passed
    without a stop, and start and end.
    """
    axes = space_axes(figure, place, "path")
    low, high = box_around(path.points)
    width = line_width(bars)
    if bars:
        _draw_floor(axes, path, float(low[2]), max(width / 2.0, 0.5))
    draw_path(axes, path, bars, width)
    if len(path.waypoints):
        label = "waypoints" if path.every == 1 else f"waypoints (one of {path.every})"
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
    # draw the start as a ring around the square of the end, so that both are visible if they coincide
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
    _dress(axes, path, low, high, place)


_END = "#D55E00"

_MOST_BALLS = 60
"""Largest number of balls that are drawn. More balls would cover the path."""


def _draw_corners(axes: Any, corners: Passed) -> None:
    """Draw a cross in each corner that is passed without a stop, and the outline of the ball within which the
    tool may leave the path.
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
    elevation, azimuth = np.deg2rad(VIEW)
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


def _draw_floor(axes: Any, path: ToolPath, height: float, width: float) -> None:
    """Draw the path's shadow on the floor of the box, to show the depth."""
    floor = path.points.copy()
    floor[:, 2] = height
    axes.plot(*floor.T, color="0.7", linewidth=width, zorder=1, label="shadow")


def _dress(axes: Any, path: ToolPath, low: Array, high: Array, place: Place) -> None:
    """Draw scales, labels, legend and title."""
    title = f"path of {{{path.frame}}} in {{B}}, coloured by command"
    if path.bounds[-1] == 1:
        title = f"position of {{{path.frame}}} in {{B}}"
    dress(axes, low, high, place, title)
    handles = axes.get_legend_handles_labels()[0]
    space_legend(axes.figure, handles, place, min(len(handles), 3))
