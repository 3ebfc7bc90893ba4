"""Draw the motion of a program: joints against their limits and the tool's speed over time, and the tool's
path in space.

No window is opened. The figure is drawn in memory, so that it works without a screen, and equal programs give
equal bytes.
"""

from __future__ import annotations

import io
import warnings
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Literal

from yarclang.lasting import Lasting
from yarclang.motion.plan import MotionPlan
from yarclang.progress import tell
from yarclang.report.pictures.actions import actions_of, planned_signals
from yarclang.report.pictures.bodies import surroundings_of
from yarclang.report.pictures.cell_scene import draw_cell
from yarclang.report.pictures.clearance import clearance_of
from yarclang.report.pictures.drawn_frame import drawn_frame
from yarclang.report.pictures.kept import kept_rows_of
from yarclang.report.pictures.palette import bars_of
from yarclang.report.pictures.panels import Shown, draw_panels
from yarclang.report.pictures.passed import passed_corners
from yarclang.report.pictures.scene import draw_scene
from yarclang.report.pictures.space import LOWER, UPPER, WHOLE
from yarclang.report.pictures.style import picture_style, printable
from yarclang.report.pictures.tool_trace import tool_trace_of
from yarclang.report.pictures.toolpath import tool_path_of
from yarclang.report.pictures.trace import trace_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Format = Literal["png", "svg", "pdf"]

SIZE = (1600, 1200)
"""Width and height of a PNG [pixels]."""

_DPI = 100

_DRAWN = 1e-3
"""Times that differ by less are drawn as equal [s]."""

_LONGEST_NAME = 60
"""Largest number of characters of a program's name in the title."""

# Unset this metadata, so that the file contains no date.
_UNDATED: dict[Format, dict[str, None]] = {"png": {}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}


def draw(plan: MotionPlan, format_: Format) -> bytes:
    """Draw the motion of a planned program.

    Args:
        plan: plan to draw.
        format_: format of the picture. A PNG has `SIZE`.

    Returns:
        The file's bytes. Equal plans give equal bytes.
    """
    with picture_style():
        return saved(_figure(plan), format_)


def _figure(plan: MotionPlan) -> Figure:
    """Draw the whole figure with `SIZE` pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIZE[0] / _DPI, SIZE[1] / _DPI), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    tell("drawing", 0)
    bars, frame = bars_of(plan), drawn_frame(plan)
    corners, path = passed_corners(plan, frame), tool_path_of(plan, frame)
    _title(figure, plan)
    draw_panels(
        figure,
        plan,
        Shown(
            trace_of(plan),
            tool_trace_of(plan, frame),
            bars,
            corners,
            actions_of(plan),
            planned_signals(plan),
            clearance_of(plan),
            kept_rows_of(plan),
        ),
    )
    surroundings = surroundings_of(plan)
    if not surroundings.bodies:
        draw_scene(figure, path, bars, corners, WHOLE)
        return figure
    draw_cell(figure, path, bars, surroundings, UPPER if plan.motions else WHOLE)
    if plan.motions:
        draw_scene(figure, path, bars, corners, LOWER)
    return figure


def _title(figure: Figure, plan: MotionPlan) -> None:
    name = printable(PurePath(plan.program.source.name).name)
    if len(name) > _LONGEST_NAME:
        name = name[: _LONGEST_NAME - 1] + "…"
    count = len(plan.motions)
    motions = f"{count:,} motion{'s' * (count != 1)}" if count else "no motion: the robot stands still"
    facts = (plan.robot.name, *time_facts(plan.lasting, plan.duration), motions)
    figure.text(0.052, 0.970, name, fontsize=17, fontweight="bold", color="0.1")
    figure.text(0.052, 0.950, "   ·   ".join(facts), fontsize=11, color="0.3")


def time_facts(lasting: Lasting, drawn: float) -> tuple[str, ...]:
    """Return the texts about a program's duration that a picture shows.

    Args:
        lasting: duration of the program.
        drawn: length of the time axis [s]. It is longer than the duration if branches of a WHEN are drawn one
            after the other.
    """
    takes = lasting.text(duration_text)
    return (takes, "ways of a WHEN one after the other") if drawn > lasting.most + _DRAWN else (takes,)


def duration_text(seconds: float) -> str:
    """Format a duration: 12.345 s, 3 min 05.2 s, 2 h 03 min 05 s."""
    if round(seconds, 3) < 60:
        return f"{seconds:.3f} s"
    if round(seconds, 1) < 3600:
        tenths = round(seconds * 10)
        return f"{tenths // 600} min {tenths % 600 / 10:04.1f} s"
    whole = round(seconds)
    return f"{whole // 3600} h {whole // 60 % 60:02} min {whole % 60:02} s"


def saved(figure: Figure, format_: Format) -> bytes:
    """Return a picture as the bytes of a file. Equal pictures give equal bytes."""
    buffer = io.BytesIO()
    metadata: dict[str, Any] = dict(_UNDATED[format_])
    with warnings.catch_warnings():
        # characters that the font lacks are drawn as boxes, so matplotlib's warning is suppressed
        warnings.filterwarnings("ignore", message="Glyph")
        figure.savefig(buffer, format=format_, dpi=_DPI, metadata=metadata)
    return buffer.getvalue()
