"""Inputs and outputs of a run as rows of a picture: the times at which each was on, and at which the robot
waited for it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from yarclang.frozen import frozen
from yarclang.report.pictures.plot import printable
from yarclang.report.runs.log import RecordedRun
from yarclang.runtime.signals import InputChanged, OutputSet, WaitBegan, WaitEnded, state_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_ROWS = 8
"""Most signals that have a row, in the order of their first reports."""
OUTPUT, INPUT, WAIT = "#0072B2", "#009E73", "#E69F00"
_LONGEST = 12
"""Most characters of a name."""
_HIGH = 0.62
"""Share of a row's height that is drawn."""


@frozen(eq=False)
class SignalRow:
    """A signal over the time of a run [s].

    Attributes:
        name: of the signal.
        is_input: False for an output.
        stretches: (beginning, end, value); before the first the value is unknown.
        waits: (beginning, end, True if the signal came).
    """

    name: str
    is_input: bool
    stretches: tuple[tuple[float, float, float], ...]
    waits: tuple[tuple[float, float, bool], ...]


def signal_rows(run: RecordedRun) -> tuple[SignalRow, ...]:
    """Return the inputs and outputs of a run, in the order of their first reports."""
    changes: dict[tuple[str, bool], list[tuple[float, float]]] = {}
    waits: dict[tuple[str, bool], list[tuple[float, float, bool]]] = {}
    begun: tuple[tuple[str, bool], float] | None = None
    for message in run.told:
        match message:
            case OutputSet() | InputChanged() | WaitBegan() | WaitEnded():
                key = (message.name, not isinstance(message, OutputSet))
                changes.setdefault(key, []).append((message.time, message.value))
                waits.setdefault(key, [])
                if isinstance(message, WaitBegan):
                    begun = (key, message.time)
                elif isinstance(message, WaitEnded):
                    since = (
                        begun[1] if begun is not None and begun[0] == key else message.time - message.waited
                    )
                    waits[key].append((since, message.time, message.met))
                    begun = None
            case _:
                pass
    if begun is not None:  # the run has ended during the wait
        waits[begun[0]].append((begun[1], run.end, False))
    return tuple(
        SignalRow(name, is_input, _stretches(told, run.end), tuple(waits[name, is_input]))
        for (name, is_input), told in changes.items()
    )


def _stretches(changes: list[tuple[float, float]], end: float) -> tuple[tuple[float, float, float], ...]:
    kept = [one for number, one in enumerate(changes) if not number or one[1] != changes[number - 1][1]]
    ends = [*(time for time, _ in kept[1:]), max(end, kept[-1][0])]
    return tuple((time, until, value) for (time, value), until in zip(kept, ends, strict=True))


def draw_signals(axes: Axes, rows: tuple[SignalRow, ...], end: float, factor: float, unit: str) -> None:
    """Draw signals below each other over the time of the run.

    Args:
        axes: to draw on.
        rows: the signals.
        end: of the time axis [s].
        factor: seconds in its unit.
        unit: its name.
    """
    shown = rows[:MOST_ROWS]
    for row, signal in enumerate(shown):
        middle, colour = len(shown) - 1 - row, INPUT if signal.is_input else OUTPUT
        for begins, ends, value in signal.stretches:
            _draw_stretch(axes, (begins / factor, ends / factor), middle, value, colour)
        for begins, ends, is_met in signal.waits:
            axes.barh(
                middle,
                max(ends - begins, 0.003 * end) / factor,
                left=begins / factor,
                height=0.9,
                facecolor="none" if is_met else WAIT,
                edgecolor=WAIT,
                alpha=1.0 if is_met else 0.5,
                linewidth=1.4,
                zorder=4,
            )
    axes.set_xlim(0.0, end / factor)
    axes.set_ylim(-0.6, len(shown) - 0.4)
    axes.set_yticks(range(len(shown)), [_cut(signal.name) for signal in reversed(shown)])
    axes.tick_params(length=0, labelsize=8)
    axes.tick_params(axis="x", length=2.5, labelsize=8.5)
    axes.set_xlabel(f"time since the log was opened [{unit}]", labelpad=1)
    axes.set_title("signals", loc="left", fontsize=9.5, pad=3, color="0.1", fontweight="bold")
    more = f"; {len(rows) - len(shown)} more: yarc replay" if len(rows) > len(shown) else ""
    key = f"filled: on; blue: outputs, green: inputs; yellow frame: the robot waits{more}"
    axes.set_title(key, loc="right", fontsize=8, pad=3, color="0.35")


def _draw_stretch(axes: Axes, times: tuple[float, float], middle: float, value: float, colour: str) -> None:
    begins, ends = times
    if value == 0.0:
        axes.plot([begins, ends], [middle - _HIGH / 2.0] * 2, color=colour, linewidth=1.0, zorder=3)
        return
    axes.barh(
        middle, ends - begins, left=begins, height=_HIGH, color=colour, alpha=0.75, linewidth=0.6, zorder=3
    )
    if value != 1.0:
        axes.text(begins, middle, f" {state_text(value)}", fontsize=7, color="white", va="center", zorder=5)


def _cut(text: str) -> str:
    text = printable(text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
