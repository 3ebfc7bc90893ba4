"""Draw the left side of the picture of a program's motion: shares of the joints' limits over time, in one
panel for each quantity, and the tool's speed.
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
from yarclang.report.pictures.actions import Action
from yarclang.report.pictures.clearance import Clearance
from yarclang.report.pictures.kept import HEIGHT as KEPT_HEIGHT
from yarclang.report.pictures.kept import MOST_ROWS as MOST_KEPT
from yarclang.report.pictures.kept import KeptRow, draw_kept
from yarclang.report.pictures.palette import CORNER_COLOUR, Bar, joint_style
from yarclang.report.pictures.passed import Passed
from yarclang.report.pictures.ribbon import draw_actions, draw_ribbon
from yarclang.report.pictures.signal_rows import MOST_ROWS, SignalRow, draw_rows
from yarclang.report.pictures.style import short_name
from yarclang.report.pictures.tool_trace import ToolTrace
from yarclang.report.pictures.trace import Peak, Trace, has_limits, peak_of
from yarclang.robot.joint_names import joint_labels
from yarclang.robot.model import Robot

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEFT, _RIGHT, _TOP, _BOTTOM = 0.052, 0.625, 0.895, 0.045
"""Borders of the panels, as shares of the figure."""

_LIMIT_COLOUR = "#B2182B"

_ZOOMED_BELOW = 40.0
"""If the largest value [%] of a quantity is below this, the panel is zoomed: the range of the values gets
most of the height, and the range from there to the limit gets the rest.
"""

_LEAST_INNER = 1.0
"""Smallest range [%] to which a panel is zoomed. With a smaller range, rounding errors would look like
motion.
"""

_NOTHING = 1e-7
"""Values below this are rounding errors [%]."""

_ZOOMED_HEIGHT = 0.78
"""Share of the height between the two limits that a zoomed quantity gets; the rest is compressed."""

_CORNER_SHADE = 0.16
"""Opacity of the shading that marks the times of blended corners in a panel."""

_APART = 14.0
"""Smallest distance of two texts above a panel [pixels]."""

_MOST_BOUNDARIES = 80
"""Largest number of boundaries between commands that are marked. More marks would cover the curves."""


def draw_panels(figure: Figure, plan: MotionPlan, shown: Shown) -> None:
    """Draw a ribbon of commands, and the panels below it, over one axis of time."""
    trace, tool, signals = shown.trace, shown.tool, shown.signals
    factor, unit = time_unit(float(trace.times[-1]))
    drawn = _Drawn(factor, unit, 1.3 if len(shown.bars) <= _MOST_BOUNDARIES else 0.7)
    quantities = _quantities(plan.robot, trace)
    heights = [
        0.16,
        *(panel.height for panel in quantities),
        *(2 * [tool_panels.HEIGHT]),
        *([tool_panels.HEIGHT] if shown.clearance is not None else []),
        *(min(len(shown.kept), MOST_KEPT) * [KEPT_HEIGHT]),
        *([0.16 + 0.13 * min(len(signals), MOST_ROWS)] if signals else []),
    ]
    grid = figure.add_gridspec(
        len(heights),
        1,
        height_ratios=heights,
        left=_LEFT,
        right=_RIGHT,
        top=_TOP,
        bottom=_BOTTOM,
        hspace=0.40 + 0.02 * (len(heights) - 6),
    )
    ribbon = figure.add_subplot(grid[0])
    ribbon.set_xlim(float(trace.times[0]) / factor, float(trace.times[-1]) / factor)
    draw_ribbon(ribbon, shown.bars, factor)
    draw_actions(ribbon, shown.actions, factor)
    rows = [figure.add_subplot(grid[at], sharex=ribbon) for at in range(1, len(heights))]
    remaining_rows = iter(rows)
    for number, panel in enumerate(quantities):
        axes = next(remaining_rows)
        peak = peak_of(trace, panel.values)
        _draw_quantity(axes, trace.times / factor, panel.values * 100.0, drawn.width)
        zoomed = _scale(axes, peak.share * 100.0, can_zoom=number > 0)
        note = " · ".join(filter(None, (panel.note, zoomed)))
        _head(axes, panel.title, note, _peak_text(peak, panel, drawn))
    axes = next(remaining_rows)
    note, most = tool_panels.draw_speed(axes, tool, factor, unit, drawn.width)
    _head(axes, f"speed of {{{tool.frame}}} [mm/s]", note, most)
    axes = next(remaining_rows)
    least = tool_panels.draw_singularity(axes, tool, factor, unit, drawn.width)
    _head(axes, "smallest singular value", "0 is a singularity, far from one it is 0.1 to 0.5", least)
    if shown.clearance is not None:
        axes = next(remaining_rows)
        least = tool_panels.draw_clearance(axes, shown.clearance, factor, unit, drawn.width)
        _head(axes, "clearance of bodies [mm]", "sampled; `yarcc` proves it", least)
    for count, row in enumerate(shown.kept[:MOST_KEPT], 1):
        axes = next(remaining_rows)
        found = draw_kept(axes, row, factor, unit, drawn.width)
        left_out = len(shown.kept) - MOST_KEPT if count == MOST_KEPT else 0
        _head(axes, row.title, f"{left_out} more aren't drawn" if left_out > 0 else "sampled", found)
    if signals:
        axes = next(remaining_rows)
        draw_rows(axes, signals, float(trace.times[-1]), factor)
        more = f"{len(signals) - MOST_ROWS} more aren't drawn" if len(signals) > MOST_ROWS else ""
        _head(axes, "inputs and outputs", more, "filled: output on; yellow: waits for the input")
        axes.tick_params(axis="y", length=0, labelsize=8)
    for axes in rows:
        _mark(axes, shown.bars, shown.corners, factor)
    rows[-1].tick_params(labelbottom=True)
    rows[-1].set_xlabel(f"time [{unit}]", labelpad=2)
    _draw_legend(figure, plan, shown.corners)


def _quantities(robot: Robot, trace: Trace) -> list[_Panel]:
    """Return the panels that show shares of limits. For joints, the largest value is also written in its own
    unit.
    """
    joints, units = joint_labels(robot.joint_names), robot.axis_unit_names
    rates = tuple(
        _Limits(getattr(robot.limits, name) / robot.axis_units, tuple(f"{unit}{per}" for unit in units))
        for name, per in (("velocity", "/s"), ("acceleration", "/s²"), ("jerk", "/s³"))
    )
    panels = [
        _Panel("joint position", trace.position, joints, "−100 % is the lower limit, +100 % the upper"),
        _Panel("joint velocity", trace.velocity, joints, limits=rates[0]),
        _Panel("joint acceleration", trace.acceleration, joints, limits=rates[1]),
        _Panel("joint jerk", trace.jerk, joints, limits=rates[2]),
    ]
    if trace.motors_bind:
        motors = tuple(f"motor {number}" for number in robot.controller.motors)
        note = "colours as the joints', in the motors' order"
        panels.append(_Panel("motor speed", trace.motors, motors, note, height=0.6))
    if trace.torque is not None and robot.dynamics is not None:
        note = "of the joints' efforts, without friction"
        forces = tuple("N" if unit == "mm" else "N m" for unit in units)
        limits = _Limits(robot.dynamics.effort, forces)
        panels.append(_Panel("joint torque", trace.torque, joints, note, limits=limits))
    return panels


def _head(axes: Axes, title: str, note: str, extreme: str) -> None:
    """Write the text above a panel: its title, its extreme value, and a remark if there is room between
    them.
    """
    begins = axes.set_title(title, loc="left", fontsize=9.5, pad=4, color="0.1", fontweight="bold")
    ends = axes.set_title(extreme, loc="right", fontsize=9, pad=4, color="0.2")
    axes.tick_params(labelbottom=False, length=2.5, labelsize=8.5)
    canvas: Any = axes.figure.canvas
    renderer = canvas.get_renderer()
    # use widths only: the heights of titles are known only when the figure is drawn
    box = axes.get_window_extent(renderer)
    text_end = box.x0 + begins.get_window_extent(renderer).width + _APART
    right = box.x1 - ends.get_window_extent(renderer).width - _APART
    for text in (note, note.rpartition(" · ")[2]):
        middle = axes.set_title(text, fontsize=8.5, pad=4, color="0.4")
        half = middle.get_window_extent(renderer).width / 2.0
        if 2.0 * half <= right - text_end:
            centre = float(np.clip((box.x0 + box.x1) / 2.0, text_end + half, right - half))
            middle.set_x((centre - box.x0) / box.width)
            return
    axes.set_title("")


@frozen(eq=False)
class Shown:
    """Everything that the picture of a program's motion shows.

    Attributes:
        trace: motion of the joints.
        tool: motion of the drawn frame.
        bars: commands.
        corners: corners that are passed without a stop.
        actions: waits and outputs.
        signals: inputs and outputs over time.
        clearance: sampled distances; None if there are no two bodies that could collide.
        kept: angles and distances that KEEP rules limit.
    """

    trace: Trace
    tool: ToolTrace
    bars: tuple[Bar, ...]
    corners: Passed
    actions: tuple[Action, ...]
    signals: tuple[SignalRow, ...]
    clearance: Clearance | None
    kept: tuple[KeptRow, ...]


@frozen
class _Drawn:
    """Unit of the time axis [s], the unit's name, and the width of the curves' lines."""

    factor: float
    unit: str
    width: float


@frozen(eq=False)
class _Limits:
    """Limits (n,) of a quantity, and the unit of each."""

    values: Array
    units: tuple[str, ...]


@frozen(eq=False)
class _Panel:
    """A panel of a picture with one quantity, such as the joints' velocities.

    Attributes:
        title: title of the panel.
        values: (N, n) shares of the limits.
        names: names of the columns.
        note: a remark.
        height: height relative to the other panels.
        limits: limits by which the values were divided. With them, the largest value is also written in its
            own unit. None: it is written only as a share.
    """

    title: str
    values: Array
    names: tuple[str, ...]
    note: str = ""
    height: float = 1.0
    limits: _Limits | None = None


def time_unit(duration: float) -> tuple[float, str]:
    """Return the unit of the time axis in seconds, and its name."""
    if duration < 600.0:
        return 1.0, "s"
    return (60.0, "min") if duration < 7200.0 else (3600.0, "h")


def _peak_text(peak: Peak, panel: _Panel, drawn: _Drawn) -> str:
    if peak.share * 100.0 <= _NOTHING:
        return "none"
    size = ""
    if panel.limits is not None:
        size = f" = {peak.share * panel.limits.values[peak.column]:.4g} {panel.limits.units[peak.column]}"
    name, time = short_name(panel.names[peak.column]), f"{peak.time / drawn.factor:.4g} {drawn.unit}"
    return f"most: {peak.share * 100.0:.3g} %{size}, {name}, at {time}"


def _draw_quantity(axes: Axes, times: Array, percent: Array, width: float) -> None:
    """Draw `percent` (N, n) over `times` (N,), with the limits at +100 % and -100 %."""
    # draw the curves with the largest values first, because they would cover the others
    for column in np.argsort(-np.abs(percent).mean(axis=0), kind="stable"):
        colour, style = joint_style(int(column))
        axes.plot(times, percent[:, column], color=colour, linestyle=style, linewidth=width, zorder=3)
    for limit in (-100.0, 100.0):
        axes.axhline(limit, color=_LIMIT_COLOUR, linewidth=1.2, linestyle=(0, (6, 2)), zorder=2)
    axes.grid(axis="y", color="0.88", linewidth=0.6)
    axes.axhline(0.0, color="0.6", linewidth=0.7, zorder=1)
    axes.margins(x=0)


def _scale(axes: Axes, peak: float, *, can_zoom: bool) -> str:
    """Choose the vertical scale of a panel so that it includes the limits and values up to +-`peak` [%].

    Returns:
        A remark on the scale, if the scale isn't uniform.
    """
    zoomed = ""
    if can_zoom and _NOTHING < peak < _ZOOMED_BELOW:
        inner = max(_round_up(peak * 1.05), _LEAST_INNER)
        _zoom(axes, inner)
        zoomed = f"scale squeezed beyond ±{inner:g} %"
    else:
        top = max(115.0, peak * 1.08)
        axes.set_ylim(-top, top)
        axes.set_yticks([-100, -50, 0, 50, 100])
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g} %".replace("-", "−"))
    return zoomed


def _zoom(axes: Axes, inner: float) -> None:
    """Give the range +-`inner` [%] most of a panel's height, and compress the range up to the limits into
    shaded strips.
    """
    outer = 100.0 + 0.35 * (100.0 - inner)
    # use one straight piece from `inner` to beyond the limit, so that the slope is the same on both sides of
    # the limit
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
    """Return the next larger number of the form 1, 2, 3 or 5 times a power of ten."""
    if value <= 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return float(
        next(step * power for step in (1.0, 2.0, 3.0, 5.0, 10.0) if step * power >= value * (1 - 1e-9))
    )


def _mark(axes: Axes, bars: tuple[Bar, ...], corners: Passed, factor: float) -> None:
    """Mark in a panel the starts of commands, and the blends, if they are far enough apart to be
    distinguished.
    """
    if len(corners) <= _MOST_BOUNDARIES:
        for begin, end in zip(corners.begins / factor, corners.ends / factor, strict=True):
            axes.axvspan(begin, end, color=CORNER_COLOUR, alpha=_CORNER_SHADE, linewidth=0.0, zorder=0)
    if len(bars) <= _MOST_BOUNDARIES:
        colour = "0.55" if len(bars) <= 20 else "0.85"
        for bar in bars[1:]:
            axes.axvline(bar.start / factor, color=colour, linewidth=0.7, zorder=1)


def _draw_legend(figure: Figure, plan: MotionPlan, corners: Passed) -> None:
    """Draw a legend of the joints' colours, the limits' dashes and the corners' shade, in one row above
    the panels.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    robot = plan.robot
    handles: list[Line2D | Patch] = []
    for joint, (name, limited) in enumerate(
        zip(joint_labels(robot.joint_names), has_limits(robot), strict=True)
    ):
        colour, style = joint_style(joint)
        label = short_name(name) if limited else f"{short_name(name)}*"
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
    legend_row(figure, handles, _LEFT, 0.931)


def legend_row(
    figure: Figure, handles: Sequence[Artist], left_end: float, height: float, right: float = _RIGHT
) -> None:
    """Draw a legend in one row, or in two rows if one would be too long.

    Args:
        figure: figure to draw on.
        handles: entries of the legend.
        left_end: left end, as a share of the figure's width.
        height: height of the legend's middle, as a share of the figure's height.
        right: rightmost allowed end, as a share of the figure's width.
    """
    canvas: Any = figure.canvas
    room = (right - left_end) * figure.bbox.width
    for rows, size in ((1, 9.0), (1, 8.0), (2, 8.0), (2, 7.0), (3, 6.5)):
        legend = figure.legend(
            handles=list(handles),
            loc="center left",
            bbox_to_anchor=(left_end, height),
            ncols=-(-len(handles) // rows),
            borderpad=0.0,
            borderaxespad=0.0,
            frameon=False,
            fontsize=size,
            handlelength=1.6,
            columnspacing=1.4,
            labelspacing=0.25,
        )
        if legend.get_window_extent(canvas.get_renderer()).width <= room:
            return
        legend.remove()
    figure.add_artist(legend)  # too many names for any row
