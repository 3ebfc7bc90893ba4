"""Draw the panels of a run's picture: joints and errors over the time of the program, and the progress of the
program over real time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from yarclang.frozen import frozen
from yarclang.report.pictures.palette import MOST_BARS, Bar, joint_style
from yarclang.report.pictures.panels import time_unit
from yarclang.report.pictures.ribbon import draw_ribbon
from yarclang.report.runs.course import Mark, Span
from yarclang.report.runs.log import RecordedRun
from yarclang.report.runs.planned import Planned
from yarclang.report.runs.tracking import Tracking
from yarclang.robot.model import Array
from yarclang.runtime.state import State

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {
    State.DISCONNECTED: ("#6A51A3", 0.22),
    State.INIT: ("0.6", 0.25),
    State.HOLD: ("#E6A700", 0.30),
    State.FAULT: ("#D7301F", 0.25),
}
"""Shades of states. States that are missing here aren't shaded."""

NOT_RUN = "0.93"
PLANNED = "0.70"
LIMIT = "#B2182B"

_COLUMNS = 4_000
"""Number of intervals of time into which a drawn line is thinned. A picture has fewer columns of pixels."""

_FEWEST = 50
"""Smallest number of intervals into which the line of one pass is thinned, if there are many passes."""

_LEAST_SPAN = 5.0
"""Smallest range of a joint's axis [deg or mm]. With a smaller range, the noise of a joint at rest would look
like motion.
"""

_LEAST_ERROR = {"counts": 2.0}
"""Smallest upper end of the axis of an error panel, by the unit of its values."""

_LEAST_OTHER = 0.005
"""Smallest upper end of the axis of an error panel with another unit [deg or mm]."""

_NARROWEST = 0.003
"""Smallest width of a shaded interval, as a share of the axis. Without it, a hold would be invisible, since a
hold takes no time of the program.
"""


@frozen(eq=False)
class Shown:
    """Data of the panels."""

    run: RecordedRun
    planned: Planned
    tracking: Tracking
    spans: tuple[Span, ...]
    marks: tuple[Mark, ...]

    @property
    def reached(self) -> float:
        """Last time of the program that the run reached [s]."""
        return float(self.tracking.times.max()) if len(self.tracking.times) else 0.0

    @property
    def unit(self) -> tuple[float, str]:
        """Seconds in the unit of the program's time, and the unit's name."""
        return time_unit(self.planned.duration)


def draw_commands(axes: Axes, shown: Shown) -> None:
    """Draw a ribbon of the program's commands."""
    from matplotlib import colormaps

    commands = shown.run.commands
    count = min(len(commands), MOST_BARS)
    bars = []
    for bar in range(count):
        first, end = bar * len(commands) // count, (bar + 1) * len(commands) // count
        command = commands[first]
        red, green, blue, _ = colormaps["Greys"](0.2 + 0.17 * (bar % 2))
        index = "" if command.index == "-" else command.index
        bars.append(
            Bar(
                first,
                end,
                command.begins,
                commands[end - 1].ends,
                index,
                command.name,
                (red, green, blue),
                "0.1",
            )
        )
    axes.set_xlim(0.0, max(shown.planned.duration, 1e-3) / shown.unit[0])
    draw_ribbon(axes, tuple(bars), shown.unit[0])


def draw_joint(axes: Axes, shown: Shown, joint: int) -> None:
    """Draw one joint's planned and actual positions, and its limits if they are near."""
    run = shown.run
    unit, factor = run.robot.axis_units[joint], shown.unit[0]
    colour, _ = joint_style(joint)
    times, planned = _planned_line(shown.planned)
    values = planned[:, joint] / unit
    axes.plot(times / factor, values, color=PLANNED, linewidth=3.2, zorder=2, solid_capstyle="round")
    actual = run.actual[shown.tracking.rows, joint : joint + 1] / unit
    for when, what in passes_of(shown, actual):
        axes.plot(when / factor, what[:, 0], color=colour, linewidth=1.1, zorder=3)
    everything = np.concatenate((values, actual[:, 0]))
    low, high = float(everything.min()), float(everything.max())
    room = max(high - low, _LEAST_SPAN)
    spare = (room - (high - low)) / 2.0 + 0.15 * room
    view = [low - spare, high + spare]
    limits = np.array([run.robot.lower[joint], run.robot.upper[joint]]) / unit
    for side, limit in enumerate(limits):
        if abs(limit - view[side]) < 0.35 * room or (limit - view[side]) * (1 - 2 * side) > 0.0:
            axes.axhline(limit, color=LIMIT, linewidth=1.1, linestyle=(0, (6, 2)), zorder=2)
            view[side] = limit + (0.06 if side else -0.06) * room
    axes.set_ylim(*view)
    shade_program(axes, shown)
    name, unit_name = run.robot.joint_names[joint], run.robot.axis_unit_names[joint]
    axes.set_title(f"{name} [{unit_name}]", loc="left", fontsize=9.5, pad=3, color=colour, fontweight="bold")
    axes.set_title(_limits_text(limits), loc="right", fontsize=8.5, pad=3, color="0.4")


def draw_lines(
    axes: Axes, shown: Shown, values: Array, names: tuple[str, ...], units: tuple[str, ...]
) -> None:
    """Draw one line for each column of `values` (M, n) over the time of the program, and write the largest
    value above the panel.
    """
    factor = shown.unit[0]
    # draw the lines with the largest values first, because they would cover the others
    for column in np.argsort(-np.abs(values).mean(axis=0), kind="stable") if len(values) else ():
        colour, style = joint_style(int(column))
        for when, what in passes_of(shown, values[:, column : column + 1]):
            axes.plot(when / factor, what[:, 0], color=colour, linestyle=style, linewidth=0.9, zorder=3)
    axes.axhline(0.0, color="0.6", linewidth=0.7, zorder=1)
    least = min((_LEAST_ERROR.get(unit, _LEAST_OTHER) for unit in units), default=_LEAST_OTHER)
    if float(np.abs(values).max(initial=0.0)) < least:
        axes.set_ylim(-least, least)
    shade_program(axes, shown)
    if not_run(shown) and len(values):
        axes.set_xlim(0.0, max(shown.reached, 1e-3) / factor)
    axes.set_title(
        most_text(values, names, units, shown.tracking.times / factor, shown.unit[1]),
        loc="right",
        fontsize=9,
        pad=4,
        color="0.2",
    )


def most_text(values: Array, names: tuple[str, ...], units: tuple[str, ...], times: Array, unit: str) -> str:
    """Return the value with the largest magnitude in `values` (M, n) for each unit, in words: the value, the
    name of its column, and its time from `times` (M,).
    """
    if not len(values):
        return "no samples"
    return "most: " + "; ".join(
        f"{_size(size)} {of}, {name}, at {times[row]:.4g} {unit}"
        for of, size, name, row in _largest(values, names, units)
    )


def off_path_text(shown: Shown) -> str:
    """Return the distance of the commanded positions from the planned path."""
    robot = shown.run.robot
    values = shown.tracking.off_path / robot.axis_units
    if not len(values):
        return "no positions were recorded"
    parts = [
        f"{_size(size)} {of} ({name})"
        for of, size, name, _ in _largest(values, robot.joint_names, robot.axis_unit_names)
    ]
    return f"commanded at most {', '.join(parts)} off the planned path"


def _largest(
    values: Array, names: tuple[str, ...], units: tuple[str, ...]
) -> Iterator[tuple[str, float, str, int]]:
    """Yield for each unit: the unit, the largest magnitude in the columns with this unit, and the name and
    the row of this value.
    """
    for unit in dict.fromkeys(units):
        columns = [column for column, one in enumerate(units) if one == unit]
        row, place = divmod(int(np.argmax(np.abs(values[:, columns]))), len(columns))
        yield unit, abs(float(values[row, columns[place]])), names[columns[place]], row


def _size(size: float) -> str:
    """Format a number with two significant digits, without an exponent, and with at most five decimals.
    Numbers below 0.00001 are rounded up to 0.00001.
    """
    if size < 1e-5:
        return "0.00001" if size > 0.0 else "0"
    return f"{size:.{min(5, max(0, 1 - math.floor(math.log10(size))))}f}"


def clock_end(run: RecordedRun) -> float:
    """Return the end of the axis with real time [s]."""
    return 1.03 * max(run.end, 1e-3)


def draw_clock(axes: Axes, shown: Shown) -> None:
    """Draw the progress of the program over real time, with states and events."""
    run, tracking = shown.run, shown.tracking
    factor, unit = time_unit(run.end)
    end = clock_end(run)
    for span in shown.spans:
        if is_shaded(span, end):
            colour, alpha = COLOURS[span.state]
            # the last state ends at the end of the log
            until = end if span is shown.spans[-1] else max(span.end, span.start + _NARROWEST * end)
            axes.axvspan(span.start / factor, until / factor, color=colour, alpha=alpha, lw=0, zorder=0)
    values = tracking.times[:, None] / shown.unit[0]
    for when, what in _by_pass(shown, run.times[tracking.rows], values):
        axes.plot(when / factor, what[:, 0], color="#0072B2", linewidth=1.5, zorder=3)
    axes.set_xlim(0.0, end / factor)
    top = max(shown.planned.duration, 1e-3) / shown.unit[0]
    axes.set_ylim(-0.03 * top, 1.16 * top)
    axes.axhline(top, color=PLANNED, linewidth=1.0, zorder=1)
    free = -1.0
    for number, mark in enumerate(shown.marks, 1):
        axes.axvline(mark.time / factor, color="0.35", linewidth=0.7, linestyle=":", zorder=2)
        if mark.time - free > 0.022 * end:
            axes.text(
                mark.time / factor,
                1.09 * top,
                str(number),
                fontsize=7.5,
                color="0.2",
                ha="center",
                va="center",
            )
            free = mark.time
    axes.set_xlabel(f"time since the log was opened [{unit}]", labelpad=2)
    axes.set_ylabel(f"program time [{shown.unit[1]}]", labelpad=2)


def is_shaded(span: Span, end: float) -> bool:
    """Return True if a state is shaded on a time axis that ends at `end` [s]. Loading is shaded only if it
    lasts long enough to be visible.
    """
    is_brief = span.end - span.start < _NARROWEST * end
    return span.state in COLOURS and not (span.state is State.INIT and is_brief)


def shade_program(axes: Axes, shown: Shown) -> None:
    """Shade the intervals of the program that weren't run, on an axis with the time of the program, and mark
    holds and failures.
    """
    factor, duration = shown.unit[0], max(shown.planned.duration, 1e-3)
    axes.set_xlim(0.0, duration / factor)
    axes.grid(axis="y", color="0.9", linewidth=0.6)
    axes.tick_params(length=2.5, labelsize=8.5)
    if not_run(shown):
        axes.axvspan(shown.reached / factor, duration / factor, color=NOT_RUN, lw=0, zorder=0)
    for span in shown.spans:
        if span.state in COLOURS and span.state is not State.INIT and span.begins is not None:
            colour, alpha = COLOURS[span.state]
            begins = min(span.begins, (1.0 - _NARROWEST) * duration)
            width = max((span.ends or span.begins) - span.begins, _NARROWEST * duration)
            axes.axvspan(
                begins / factor,
                (begins + width) / factor,
                color=colour,
                alpha=min(1.0, 2 * alpha),
                lw=0,
                zorder=1,
            )
    for mark in shown.marks:
        if mark.at is not None:
            axes.axvline(mark.at / factor, color="0.35", linewidth=0.6, linestyle=":", zorder=1)


def not_run(shown: Shown) -> bool:
    """Return True if the program has an interval that was never run."""
    return shown.planned.duration - shown.reached > max(
        0.2, 2.0 * float(shown.planned.cubics.h.max(initial=0.0))
    )


def passes_of(shown: Shown, values: Array) -> list[tuple[Array, Array]]:
    """Split a run where the time of the program jumps, and return a thinned line for each piece: times (k,)
    [s] and the `values` (M, m) at these times.

    A jump is a branch of a WHEN that was left out, or the beginning of another pass.
    """
    return _by_pass(shown, shown.tracking.times, values)


def _by_pass(shown: Shown, times: Array, values: Array) -> list[tuple[Array, Array]]:
    if not len(times):
        return []
    bounds = [0, *shown.tracking.breaks.tolist(), len(times)]
    columns = max(_FEWEST, _COLUMNS // (len(bounds) - 1))
    return [thinned(times[a:b], values[a:b], columns) for a, b in pairwise(bounds)]


def _planned_line(planned: Planned) -> tuple[Array, Array]:
    """Return times (k,) [s] and positions (k, n) [rad or m] of the whole plan, thinned for drawing."""
    begins, half = planned.begins, planned.cubics.h / 2.0
    times = np.sort(
        np.concatenate(([0.0, planned.duration or 1.0], begins, begins + half, begins + 2.0 * half))
    )
    return thinned(times, planned.at(times)[0], _COLUMNS)


def thinned(times: Array, values: Array, columns: int) -> tuple[Array, Array]:
    """Thin lines with increasing times (k,) and values (k, m), if they have too many points. Of each of
    `columns` intervals of time, the smallest and largest values are kept.
    """
    if len(times) <= 2 * columns:
        return times, values
    column = ((times - times[0]) * (columns / max(float(times[-1] - times[0]), 1e-9))).astype(np.intp)
    begin = np.flatnonzero(np.diff(column, prepend=-1))
    end = np.append(begin[1:], len(times)) - 1
    extremes = np.stack((np.minimum.reduceat(values, begin), np.maximum.reduceat(values, begin)), axis=1)
    return np.column_stack((times[begin], times[end])).ravel(), extremes.reshape(-1, values.shape[1])


def _limits_text(limits: Array) -> str:
    if not np.isfinite(limits).all():
        return "no limits"
    return f"limits {limits[0]:g} … {limits[1]:g}".replace("-", "−")
