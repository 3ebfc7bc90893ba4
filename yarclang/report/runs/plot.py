"""Draw a run: the plan and the execution."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from yarclang.report.pictures.palette import joint_style
from yarclang.report.pictures.panels import legend_row, time_unit
from yarclang.report.pictures.plot import Format, saved, time_facts
from yarclang.report.pictures.signal_rows import MOST_ROWS
from yarclang.report.pictures.style import picture_style, printable
from yarclang.report.runs.course import marks_of, outcome_text, spans_of
from yarclang.report.runs.log import RecordedRun
from yarclang.report.runs.panels import (
    COLOURS,
    LIMIT,
    NOT_RUN,
    PLANNED,
    Shown,
    clock_end,
    draw_clock,
    draw_commands,
    draw_joint,
    draw_lines,
    is_shaded,
    not_run,
    off_path_text,
)
from yarclang.report.runs.planned import Planned
from yarclang.report.runs.signal_rows import draw_signals, signal_rows
from yarclang.report.runs.tracking import tracking_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (1600, 1000)
"""Width and height of a PNG [pixels]."""

_DPI = 100

_LEFT, _MIDDLE, _GAP, _RIGHT = 0.045, 0.565, 0.065, 0.985
"""Horizontal positions in the picture, as shares of its width: left and right borders of the joints' panels,
the gap after them, and the right border of the other panels.
"""

_TOP, _BOTTOM = 0.865, 0.055

_MOST_MARKS = 6
"""Largest number of events that are listed."""

_LONGEST = 95
"""Largest number of characters of a line in this list."""


def draw_run(run: RecordedRun, planned: Planned, format_: Format) -> bytes:
    """Draw a run together with its plan.

    Args:
        run: the run, from its log.
        planned: planned motion of the run.
        format_: format of the picture. A PNG has `SIZE`.

    Returns:
        The file's bytes. Equal logs give equal bytes.
    """
    tracking = tracking_of(run, planned)
    shown = Shown(run, planned, tracking, spans_of(run, tracking), marks_of(run, tracking))
    with picture_style():
        return saved(_figure(shown), format_)


def _figure(shown: Shown) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIZE[0] / _DPI, SIZE[1] / _DPI), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    _draw_title(figure, shown)
    _draw_joints(figure, shown)
    _draw_errors(figure, shown)
    _draw_marks(figure, shown)
    return figure


def _draw_title(figure: Figure, shown: Shown) -> None:
    run = shown.run
    text, well = outcome_text(run)
    colour = {True: "#1A7F37", False: LIMIT, None: "#9A6700"}[well]
    name = _cut(PurePath(run.program).name, 60)
    title = figure.text(_LEFT, 0.962, name, fontsize=17, fontweight="bold", color="0.1")
    canvas: Any = figure.canvas
    width = title.get_window_extent(canvas.get_renderer()).width / SIZE[0]
    figure.text(_LEFT + width + 0.012, 0.962, _cut(text, 120), fontsize=12.5, color=colour)
    robot = run.robot
    planned, *others = time_facts(shown.planned.lasting, shown.planned.duration)
    facts = [
        robot.name,
        f"{planned} planned",
        *others,
        f"{run.started[:19].replace('T', ' ')} UTC",
        f"at {_cut(run.controller, 40)}",
        off_path_text(shown),
    ]
    figure.text(_LEFT, 0.937, "   ·   ".join(facts), fontsize=10.5, color="0.3")


def _draw_joints(figure: Figure, shown: Shown) -> None:
    """Draw one panel for each joint, over one axis of the program's time."""
    count = len(shown.run.robot.joint_names)
    grid = figure.add_gridspec(
        count,
        1,
        left=_LEFT,
        right=_MIDDLE,
        top=_TOP - 0.035,
        bottom=_BOTTOM,
        hspace=0.42 if count < 8 else 0.6,
    )
    draw_commands(figure.add_axes((_LEFT, _TOP - 0.012, _MIDDLE - _LEFT, 0.015)), shown)
    for joint in range(count):
        axes = figure.add_subplot(grid[joint])
        draw_joint(axes, shown, joint)
        is_last = joint == count - 1
        axes.tick_params(labelbottom=is_last)
        if is_last:
            axes.set_xlabel(f"program time [{shown.unit[1]}]", labelpad=2)
    _draw_legend(figure, shown)


def _draw_errors(figure: Figure, shown: Shown) -> None:
    """Draw the errors of joints and motors, the progress over real time, and the inputs and outputs."""
    run, tracking = shown.run, shown.tracking
    robot = run.robot
    bottom = _BOTTOM + 0.135
    signals = signal_rows(run)
    count = min(len(signals), MOST_ROWS)
    grid = figure.add_gridspec(
        4 if signals else 3,
        1,
        left=_MIDDLE + _GAP,
        right=_RIGHT,
        top=_TOP,
        bottom=bottom,
        hspace=0.34 if not signals else 0.5,
        height_ratios=[1, 1, 0.85, *([0.12 + 0.11 * count] if signals else [])],
    )
    motors = tuple(f"motor {number}" for number in robot.controller.motors)
    units = " or ".join(dict.fromkeys(robot.axis_unit_names))
    for row, (title, values, names, unit_names) in enumerate(
        (
            (
                f"actual − planned [{units}]",
                tracking.error / robot.axis_units,
                robot.joint_names,
                robot.axis_unit_names,
            ),
            ("following error [counts]", run.following[tracking.rows], motors, ("counts",) * len(motors)),
        )
    ):
        axes = figure.add_subplot(grid[row])
        draw_lines(axes, shown, values, names, unit_names)
        axes.set_title(title, loc="left", fontsize=9.5, pad=4, color="0.1", fontweight="bold")
        axes.set_xlabel(f"program time [{shown.unit[1]}]", labelpad=1)
    axes = figure.add_subplot(grid[2])
    draw_clock(axes, shown)
    axes.tick_params(length=2.5, labelsize=8.5)
    axes.set_title("course of the run", loc="left", fontsize=9.5, pad=4, color="0.1", fontweight="bold")
    if signals:
        axes.set_xlabel("")
        draw_signals(figure.add_subplot(grid[3]), signals, clock_end(run), *time_unit(run.end))


def _draw_marks(figure: Figure, shown: Shown) -> None:
    """List the events with their numbers."""
    marks = shown.marks
    listed = marks if len(marks) <= _MOST_MARKS else marks[: _MOST_MARKS - 1]
    lines = [f"{number}  {mark.time:.2f} s  {mark.text}" for number, mark in enumerate(listed, 1)]
    if len(listed) < len(marks):
        lines.append(f"…  and {len(marks) - len(listed)} more: yarc replay shows them")
    for row, line in enumerate(lines or ["no remarks, no orders"]):
        figure.text(
            _MIDDLE + _GAP, 0.125 - 0.0185 * row, _cut(line, _LONGEST), fontsize=8.5, color="0.25", va="top"
        )


def _draw_legend(figure: Figure, shown: Shown) -> None:
    """Draw joints, lines and shades, in one row above the panels."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Line2D([], [], color=PLANNED, linewidth=3.2, label="planned")]
    for joint, name in enumerate(shown.run.robot.joint_names):
        colour, style = joint_style(joint)
        handles.append(Line2D([], [], color=colour, linestyle=style, linewidth=1.6, label=name))
    handles.append(Line2D([], [], color=LIMIT, linewidth=1.1, linestyle=(0, (6, 2)), label="limit"))
    states = dict.fromkeys(span.state for span in shown.spans if is_shaded(span, shown.run.end))
    for state in states:
        colour, alpha = COLOURS[state]
        handles.append(Patch(color=colour, alpha=min(1.0, 1.5 * alpha), lw=0, label=state.value))
    if not_run(shown):
        handles.append(Patch(color=NOT_RUN, lw=0, label="not run"))
    legend_row(figure, handles, _LEFT, 0.909, _RIGHT)


def _cut(text: str, most: int) -> str:
    """Return a text that has only characters that can be drawn, with bounded length."""
    text = printable(text)
    return text if len(text) <= most else text[: most - 1] + "…"
