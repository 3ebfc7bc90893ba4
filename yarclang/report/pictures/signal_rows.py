"""Draw inputs and outputs as rows of a picture: the times at which each was on, and at which the robot
waited for it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from yarclang.frozen import frozen
from yarclang.report.pictures.style import printable
from yarclang.runtime.signals import state_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_ROWS = 8
"""Largest number of signals that have a row. The signals that are reported first get the rows."""
OUTPUT, INPUT, WAIT = "#0072B2", "#009E73", "#E69F00"
_LONGEST = 12
"""Largest number of characters of a name."""
_MOST_TEXTS = 40
"""Largest number of values of a signal that are written into its row."""
_HIGH = 0.62
"""Distance between the lines for ON and OFF in a row, as a share of the row's height."""


@frozen(eq=False)
class SignalRow:
    """The values of an input or output over time [s].

    Attributes:
        name: name of the signal.
        is_input: False for an output.
        stretches: (beginning, end, value) of each interval with one value; before the first interval the
            value is unknown.
        waits: (beginning, end, True if the awaited value came).
    """

    name: str
    is_input: bool
    stretches: tuple[tuple[float, float, float], ...]
    waits: tuple[tuple[float, float, bool], ...]


def draw_rows(axes: Axes, rows: tuple[SignalRow, ...], end: float, factor: float) -> None:
    """Draw rows for signals below each other, over time.

    Args:
        axes: axes to draw on.
        rows: the signals, of which `MOST_ROWS` are drawn.
        end: end of the time axis [s].
        factor: unit of the time axis [s].
    """
    drawn_rows = rows[:MOST_ROWS]
    for row, signal in enumerate(drawn_rows):
        middle, colour = len(drawn_rows) - 1 - row, INPUT if signal.is_input else OUTPUT
        _draw_stretches(axes, signal, middle, colour, factor)
        for is_met in (True, False):
            waits = [
                (begins / factor, max(ends - begins, 0.003 * end) / factor)
                for begins, ends, met in signal.waits
                if met == is_met
            ]
            if waits:
                axes.broken_barh(
                    waits,
                    (middle - 0.45, 0.9),
                    facecolor="none" if is_met else WAIT,
                    edgecolor=WAIT,
                    alpha=1.0 if is_met else 0.5,
                    linewidth=1.4,
                    zorder=4,
                )
    axes.set_ylim(-0.6, len(drawn_rows) - 0.4)
    axes.set_yticks(range(len(drawn_rows)), [_cut(signal.name) for signal in reversed(drawn_rows)])
    axes.tick_params(length=0, labelsize=8)
    axes.tick_params(axis="x", length=2.5, labelsize=8.5)


def _draw_stretches(axes: Axes, signal: SignalRow, middle: float, colour: str, factor: float) -> None:
    off = [one for one in signal.stretches if one[2] == 0.0]
    on = [one for one in signal.stretches if one[2] != 0.0]
    axes.hlines(
        [middle - _HIGH / 2.0] * len(off),
        [begins / factor for begins, _, _ in off],
        [ends / factor for _, ends, _ in off],
        color=colour,
        linewidth=1.0,
        zorder=3,
    )
    spans = [(begins / factor, (ends - begins) / factor) for begins, ends, _ in on]
    if spans:
        axes.broken_barh(
            spans, (middle - _HIGH / 2.0, _HIGH), color=colour, alpha=0.75, linewidth=0.6, zorder=3
        )
    for begins, _, value in [one for one in on if one[2] != 1.0][:_MOST_TEXTS]:
        axes.text(
            begins / factor, middle, f" {state_text(value)}", fontsize=7, color="white", va="center", zorder=5
        )


def _cut(text: str) -> str:
    text = printable(text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
