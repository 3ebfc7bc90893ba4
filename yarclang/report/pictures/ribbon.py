"""Draw the ribbon of a picture: a program's commands over time."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from yarclang.report.pictures.actions import Action
from yarclang.report.pictures.palette import Bar
from yarclang.report.pictures.signal_rows import OUTPUT, WAIT
from yarclang.report.pictures.style import printable

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOST_BOUNDARIES = 80
"""Largest number of bars that have borders. More borders would cover the bars."""

_MARKS = {"set": ("^", OUTPUT), "wait": ("D", WAIT)}
"""Marker and colour of commands that take no time in a plan."""

_DWELL_COLOUR = "0.75"

_BELOW = -0.42
"""Vertical position of the row of actions, as a share of the ribbon's height; negative values are below the
ribbon.
"""

_LONGEST = 40
"""Largest number of characters of an action's text."""


def draw_ribbon(axes: Axes, bars: tuple[Bar, ...], factor: float) -> None:
    """Draw the commands as coloured bars, with their indices and names if there is room for them."""
    axes.set_ylim(0.0, 1.0)
    axes.set_axis_off()
    for sort in dict.fromkeys(bar.sort for bar in bars):
        chosen = [bar for bar in bars if bar.sort == sort]
        axes.broken_barh(
            [(bar.start / factor, (bar.end - bar.start) / factor) for bar in chosen],
            (0.0, 1.0),
            facecolors=[bar.colour for bar in chosen],
            edgecolors="white",
            linewidth=1.0 if len(bars) <= _MOST_BOUNDARIES else 0.0,
            label=sort,
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
        # no room inside: put the label above the start of the bar, unless it would overlap the previous label
        label = bar.index or bar.name
        if left >= free and left + width.of(label) <= width.pixel(axes.get_xlim()[1]):
            axes.text(bar.start / factor, 1.12, label, ha="left", va="bottom", fontsize=8, color="0.2")
            free = left + width.of(label) + 10.0


def draw_actions(axes: Axes, actions: tuple[Action, ...], factor: float) -> None:
    """Draw waits and outputs in a row below the ribbon, with their texts if there is room for them."""
    dwells = [one for one in actions if one.sort == "dwell"]
    if dwells:
        axes.broken_barh(
            [(one.start / factor, (one.end - one.start) / factor) for one in dwells],
            (0.0, 1.0),
            facecolors=_DWELL_COLOUR,
            edgecolors="white",
            linewidth=1.0 if len(dwells) <= _MOST_BOUNDARIES else 0.0,
            hatch="////" if len(dwells) <= _MOST_BOUNDARIES else None,
            label="dwell",
        )
    for sort, (marker, colour) in _MARKS.items():
        times = [one.start / factor for one in actions if one.sort == sort]
        if times:
            axes.scatter(
                times, [_BELOW] * len(times), s=20, marker=marker, color=colour, clip_on=False, label=sort
            )
    width, places = _Widths(axes), sorted({one.start for one in actions})
    free, end = -math.inf, width.pixel(axes.get_xlim()[1])
    for start, following in pairwise([*places, math.inf]):
        texts = dict.fromkeys(one.text for one in actions if one.start == start)
        text = _cut(", ".join(texts))
        left = width.pixel(start / factor) + 7.0
        until = min(width.pixel(following / factor) - 7.0, end) if following < math.inf else end
        if left >= free and left + width.of(text) <= until:
            axes.text(start / factor, _BELOW, f"  {text}", ha="left", va="center", fontsize=8, color="0.2")
            free = left + width.of(text) + 10.0


def _cut(text: str) -> str:
    text = printable(text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


class _Widths:
    """Converter of times and texts to pixels of an axis."""

    def __init__(self, axes: Axes) -> None:
        from matplotlib.font_manager import FontProperties

        canvas: Any = axes.figure.canvas
        self._renderer = canvas.get_renderer()
        self._font = FontProperties(size=8)
        self._axes = axes

    def of(self, text: str) -> float:
        """Return the width of a text in the font size of labels."""
        return float(self._renderer.get_text_width_height_descent(text, self._font, ismath=False)[0])

    def pixel(self, time: float) -> float:
        """Return the position of a time, given in the axis's unit."""
        return float(self._axes.transData.transform((time, 0.0))[0])
