"""Inputs and outputs of a run, as rows of its picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from yarclang.report.pictures.signal_rows import MOST_ROWS, SignalRow, draw_rows
from yarclang.report.runs.log import RecordedRun
from yarclang.runtime.signals import InputChanged, OutputSet, WaitBegan, WaitEnded

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
    """Draw rows for inputs and outputs below each other, over the time of the run.

    Args:
        axes: axes to draw on.
        rows: the signals.
        end: end of the time axis [s].
        factor: unit of the time axis [s].
        unit: name of this unit.
    """
    draw_rows(axes, rows, end, factor)
    axes.set_xlim(0.0, end / factor)
    axes.set_xlabel(f"time since the log was opened [{unit}]", labelpad=1)
    axes.set_title("signals", loc="left", fontsize=9.5, pad=3, color="0.1", fontweight="bold")
    more = f"; {len(rows) - MOST_ROWS} more: yarc replay" if len(rows) > MOST_ROWS else ""
    key = f"filled: on; blue: outputs, green: inputs; yellow frame: the robot waits{more}"
    axes.set_title(key, loc="right", fontsize=8, pad=3, color="0.35")
