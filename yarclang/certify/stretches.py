"""Stretches of a text from rest to rest: what is proved of one depends on its own numbers and commands alone, wherever it stands in the text."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence

import numpy as np

from yarclang.certify.certificate import Blended, Deviation, Load, ToolSpeed
from yarclang.certify.claims import Claims
from yarclang.certify.clearance import Apart
from yarclang.certify.judgement import Judge
from yarclang.certify.layout import Layout, Place
from yarclang.certify.limits import Loads
from yarclang.frozen import frozen
from yarclang.identity import flat, key_of
from yarclang.memory import Forgetful, Memory
from yarclang.robot.model import Array


@frozen(eq=False)
class Proved:
    """All that was proved of one motion by itself."""

    loads: Loads
    deviation: Deviation
    speed: ToolSpeed | None
    blended: Blended | None
    apart: Apart
    torque: Load | None


def recalled(
    memory: Memory,
    judge: Judge,
    layout: Layout,
    claims: Claims,
    prove: Callable[[Layout], Mapping[int, Proved]],
) -> Mapping[int, Proved]:
    """What is proved of each step: of stretches that were proved before, what was proved then.

    Only what has no finding is kept: with one, all is proved anew, since findings count what they have in common.

    Args:
        memory: keeps what was proved.
        judge: where `prove` puts its findings.
        layout: the whole text.
        claims: the planner's.
        prove: proves the motions of a layout, by their steps.
    """
    if isinstance(memory, Forgetful):
        return prove(layout)
    proofs: dict[int, Proved] = {}
    missing: list[tuple[Hashable, range]] = []
    context, said = (judge.robot, judge.program.cell, judge.tolerance), _Said(layout, claims)
    for rows in _stretches(layout.places):
        key: Hashable = ("proved", *context, said.key(rows))
        found: tuple[Proved, ...] | None = memory.get(key)
        if found is None:
            missing.append((key, rows))
        else:
            proofs |= {layout.places[row].step: one for row, one in zip(rows, found, strict=True)}
    if not missing:
        return proofs
    before = len(judge.findings)
    made = prove(layout if not proofs else _part(layout, [rows for _, rows in missing]))
    if len(judge.findings) > before:
        if not proofs:
            return made
        del judge.findings[before:]
        return prove(layout)
    for key, rows in missing:
        memory.keep(key, tuple(made[layout.places[row].step] for row in rows))
    return {**proofs, **made}


def _stretches(places: Sequence[Place]) -> Iterator[range]:
    """The rows of motions that depend on each other: one begins where a motion with moves begins at rest."""
    begin = 0
    for row, place in enumerate(places):
        if row > begin and place.size and place.before is None:
            yield range(begin, row)
            begin = row
    if places:
        yield range(begin, len(places))


def _segments(layout: Layout, rows: range) -> slice:
    return slice(layout.places[rows[0]].first, layout.places[rows[-1]].last)


def _control(layout: Layout, segments: slice) -> slice:
    """The control points of some segments."""
    if segments.start == segments.stop:
        return slice(0, 0)
    return slice(int(layout.at[segments.start]), int(layout.at[segments.stop - 1]) + 4)


class _Said:
    """The numbers of a layout as bytes, of which stretches are cut."""

    def __init__(self, layout: Layout, claims: Claims) -> None:
        self._layout, self._claims = layout, claims
        self._control = layout.control.tobytes()
        self._row = layout.control.itemsize * layout.control.shape[1]
        # from one segment to the next: so they are the same wherever the stretch stands
        self._steps = np.diff(layout.at, prepend=0).tobytes()
        self._time = layout.time.tobytes()
        self._begins, self._ends = layout.begins.tobytes(), layout.ends.tobytes()

    def key(self, rows: range) -> bytes:
        """All that is proved about, by value."""
        places, row = self._layout.places[rows.start : rows.stop], self._row
        segments, first, last = _segments(self._layout, rows), rows.start * row, rows.stop * row
        points = _control(self._layout, segments)
        begin, end = segments.start * _NUMBER, segments.stop * _NUMBER
        return flat(
            # a sequence that ends in the middle has more points than segments
            self._control[points.start * row : points.stop * row],
            self._steps[begin + _NUMBER : end],
            self._time[begin:end],
            self._begins[first:last],
            self._ends[first:last],
            *[self._motion(place) for place in places],
        )

    def _motion(self, place: Place) -> tuple[object, ...]:
        witness, law = self._claims.witnesses.get(place.step), self._claims.laws.get(place.step)
        return (
            key_of(place.motion),
            place.last - place.first,
            place.before,
            place.behind,
            None if witness is None else (witness.shape, witness.tobytes()),
            None if law is None else law.tobytes(),
            self._claims.kept.get(place.step),
            place.any_jerk,
        )


_NUMBER = 8
"""Bytes of a number of `Layout.at` and `Layout.time`."""


def _part(layout: Layout, stretches: Sequence[range]) -> Layout:
    """Some stretches one behind the other, as if nothing were between."""
    control: list[Array] = [layout.control[:0]]
    at, time, places = [layout.at[:0]], [layout.time[:0]], []
    points, segments = 0, 0
    for rows in stretches:
        own = _segments(layout, rows)
        span = _control(layout, own)
        control.append(layout.control[span])
        at.append(layout.at[own] - span.start + points)
        time.append(layout.time[own])
        shift = segments - own.start
        for row in rows:
            one = layout.places[row]
            places.append(
                Place(
                    one.step,
                    one.motion,
                    one.first + shift,
                    one.last + shift,
                    one.lines,
                    one.before,
                    one.behind,
                    one.any_jerk,
                )
            )
        points, segments = points + span.stop - span.start, segments + own.stop - own.start
    chosen = [row for rows in stretches for row in rows]
    return Layout(
        np.concatenate(control),
        np.concatenate(at),
        np.concatenate(time),
        tuple(places),
        layout.begins[chosen],
        layout.ends[chosen],
    )
