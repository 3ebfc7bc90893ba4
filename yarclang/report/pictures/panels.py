"""The left side of a motion's picture: shares of the limits over time, in one panel for each quantity, and
the tool's speed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.plan import MotionPlan
from yarclang.report.pictures import tool_panels
from yarclang.report.pictures.palette import CORNER_COLOUR, Bar, joint_style
from yarclang.report.pictures.passed import Passed
from yarclang.report.pictures.tool_trace import ToolTrace
from yarclang.report.pictures.trace import Peak, Trace, has_limits, peak_of
from yarclang.robot.joint_names import joint_labels

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEFT, _RIGHT, _TOP, _BOTTOM = 0.045, 0.625, 0.88, 0.055
"""Borders of the panels, as shares of the figure."""

_LIMIT_COLOUR = "#B2182B"

_ZOOMED_BELOW = 40.0
"""Largest value [%] of a quantity below which it gets most of its panel's height, and the range up to the
limit the rest.
"""

_NOTHING = 1e-7
"""Values below this are rounding [%]."""

_ZOOMED_HEIGHT = 0.78
"""Share of the height between the limits that a zoomed quantity gets."""

_CORNER_SHADE = 0.16
"""Opacity of corners in a panel."""

_MOST_BOUNDARIES = 80
"""Most boundaries between commands that are drawn. More would cover the curves."""


def draw_panels(
    figure: Figure, plan: MotionPlan, trace: Trace, tool: ToolTrace, bars: tuple[Bar, ...], corners: Passed
) -> None:
    """Draw a ribbon of commands, and the panels below it, over one axis of time."""
    robot = plan.robot
    joints = joint_labels(robot.joint_names)
    motors = tuple(f"motor {number}" for number in robot.controller.motors)
    panels = [
        _Panel("joint position", trace.position, joints, "−100 % is the lower limit, +100 % the upper"),
        _Panel("joint velocity", trace.velocity, joints),
        _Panel("joint acceleration", trace.acceleration, joints),
        _Panel("joint jerk", trace.jerk, joints),
    ]
    if trace.motors_bind:
        note = "colours as the joints', in the motors' order"
        panels.append(_Panel("motor speed", trace.motors, motors, note, height=0.6))
    if trace.torque is not None:
        note = "of the joints' efforts, without friction"
        panels.append(_Panel("joint torque", trace.torque, joints, note))
    factor, unit = time_unit(float(trace.times[-1]))
    grid = figure.add_gridspec(
        len(panels) + 3,
        1,
        height_ratios=[0.16, *(panel.height for panel in panels), *(2 * [tool_panels.HEIGHT])],
        left=_LEFT,
        right=_RIGHT,
        top=_TOP,
        bottom=_BOTTOM,
        hspace=0.38,
    )
    times = trace.times / factor
    ribbon = figure.add_subplot(grid[0])
    ribbon.set_xlim(float(times[0]), float(times[-1]))
    draw_ribbon(ribbon, bars, factor)
    width = 1.3 if len(bars) <= _MOST_BOUNDARIES else 0.7
    for row, panel in enumerate(panels):
        axes = figure.add_subplot(grid[row + 1], sharex=ribbon)
        peak = peak_of(trace, panel.values)
        _draw_quantity(axes, times, panel.values * 100.0, width)
        zoomed = _scale(axes, peak.share * 100.0, can_zoom=row > 0)
        _mark(axes, bars, corners, factor)
        note = " · ".join(filter(None, (panel.note, zoomed)))
        _head(axes, panel.title, note, _peak_text(peak, panel.names, factor, unit))
    speed = figure.add_subplot(grid[-2], sharex=ribbon)
    note, most = tool_panels.draw_speed(speed, tool, factor, unit, width)
    _mark(speed, bars, corners, factor)
    _head(speed, f"speed of {{{tool.frame}}} [mm/s]", note, most)
    nearness = figure.add_subplot(grid[-1], sharex=ribbon)
    least = tool_panels.draw_singularity(nearness, tool, factor, unit, width)
    _mark(nearness, bars, corners, factor)
    _head(nearness, "smallest singular value", "0 is a singularity, far from one it is 0.1 to 0.5", least)
    nearness.tick_params(labelbottom=True)
    nearness.set_xlabel(f"time [{unit}]", labelpad=2)
    _draw_legend(figure, plan, corners)


def _head(axes: Axes, title: str, note: str, found: str) -> None:
    """Write the text above a panel: its title, a remark, and its extreme."""
    axes.set_title(title, loc="left", fontsize=9.5, pad=4, color="0.1", fontweight="bold")
    axes.set_title(note, fontsize=8.5, pad=4, color="0.4")
    axes.set_title(found, loc="right", fontsize=9, pad=4, color="0.2")
    axes.tick_params(labelbottom=False, length=2.5, labelsize=8.5)


@frozen(eq=False)
class _Panel:
    """A quantity.

    Attributes:
        title: of the panel.
        values: (N, n) shares.
        names: of the columns.
        note: a remark.
        height: relative to the other panels.
    """

    title: str
    values: Array
    names: tuple[str, ...]
    note: str = ""
    height: float = 1.0


def time_unit(duration: float) -> tuple[float, str]:
    """Return the unit of the time axis in seconds, and its name."""
    if duration < 600.0:
        return 1.0, "s"
    return (60.0, "min") if duration < 7200.0 else (3600.0, "h")


def _peak_text(peak: Peak, names: tuple[str, ...], factor: float, unit: str) -> str:
    if peak.share * 100.0 <= _NOTHING:
        return "none"
    return f"most: {peak.share * 100.0:.3g} %, {names[peak.column]}, at {peak.time / factor:.4g} {unit}"


def _draw_quantity(axes: Axes, times: Array, percent: Array, width: float) -> None:
    """Draw `percent` (N, n) over `times` (N,), with the limits at 100 % either way."""
    # draw the most varying first, because they would cover the others where the lines are dense
    for column in np.argsort(-np.abs(percent).mean(axis=0), kind="stable"):
        colour, style = joint_style(int(column))
        axes.plot(times, percent[:, column], color=colour, linestyle=style, linewidth=width, zorder=3)
    for limit in (-100.0, 100.0):
        axes.axhline(limit, color=_LIMIT_COLOUR, linewidth=1.2, linestyle=(0, (6, 2)), zorder=2)
    axes.grid(axis="y", color="0.88", linewidth=0.6)
    axes.axhline(0.0, color="0.6", linewidth=0.7, zorder=1)
    axes.margins(x=0)


def _scale(axes: Axes, peak: float, *, can_zoom: bool) -> str:
    """Choose the scale of a panel that includes the limits and a largest size of `peak` [%].

    Returns:
        A remark on the scale, if it isn't even.
    """
    zoomed = ""
    if can_zoom and _NOTHING < peak < _ZOOMED_BELOW:
        inner = _round_up(peak * 1.05)
        _zoom(axes, inner)
        zoomed = f"scale squeezed beyond ±{inner:g} %"
    else:
        top = max(115.0, peak * 1.08)
        axes.set_ylim(-top, top)
        axes.set_yticks([-100, -50, 0, 50, 100])
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g} %".replace("-", "−"))
    return zoomed


def _zoom(axes: Axes, inner: float) -> None:
    """Give +-`inner` [%] most of the height, and compress the range up to the limits into shaded strips."""
    outer = 100.0 + 0.35 * (100.0 - inner)
    # one straight piece beyond the limit, so that its slope is equal on both sides of the limit
    squeezed = _ZOOMED_HEIGHT + (1.0 - _ZOOMED_HEIGHT) * (1000.0 - inner) / (100.0 - inner)
    data = np.array([-1000.0, -inner, inner, 1000.0])
    drawn = np.array([-squeezed, -_ZOOMED_HEIGHT, _ZOOMED_HEIGHT, squeezed])
    axes.set_yscale(
        "function",
        functions=(lambda value: np.interp(value, data, drawn), lambda value: np.interp(value, drawn, data)),
    )
    axes.set_ylim(-outer, outer)
    axes.set_yticks([-100.0, -inner, 0.0, inner, 100.0])
    axes.minorticks_off()
    for side in (-1.0, 1.0):
        axes.axhspan(side * inner, side * outer, color="0.95", zorder=0)


def _round_up(value: float) -> float:
    """Return the next larger of 1, 2, 3, 5 times a power of ten."""
    if value <= 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return float(
        next(step * power for step in (1.0, 2.0, 3.0, 5.0, 10.0) if step * power >= value * (1 - 1e-9))
    )


def _mark(axes: Axes, bars: tuple[Bar, ...], corners: Passed, factor: float) -> None:
    """Mark the starts of commands, and the overlaps of two, if they can be distinguished."""
    if len(corners) <= _MOST_BOUNDARIES:
        for begin, end in zip(corners.begins / factor, corners.ends / factor, strict=True):
            axes.axvspan(begin, end, color=CORNER_COLOUR, alpha=_CORNER_SHADE, linewidth=0.0, zorder=0)
    if len(bars) <= _MOST_BOUNDARIES:
        colour = "0.55" if len(bars) <= 20 else "0.85"
        for bar in bars[1:]:
            axes.axvline(bar.start / factor, color=colour, linewidth=0.7, zorder=1)


def draw_ribbon(axes: Axes, bars: tuple[Bar, ...], factor: float) -> None:
    """Draw the commands as coloured bars, with their indices and names if there is room for them."""
    axes.set_ylim(0.0, 1.0)
    axes.set_axis_off()
    spans = [(bar.start / factor, (bar.end - bar.start) / factor) for bar in bars]
    axes.broken_barh(
        spans,
        (0.0, 1.0),
        facecolors=[bar.colour for bar in bars],
        edgecolors="white",
        linewidth=1.0 if len(bars) <= _MOST_BOUNDARIES else 0.0,
    )
    width = _Widths(axes)
    free = -math.inf
    for bar in bars:
        left, right = width.pixel(bar.start / factor), width.pixel(bar.end / factor)
        whole = " ".join(part for part in (bar.index, bar.name) if part)
        inside = next(
            (text for text in (whole, bar.index) if text and width.of(text) < right - left - 6.0), None
        )
        if inside is not None:
            middle = (bar.start + bar.end) / 2.0 / factor
            axes.text(middle, 0.45, inside, ha="center", va="center", fontsize=8, color=bar.text_colour)
            continue
        # no room inside: put the label above the bar's start, unless the previous label reaches there
        label = bar.index or bar.name
        if left >= free and left + width.of(label) <= width.pixel(axes.get_xlim()[1]):
            axes.text(bar.start / factor, 1.12, label, ha="left", va="bottom", fontsize=8, color="0.2")
            free = left + width.of(label) + 10.0


class _Widths:
    """Conversion of times and texts to pixels of an axis."""

    def __init__(self, axes: Axes) -> None:
        from matplotlib.font_manager import FontProperties

        canvas: Any = axes.figure.canvas
        self._renderer = canvas.get_renderer()
        self._font = FontProperties(size=8)
        self._axes = axes

    def of(self, text: str) -> float:
        """Return the width of a text in the labels' size."""
        return float(self._renderer.get_text_width_height_descent(text, self._font, ismath=False)[0])

    def pixel(self, time: float) -> float:
        """Return the position of a time, given in the axis's unit."""
        return float(self._axes.transData.transform((time, 0.0))[0])


def _draw_legend(figure: Figure, plan: MotionPlan, corners: Passed) -> None:
    """Draw the joints' colours, the limits' dashes and the corners' shade, in one row above the panels."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    robot = plan.robot
    handles: list[Line2D | Patch] = []
    for joint, (name, limited) in enumerate(
        zip(joint_labels(robot.joint_names), has_limits(robot), strict=True)
    ):
        colour, style = joint_style(joint)
        label = name if limited else f"{name}*"
        handles.append(Line2D([], [], color=colour, linestyle=style, linewidth=2.0, label=label))
    dashes = (0, (6, 2))
    handles.append(
        Line2D([], [], color=_LIMIT_COLOUR, linewidth=1.2, linestyle=dashes, label="limit, ±100 %")
    )
    if not has_limits(robot).all():
        handles.append(Line2D([], [], linestyle="", label="* no limits: position over 180°"))
    if 0 < len(corners) <= _MOST_BOUNDARIES:
        label = "corner passed in motion"
        handles.append(Patch(color=CORNER_COLOUR, alpha=_CORNER_SHADE, linewidth=0.0, label=label))
    legend_row(figure, handles, _LEFT, 0.917)


def legend_row(figure: Figure, handles: Sequence[Artist], left: float, height: float) -> None:
    """Draw a legend in one row, with its left end at a place of the figure (shares of its width and
    height).
    """
    figure.legend(
        handles=list(handles),
        loc="center left",
        bbox_to_anchor=(left, height),
        ncols=len(handles),
        borderpad=0.0,
        borderaxespad=0.0,
        frameon=False,
        fontsize=9,
        handlelength=1.6,
        columnspacing=1.4,
    )
