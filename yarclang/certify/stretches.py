"""Stretches of a text from rest to rest: what is proved of one depends on its own numbers and commands alone, wherever it stands in the text."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from yarclang.certify.certificate import Blended, Deviation, Load, ToolSpeed
from yarclang.certify.clearance import Apart
from yarclang.certify.judgement import Judge
from yarclang.certify.layout import Layout, Place
from yarclang.certify.limits import Loads
from yarclang.identity import flat, key_of
from yarclang.memory import Forgetful, Memory
from yarclang.robot.model import Array


@dataclass(frozen=True, slots=True)
class Claims:
    """What the planner claims, as `certify` takes it."""

    witnesses: Mapping[int, Array]
    laws: Mapping[int, Array]


@dataclass(frozen=True, slots=True, eq=False)
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
    context = (judge.robot, judge.program.cell, judge.tolerance)
    for rows in _stretches(layout.places):
        key: Hashable = ("proved", *context, _key(layout, rows, claims))
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


def _key(layout: Layout, rows: range, claims: Claims) -> bytes:
    """All that is proved about, by value."""
    segments = _segments(layout, rows)
    points = _control(layout, segments)
    # a sequence that ends in the middle has more points than segments
    numbers = (
        layout.control[points],
        layout.at[segments] - points.start,
        layout.time[segments],
        layout.begins[rows.start : rows.stop],
        layout.ends[rows.start : rows.stop],
    )
    motions = []
    for row in rows:
        place = layout.places[row]
        claimed = [claims.witnesses.get(place.step), claims.laws.get(place.step)]
        said = tuple(None if one is None else (one.shape, one.tobytes()) for one in claimed)
        motions.append((key_of(place.motion), place.size, place.before, place.behind, said))
    return flat(*(one.tobytes() for one in numbers), tuple(motions))


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
