"""Division of a controller text into stretches from rest to rest, which are proved and cached one by one.

The proof of a stretch depends on its own numbers and commands only, not on where in the text it is. Within a
long stretch, the proof of a motion depends only on a few motions around it, so a long stretch is cut into
windows of consecutive motions.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from zlib import crc32

import numpy as np

from yarclang.certify.blends.starts import Starts
from yarclang.certify.bodies.clearance import Apart
from yarclang.certify.certificate import Blended, Deviation, Load, Loads, ToolSpeed
from yarclang.certify.claims import Claims
from yarclang.certify.read.layout import Layout, Place
from yarclang.certify.whole_text import Judge
from yarclang.frozen import frozen
from yarclang.identity import flat, key_of
from yarclang.memory import Forgetful, Memory
from yarclang.parallel import mapped
from yarclang.progress import tell, within
from yarclang.robot.model import Array


@frozen(eq=False)
class Proved:
    """Everything that is proved about one motion.

    Attributes:
        loads: loads of joints and motors, as fractions of their limits.
        deviation: distance from the programmed path.
        speed: speed of the moving frame; None for motions in joint space.
        blended: the blend after the motion, if any.
        apart: distances between bodies.
        torque: the joint that comes nearest to its effort limit; None if the limits are unknown.
    """

    loads: Loads
    deviation: Deviation
    speed: ToolSpeed | None
    blended: Blended | None
    apart: Apart
    torque: Load | None


WINDOW = 128
"""Number of motions that are proved together. With fewer, operations on whole arrays would be less efficient.
"""
AROUND = 3
"""Number of motions on either side of a window that take part in its proofs.

Three are needed, for example before a window. The proof of the window's first motion depends on its corner
with the first neighbour. The path of the first neighbour depends on its corner with the second one, and the
path of the second one depends on whether the third one flows into it.
"""

Part = tuple[Layout, Starts]
"""Motions, and the start points of their programmed paths."""
Prove = Callable[[Judge, Part], Mapping[int, Proved]]


@frozen
class _Window:
    """Motions that are proved together, as rows of the layout.

    `own` are the window's motions; `around` adds the neighbours that affect them.
    """

    own: range
    around: range


def recalled(memory: Memory, judge: Judge, whole: Part, claims: Claims, prove: Prove) -> Mapping[int, Proved]:
    """Return the proofs of all steps, from the cache or newly computed.

    Long texts are proved window by window on all cores. Only proofs without findings are cached. If there is
    any finding, the whole text is proved again in one piece, since findings of one kind are counted together.

    Args:
        memory: cache of proofs.
        judge: collects the findings of `prove`.
        whole: the whole text.
        claims: the planner's claims.
        prove: function that proves motions and returns the proofs by step.
    """
    forgets, (layout, starts) = isinstance(memory, Forgetful), whole
    if forgets and len(layout.places) < 2 * WINDOW:
        return prove(judge, whole)
    proofs: dict[int, Proved] = {}
    missing: list[tuple[Hashable, _Window]] = []
    said, handled = None if forgets else _Said(layout, starts, claims), judge.handled
    for window in _windows(layout, starts):
        key: Hashable = None
        cached: tuple[Proved, ...] | None = None
        if said is not None:
            first = window.around.start
            cells = tuple(
                dict.fromkeys((row - first, handled.at(layout.places[row].step)) for row in window.around)
            )
            inner = (window.own.start - first, window.own.stop - first)
            # The key contains everything on which the proofs depend: the robot, the cell's states, the
            # tolerance, which rows are proved, and all numbers of the rows.
            key = ("proved", judge.robot, cells, judge.tolerance, inner, said.key(window.around))
            cached = memory.get(key)
        if cached is None:
            missing.append((key, window))
        else:
            proofs |= _by_step(layout, window, cached)
    batches = list(_batches(missing))
    made = mapped(
        lambda batch: _proved(judge, whole, batch, prove), [[one for _, one in batch] for batch in batches]
    )
    tell("certifying", 0, len(batches))
    for number, (batch, proved) in enumerate(zip(batches, made, strict=True)):
        if proved is None:
            # If a batch has a finding, prove the whole text again in one piece.
            return prove(judge, whole)
        tell("certifying", number + 1, len(batches))
        for (key, window), one in zip(batch, proved, strict=True):
            memory.keep(key, one)
            proofs |= _by_step(layout, window, one)
    return proofs


def _by_step(layout: Layout, window: _Window, proved: Sequence[Proved]) -> dict[int, Proved]:
    return {layout.places[row].step: one for row, one in zip(window.own, proved, strict=True)}


def _proved(
    judge: Judge, whole: Part, windows: Sequence[_Window], prove: Prove
) -> list[tuple[Proved, ...]] | None:
    """Prove the motions of some windows; return None if there is any finding."""
    steps = [[whole[0].places[row].step for row in window.own] for window in windows]
    apart = judge.of_part({step for own in steps for step in own})
    with within():
        made = prove(apart, _part(*whole, windows))
    if apart.findings:
        return None
    return [tuple(made[step] for step in own) for own in steps]


def _batches(missing: Sequence[tuple[Hashable, _Window]]) -> Iterator[list[tuple[Hashable, _Window]]]:
    """Yield batches of windows that are proved together.

    Short windows share a batch, up to `WINDOW` motions, so that all batches need about the same time.
    """
    batch: list[tuple[Hashable, _Window]] = []
    rows = 0
    for one in missing:
        if batch and rows + len(one[1].own) > WINDOW:
            yield batch
            batch, rows = [], 0
        batch.append(one)
        rows += len(one[1].own)
    if batch:
        yield batch


def _windows(layout: Layout, starts: Starts) -> Iterator[_Window]:
    """Yield one window for each stretch of a layout, or several for a long stretch."""
    for rows in _stretches(layout.places):
        begin = rows.start
        while rows.stop - begin >= 2 * WINDOW and (end := _end_of(layout, starts, begin, rows.stop)):
            yield _Window(range(begin, end), range(max(begin - AROUND, rows.start), end + AROUND))
            begin = end
        yield _Window(range(begin, rows.stop), range(max(begin - AROUND, rows.start), rows.stop))


def _end_of(layout: Layout, starts: Starts, begin: int, stop: int) -> int | None:
    """Return the row after the window that begins at row `begin`; None if the window can end nowhere.

    The window has between `WINDOW` and 2 `WINDOW` motions. A hash of the start of the next motion chooses one
    of the possible ends, so that an edit elsewhere in the text does not move the cuts between windows.
    """
    best, chosen = -1, None
    for row in range(begin + WINDOW, min(begin + 2 * WINDOW, stop - WINDOW + 1)):
        # The motions around a cut have moves, so that each window has whole motions at its ends.
        if not all(place.size for place in layout.places[row - AROUND : row + AROUND]):
            continue
        # Choose the end with the largest hash: the choice depends on the goals, not on their places in the
        # text.
        chance = crc32(starts.flange[row].tobytes())
        if chance > best:
            best, chosen = chance, row
    return chosen


def _stretches(places: Sequence[Place]) -> Iterator[range]:
    """Yield the rows of each stretch from rest to rest.

    A stretch begins with a motion that has moves and begins at rest.
    """
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
    """Return the range of the control points of a range of segments."""
    if segments.start == segments.stop:
        return slice(0, 0)
    return slice(int(layout.at[segments.start]), int(layout.at[segments.stop - 1]) + 4)


class _Said:
    """The numbers of a layout as bytes, from which the cache keys of windows are cut."""

    def __init__(self, layout: Layout, starts: Starts, claims: Claims) -> None:
        self._layout, self._claims = layout, claims
        self._starts, self._flanges = starts.q.tobytes(), starts.flange.tobytes()
        self._control = layout.control.tobytes()
        self._row = layout.control.itemsize * layout.control.shape[1]
        # Store the steps from one segment's control points to the next one's, since the steps do not depend
        # on the window's place in the text.
        self._steps = np.diff(layout.at, prepend=0).tobytes()
        self._time = layout.time.tobytes()
        self._begins, self._ends = layout.begins.tobytes(), layout.ends.tobytes()

    def key(self, rows: range) -> bytes:
        """Return the cache key of some rows: all values on which their proofs depend."""
        places, row = self._layout.places[rows.start : rows.stop], self._row
        segments, first, last = _segments(self._layout, rows), rows.start * row, rows.stop * row
        points = _control(self._layout, segments)
        begin, end = segments.start * _NUMBER, segments.stop * _NUMBER
        return flat(
            # Take all control points of these rows. Each sequence has three more of them than segments, even
            # if it is cut in the middle.
            self._control[points.start * row : points.stop * row],
            self._steps[begin + _NUMBER : end],
            self._time[begin:end],
            self._begins[first:last],
            self._ends[first:last],
            self._starts[first:last],
            self._flanges[rows.start * _POSE : rows.stop * _POSE],
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
            self._claims.least.get(place.step),
            place.any_jerk,
            place.beside_any_jerk,
        )


_NUMBER = 8
"""Size in bytes of a number in `Layout.at` and `Layout.time`."""
_POSE = 16 * _NUMBER
"""Size in bytes of a pose in `Starts.flange`."""


def _part(layout: Layout, starts: Starts, windows: Sequence[_Window]) -> Part:
    """Return the motions of several windows, one directly after the other."""
    control: list[Array] = [layout.control[:0]]
    at, time, places = [layout.at[:0]], [layout.time[:0]], list[Place]()
    points, segments = 0, 0
    for window in windows:
        rows = window.around
        segments_of = _segments(layout, rows)
        span = _control(layout, segments_of)
        control.append(layout.control[span])
        at.append(layout.at[segments_of] - span.start + points)
        time.append(layout.time[segments_of])
        shift = segments - segments_of.start
        for row in rows:
            one = layout.places[row]
            places.append(replace(one, first=one.first + shift, last=one.last + shift))
        # Where a window is cut from a long stretch, mark that no motion flows into its first row, or that its
        # last row flows into none: the neighbour isn't part of this layout.
        if rows.start < window.own.start:
            places[-len(rows)] = replace(places[-len(rows)], before=None)
        if rows.stop > window.own.stop:
            places[-1] = replace(places[-1], behind=None)
        points, segments = points + span.stop - span.start, segments + segments_of.stop - segments_of.start
    chosen = [row for window in windows for row in window.around]
    part = Layout(
        np.concatenate(control),
        np.concatenate(at),
        np.concatenate(time),
        tuple(places),
        layout.begins[chosen],
        layout.ends[chosen],
    )
    return part, starts.take(chosen)
