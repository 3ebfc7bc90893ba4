"""Hints shown after motion commands: the shortest possible motion time, and how much of the limits the motion
uses.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from yarclang.assist.motions import first_motion, most_used, pace_in
from yarclang.assist.view import View
from yarclang.certify.outward import percent
from yarclang.hir import Motion, Origin
from yarclang.identity import fingerprint
from yarclang.source import SourceFile, Span

_KEPT = 1024
"""Number of shortest times that are cached: the times of the motions that were used most recently."""

_SHORTER = 0.02
"""A motion time counts as the shortest if it exceeds the shortest possible one by less than this share."""


@dataclass(frozen=True, slots=True)
class Hint:
    """A few words that an editor shows after the end of a line.

    Attributes:
        line: from 1.
        column: from 1.
        text: the hint.
        tooltip: details in Markdown.
    """

    line: int
    column: int
    text: str
    tooltip: str


class ShortestTimes:
    """Cache of the shortest possible times of motions. They stay valid when other lines of the text are
    edited.
    """

    def __init__(self) -> None:
        self._known: dict[Any, float | None] = {}

    def of(self, view: View, number: int) -> float | None:
        """Return the shortest possible time of a motion [s].

        None if no motion time is possible, if the motion isn't planned, or if it is blended with another
        motion and so has no time of its own.
        """
        planned = view.motion(number)
        step, robot = view.step(number), view.robot
        if planned is None or robot is None or not isinstance(step, Motion) or number in view.flowing:
            return None
        assert view.program is not None
        nobody = Origin("", "", SourceFile("", ""), Span(1, 1, 1, 1))
        alone = replace(
            view.program, start=planned[0].path.start, steps=(replace(step, origin=nobody),), outputs=()
        )
        key = robot.fingerprint, fingerprint(alone)
        if key not in self._known:
            pace = pace_in(view, number)
            self._known[key] = pace.shortest if pace else None
            if len(self._known) > _KEPT:
                self._known.pop(next(iter(self._known)))
        return self._known[key]


def hints_in(view: View, first: int, last: int, times: ShortestTimes) -> Iterator[Hint]:
    """Yield the hints of the lines `first` to `last` of a program.

    Only motions whose plan belongs to the current text have hints.
    """
    for line in range(first, last + 1):
        statement, planned_at = view.sketch.statement_at(line), view.planned_at(line)
        if statement is None or statement.line != line or planned_at is None:
            continue
        known, there = planned_at
        number = first_motion(known, known.steps_in(there))
        if number is None or (planned := known.motion(number)) is None:
            continue
        duration, shortest = planned[0].curve.duration, times.of(known, number)
        parts = [f"{duration:.3g} s" if statement.time is None else ""]
        if shortest is not None and duration > shortest * (1.0 + _SHORTER):
            parts.append(f"min {shortest:.3g} s")
        elif statement.time is not None:
            parts = [f"{duration:.3g} s"]
        lines = [f"takes {duration:.3f} s"]
        if shortest is not None:
            lines.append(f"at least {shortest:.3f} s under the whole limits that the command may use")
        if (certificate := known.proved(number)) is not None:
            what, load = most_used(certificate)
            parts.append(f"{percent(load.share)} %")
            lines.append(f"uses {percent(load.share, 1)} % of the {what} limit of {load.name}")
        end = statement.whole_span
        yield Hint(end.end_line, end.end_column, ", ".join(filter(None, parts)), "\n\n".join(lines))
