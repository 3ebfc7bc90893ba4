"""Draw the rows of a picture below the joints' shares of their limits: the tool's speed, the arm's distance
from a singularity, and the distances between bodies.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from yarclang.hir import Array
from yarclang.report.clearance import SEEN
from yarclang.report.pictures.clearance import Clearance
from yarclang.report.pictures.style import short_name
from yarclang.report.pictures.tool_trace import ToolTrace
from yarclang.units import MM

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEIGHT = 0.6
"""Height of each row, relative to the row of a joint quantity."""

_TOOL_COLOUR = "#3B3B6D"
_WANTED_COLOUR = "#B2182B"

_LEAST_TOP = 0.1
"""Smallest upper end of the scale for the singular value."""

_ZOOMED_BELOW = 0.4
"""Limit for zooming the panel of speeds, as a share of the tool's largest speed. If 1.25 times the requested
speed is at most this share, the panel is zoomed: the range from 0 to 1.25 times the requested speed gets the
share `_ZOOMED_HEIGHT` of the panel's height.
"""

_ZOOMED_HEIGHT = 0.75

_TOGETHER = 1e-6
"""Times that differ by less count as equal [s]."""

_LEAST_SPEED = 1.0
"""Smallest upper end of the scale of speeds [mm/s]. With a smaller scale, rounding errors would look like
motion.
"""

_LEAST_CLEARANCE = 20.0
"""Smallest upper end of the clearance's scale [mm]."""

_HIGHEST_TICK = 0.92
"""Share of a scale's height above which no number is written, because it would touch the panel above."""

_STILL = 1e-6
"""Speeds below this are rounding errors [mm/s]."""


def draw_speed(axes: Axes, trace: ToolTrace, factor: float, unit: str, width: float) -> tuple[str, str]:
    """Draw the speed of the tool, and the speeds that commands request; times in units of `factor` [s].

    Returns:
        A remark on the drawing, and the largest speed in words.
    """
    top = float(max(trace.speed.max(), trace.wanted[:, 2].max(initial=0.0)))
    _curve(axes, trace.times / factor, trace.speed, width)
    begin, end, speed = _joined(trace.wanted).T
    axes.hlines(
        speed,
        begin / factor,
        end / factor,
        colors=_WANTED_COLOUR,
        linewidths=1.0,
        linestyles=(0, (6, 2)),
        zorder=4,
    )
    note = _scale(axes, float(trace.wanted[:, 2].max(initial=0.0)), top)
    row = int(np.argmax(trace.speed))
    if trace.speed[row] < _STILL:
        return note, "none"
    return note, f"most: {trace.speed[row]:.4g} mm/s, at {trace.times[row] / factor:.4g} {unit}"


def _joined(requested: Array) -> Array:
    """Join consecutive intervals with equal requested speeds (k, 3)."""
    if len(requested) < 2:
        return requested
    same = (requested[1:, 2] == requested[:-1, 2]) & (
        np.abs(requested[1:, 0] - requested[:-1, 1]) < _TOGETHER
    )
    first = np.flatnonzero(np.concatenate(([True], ~same)))
    last = np.concatenate((first[1:], [len(requested)])) - 1
    return np.column_stack((requested[first, 0], requested[last, 1], requested[first, 2]))


def _scale(axes: Axes, requested: float, top: float) -> str:
    """Choose a scale for speeds up to `top`. If `requested` is much smaller, the requested speeds get most of
    the panel's height.

    Returns:
        A remark on the scale.
    """
    _scale_to(axes, max(1.12 * top, _LEAST_SPEED))
    if not requested:
        return ""
    inner = 1.25 * requested
    if inner > _ZOOMED_BELOW * top:
        return "dashes: [V ..]"
    data, drawn = np.array([0.0, inner, 1.12 * top]), np.array([0.0, _ZOOMED_HEIGHT, 1.0])
    slope = (1.0 - _ZOOMED_HEIGHT) / (1.12 * top - inner)

    def forward(value: Array) -> Array:
        # continue with the last slope, so that different values beyond the scale are drawn at different
        # heights
        drawn_at: Array = np.where(
            value > data[-1], 1.0 + (value - data[-1]) * slope, np.interp(value, data, drawn)
        )
        return drawn_at

    def back(value: Array) -> Array:
        speeds: Array = np.where(value > 1.0, data[-1] + (value - 1.0) / slope, np.interp(value, drawn, data))
        return speeds

    axes.set_yscale("function", functions=(forward, back))
    axes.set_yticks([0.0, requested, top], ["0", f"{requested:.4g}", f"{top:.4g}"])
    axes.minorticks_off()
    axes.axhspan(inner, 1.12 * top, color="0.95", zorder=0)
    return f"dashes: [V ..] · scale squeezed beyond {inner:.3g} mm/s"


def draw_singularity(axes: Axes, trace: ToolTrace, factor: float, unit: str, width: float) -> str:
    """Draw the smallest singular value of the Jacobian; times in units of `factor` [s].

    Returns:
        The smallest value in words.
    """
    _curve(axes, trace.times / factor, trace.singular, width)
    axes.axhline(0.0, color=_WANTED_COLOUR, linewidth=2.4, linestyle=(0, (6, 2)), zorder=2)
    _scale_to(axes, max(1.15 * float(trace.singular.max()), _LEAST_TOP))
    row = int(np.argmin(trace.singular))
    return f"least: {trace.singular[row]:.2g}, at {trace.times[row] / factor:.4g} {unit}"


def draw_clearance(axes: Axes, trace: Clearance, factor: float, unit: str, width: float) -> str:
    """Draw the smallest distance between two bodies; times in units of `factor` [s].

    Returns:
        The smallest value in words, with the pair of bodies.
    """
    _curve(axes, trace.times / factor, trace.apart / MM, width)
    axes.axhline(0.0, color=_WANTED_COLOUR, linewidth=2.4, linestyle=(0, (6, 2)), zorder=2)
    _scale_to(axes, max(1.12 * float(trace.apart.max()) / MM, _LEAST_CLEARANCE))
    row = int(np.argmin(trace.apart))
    if not trace.pair:
        return f"nowhere below {SEEN / MM:g} mm"
    first, second = map(short_name, trace.pair)
    return (
        f"least: {trace.apart[row] / MM:.3g} mm, {first} and {second}, at {trace.times[row] / factor:.4g} "
        f"{unit}"
    )


def _curve(axes: Axes, times: Array, values: Array, width: float) -> None:
    axes.plot(times, values, color=_TOOL_COLOUR, linewidth=width, zorder=3)
    axes.fill_between(times, values, 0.0, color=_TOOL_COLOUR, alpha=0.10, linewidth=0.0, zorder=1)
    axes.grid(axis="y", color="0.88", linewidth=0.6)
    axes.margins(x=0)


def _scale_to(axes: Axes, top: float) -> None:
    """Scale a panel from 0 to `top`. Numbers on the axis that would touch the panel above are left out."""
    axes.set_ylim(0.0, top)
    axes.locator_params(axis="y", nbins=4)
    axes.set_yticks([tick for tick in axes.get_yticks() if tick <= _HIGHEST_TICK * top])
    axes.set_ylim(0.0, top)
